"""The FMUs of a session: opened, reused from the previous session, initialized and closed together."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from cosim import paths
from cosim.errors import FmuError, concerning
from cosim.fmu import bundled
from cosim.fmu.archive import open_fmu
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.instance import Instance
from cosim.fmu.named import NamedFmu
from cosim.loop import recorder, repeats
from cosim.loop.position import Position, Stage
from cosim.loop.repeats import NewProcessError
from cosim.loop.wires.connect import driven
from cosim.scenario.model import Scenario

Arguments = tuple[FmuFile, list[Variable], list[Variable], bool, NamedFmu]
"""Arguments of an `Instance`."""
loaded: dict[Path, FmuFile] = {}
"""FMUs that this process has loaded, by their extracted folders."""
strict = False
"""Whether this is a worker process, which can be replaced."""


def open_files(scenario: Scenario) -> dict[str, FmuFile]:
    """Open the FMU files of a scenario; by the names of the FMUs, in the order in which they step.

    It raises FmuError also if a file allows fewer instances, or two of them cannot share a process.
    """
    files: dict[str, FmuFile] = {}
    for choice in scenario.fmus:
        with concerning(f"{choice.name}.fmu"):
            file = open_fmu(paths.find_fmu(choice.fmu, scenario.folder))
            for name, other in files.items():
                both = f"`{name}` and `{choice.name}`"
                # copies of a file share their extracted library
                if file.once and other.folder == file.folder:
                    problem = f"{both} are both `{file.path.name}`, which a process can instantiate only once"
                    raise FmuError(problem, "Use each such FMU once (`canBeInstantiatedOnlyOncePerProcess`).")
                if shared := clash(file, other):
                    problem = f"{both} bring different versions of {shared}; a process loads only one"
                    raise FmuError(problem, "Rename it in one of the FMUs.")
            files[choice.name] = file
    return files


def clash(one: FmuFile, other: FmuFile) -> str:
    """Name of a module or library of which two FMUs bring different versions; empty if there is none."""
    ours, theirs = (bundled.brought(file.folder, file.identifier) for file in (one, other))
    return next((name for name in ours if theirs.get(name, ours[name]) != ours[name]), "")


def check_process(files: Iterable[FmuFile]) -> None:
    """Check that this process can load these files, which it may have loaded before.

    An interpreter keeps the modules of other FMUs, and a library may stay in the process after its FMU. A
    worker process with an interpreter therefore loads no other file. A NewProcessError states that another
    process can load the files, an FmuError that none can.
    """
    wanted = {file.folder: file for file in files}
    for file in wanted.values():
        shown = f"`{paths.shown(file.path)}`"
        for other in (one for folder, one in loaded.copy().items() if folder not in wanted):
            if strict and any(bundled.loads_interpreter(one.folder) for one in (file, other)):
                why = "an interpreter keeps the modules of both"
            elif shared := clash(file, other):
                why = f"{shared} differs"
            else:
                continue
            both = f"{shown} needs a process without `{paths.shown(other.path)}`"
            raise NewProcessError(f"{both}: {why}", repeats.SEPARATE)
        if module := bundled.foreign_module(file.folder):
            problem = f"{shown} would use `{paths.shown(Path(module))}` in place of its own module"
            # a worker process holds only the modules of this run
            if not strict:
                raise NewProcessError(problem, repeats.SEPARATE)
            raise FmuError(problem, "Rename one of the modules.")
    loaded.update(wanted)


def open_instances(
    scenario: Scenario,
    files: Mapping[str, FmuFile],
    log_events: bool,
    before: Sequence[Instance],
    position: Position,
) -> tuple[Instance, ...]:
    """Instances of the FMUs; suitable previous instances are reused, the others closed."""
    arguments: dict[str, Arguments] = {}
    for choice in scenario.fmus:
        file = files[choice.name]
        outputs = recorder.recorded(file, scenario.loop.record_locals)
        arguments[choice.name] = file, driven(scenario, choice, file), outputs, log_events, choice
    fitting = {fmu.name: fmu for fmu in before if fmu.name in arguments and fits(fmu, arguments[fmu.name])}
    close([fmu for fmu in before if fmu not in fitting.values()], position)
    opened: list[Instance] = []
    try:
        check_process(files.values())
        for choice in scenario.fmus:
            position.at(Stage.LOAD, choice.label)
            opened.append(fitting.get(choice.name) or Instance(*arguments[choice.name]))
    except BaseException:
        close([*opened, *fitting.values()], position)
        raise
    return tuple(opened)


def fits(fmu: Instance, arguments: Arguments) -> bool:
    """Whether an instance can be used as one that is constructed with these arguments."""
    file, inputs, outputs, log_events, choice = arguments
    # the texts of an FMU in messages
    names = [(one.name, one.fmu, one.alone) for one in (fmu.owner, choice)]
    transferred = fmu.driven == inputs and fmu.recorded == outputs and fmu.log_events == log_events
    return fmu.file is file and transferred and names[0] == names[1] and not fmu.dead and not fmu.closed


def close(fmus: Sequence[Instance], position: Position) -> None:
    """Free all open instances."""
    for fmu in fmus:
        position.at(Stage.CLOSE, fmu.owner.label)
        fmu.close()
