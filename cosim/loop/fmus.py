"""The FMUs of a session: opened, reused from the previous session, initialized and closed together."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cosim import paths
from cosim.errors import FmuError, concerning
from cosim.fmu.archive import FmuFile, Variable, open_fmu
from cosim.fmu.instance import Instance
from cosim.loop import recorder
from cosim.loop.place import Place, Stage
from cosim.loop.wires.connect import driven
from cosim.scenario.model import FmuChoice, Scenario


def open_files(scenario: Scenario) -> dict[str, FmuFile]:
    """Open the FMU files of a scenario; by the names of the FMUs, in the order in which they step.

    Raises
    ------
    FmuError
        A file cannot be opened, or it allows fewer instances.
    """
    files: dict[str, FmuFile] = {}
    for choice in scenario.fmus:
        with concerning(f"{choice.name}.fmu"):
            file = open_fmu(paths.find_fmu(choice.fmu, scenario.folder))
            twins = [name for name, other in files.items() if other is file]
            if file.once and twins:
                both = f"`{twins[0]}` and `{choice.name}` are both `{file.path.name}`"
                problem = f"{both}, which a process can instantiate only once"
                raise FmuError(problem, "Use each such FMU once (`canBeInstantiatedOnlyOncePerProcess`).")
            files[choice.name] = file
    return files


def open_instances(
    scenario: Scenario,
    files: Mapping[str, FmuFile],
    log_events: bool,
    before: Sequence[Instance],
    place: Place,
) -> tuple[Instance, ...]:
    """Instances of the FMUs; suitable previous instances are reused, the others closed.

    Raises
    ------
    CosimError
        An FMU cannot be instantiated, or a variable is driven that is not an input.
    """
    wanted = [
        (choice, files[choice.name], driven(scenario, choice, files[choice.name])) for choice in scenario.fmus
    ]
    fitting = {
        choice.name: fmu
        for fmu in before
        for choice, file, inputs in wanted
        if called(fmu.owner) == called(choice)
        and fits(fmu, file, inputs, log_events)
        and fmu.recorded == recorder.recorded(file, scenario.loop.record_locals)
    }
    close([fmu for fmu in before if fmu not in fitting.values()], place)
    opened = []
    try:
        for choice, file, inputs in wanted:
            place.at(Stage.LOAD, choice.shown)
            fmu = fitting.get(choice.name) or Instance(
                file, inputs, recorder.recorded(file, scenario.loop.record_locals), log_events, choice
            )
            opened.append(fmu)
    except BaseException:
        close([*opened, *fitting.values()], place)
        raise
    return tuple(opened)


def called(choice: FmuChoice) -> tuple[str, str, bool]:
    """Return the texts of an FMU in messages: name, file as in the scenario, whether it is the only one."""
    return choice.name, choice.fmu, choice.alone


def fits(fmu: Instance, file: FmuFile, inputs: list[Variable], log_events: bool) -> bool:
    """Whether an open instance transfers these variables of a file."""
    same = fmu.file is file and fmu.driven == inputs
    return same and fmu.log_events == log_events and not fmu.dead


def initialise(scenario: Scenario, fmus: Sequence[Instance], place: Place) -> None:
    """Set the start values of all FMUs in their order; used instances are reset first.

    Raises
    ------
    FmuError
        See `Instance.initialise`.
    """
    for choice, fmu in zip(scenario.fmus, fmus, strict=True):
        place.at(Stage.INITIALISE, choice.shown)
        fmu.initialise(choice.parameters)


def close(fmus: Sequence[Instance], place: Place) -> None:
    """Free all open instances."""
    for fmu in fmus:
        place.at(Stage.CLOSE, fmu.owner.shown)
        fmu.close()
