"""One run of a scenario."""

from __future__ import annotations

import contextlib
import operator
import time
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from cosim import interrupts
from cosim.closing import Closing
from cosim.errors import CosimError, FmuError, PlantError, concerning
from cosim.fmu.description import FmuFile
from cosim.fmu.instance import Instance
from cosim.loop import condition, fmus, native, plant, recorder, reference, repeats, undriven
from cosim.loop.engines import Engine, checked
from cosim.loop.position import Position, Stage
from cosim.loop.reference import Parts, Progress, Recording
from cosim.loop.result import Result
from cosim.metrics import criteria, drawable
from cosim.scenario.model import Scenario
from cosim.trace import endings
from cosim.trace.columns import structured
from cosim.trace.measure import measured
from cosim.warned import once

TIMESTEP_TOLERANCE = 1e-9
MAX_SUBSTEPS = 10**6
"""Maximum substeps that a hint proposes; more means a wrong time step."""


class Session(Closing):
    """A scenario with its FMUs and plant opened once; each `run` resets all.

    The second run in a process repeats the first of the same FMUs and plant before, see `repeats`.

    Parameters
    ----------
    scenario
        The scenario, see `cosim.load`.
    log_events
        Whether the FMUs log events in addition to warnings and errors.
    engine
        `reference` uses FMPy, `native` compiled code with bit-identical results. Several FMUs and plants
        written in Python always run in the reference engine.
    previous
        A session that is no longer used: suitable FMUs and plants are reused, the others closed.
    position
        Records whose code runs; may be None.

    Raises
    ------
    CosimError
        An FMU or the plant cannot be opened, or does not fit the scenario.
    """

    def __init__(
        self,
        scenario: Scenario,
        log_events: bool = False,
        engine: Engine = "reference",
        previous: Session | None = None,
        position: Position | None = None,
    ) -> None:
        self.scenario, self.requested, self.log_events = scenario, checked(engine), log_events
        self.position = position or Position()
        self.has_plant = self.plant_used = self.complete = False
        self.fmus: tuple[Instance, ...] = ()
        self._open(previous)

    def _open(self, previous: Session | None) -> None:
        """Open FMUs and plant, or take them from a session that is no longer used; check that they fit."""
        scenario, position = self.scenario, self.position
        self.begin()
        with located(scenario), contextlib.ExitStack() as opened:
            files = fmus.open_files(scenario)
            position.at(Stage.BUILD_PLANT)
            self.plant = open_plant(scenario, previous)
            position.at(Stage.NONE)
            self.has_plant = True
            opened.callback(self.close_plant)
            self.plant_used = previous is not None and self.plant is previous.plant and previous.plant_used
            self.key = repeats.key(scenario, files)
            self.engine = native.choose(self.requested, scenario, self.plant, files.values())
            check_timestep(scenario, self.plant.timestep)
            before = () if previous is None else previous.fmus
            self.fmus = fmus.open_instances(scenario, files, self.log_events, before, position)
            position.at(Stage.NONE)
            opened.callback(fmus.close, self.fmus, position)
            self._compile()
            opened.pop_all()

    @property
    def fmu(self) -> Instance:
        """The first FMU, which in most scenarios is the only one."""
        return self.fmus[0]

    @property
    def file(self) -> FmuFile:
        """File of the first FMU."""
        return self.fmu.file

    def begin(self) -> None:
        """Record the start of another run."""
        scenario, loop = self.scenario, self.scenario.loop
        self.position.begin(scenario.fmus[0].label, scenario.plant.name, loop.steps, loop.step)

    def _compile(self) -> None:
        """Compile all expressions against the columns of the trace."""
        self.labels = recorder.columns(self.fmus, self.plant)
        found = {name: label.variable for name, label in self.labels.items()}
        self.columns = condition.items_of(found)
        units = {name: label.unit for name, label in self.labels.items()}
        self.metrics = criteria.compile_metrics(self.scenario.metric, self.columns, units)
        criteria.check_units(self.scenario.criterion, self.scenario.metric, self.metrics)
        self.stop = condition.compiled(self.scenario.loop.stop_when, "loop.stop_when", found)
        self.when = [
            condition.compiled(one.when, f"inject.{one.to}.when", found) for one in self.scenario.inject
        ]

    def check_drawn(self) -> None:
        """Check before a run that all plots and charts of the scenario can be made."""
        with located(self.scenario):
            drawable.check(self.scenario, self.columns)

    @once()
    def run(
        self, seed: int | None = None, progress: Progress | None = None, stream: str | Path | None = None
    ) -> Result:
        """Run the scenario once.

        Parameters
        ----------
        seed
            Seed of all noise; None is the scenario's.
        progress
            Called with the completed and the total number of steps.
        stream
            Parquet file for the trace, written during the run; None keeps it in memory.

        Raises
        ------
        CosimError
            The run failed and leaves no file, the session is closed, or FMU or plant keep state between runs.
        KeyboardInterrupt
            After the step in which Ctrl-C was pressed.
        """
        scenario = self.scenario
        seed = scenario.loop.seed if seed is None else checked_seed(seed)
        file = None if stream is None else endings.streamed(Path(stream))
        with located(scenario), interrupts.deferred() as interrupt:
            self._check_repeatable(interrupt)
            sums = recorder.Checksums()
            outcome: object = None
            try:
                parts = replace(self.start(seed), progress=progress, interrupt=interrupt)
                result = self._result(seed)
                begin = time.perf_counter()
                done = self._loop(parts, result, file, sums)
                outcome = sums.columns
            except CosimError as error:
                # a trace that cannot be written is no outcome
                outcome = None if sums.passing else error.message
                raise
            finally:
                if outcome is not None:
                    first = repeats.FirstRun(scenario, self.engine, seed, outcome)
                    repeats.first_runs.setdefault(self.key, first)
            step, begins = scenario.loop.step, done.begins.tolist()
            result = replace(
                result,
                simulated_s=done.steps * step,
                injected=tuple(k * step if k < done.steps else None for k in begins),
                wall_s=time.perf_counter() - begin,
                trace=structured(done.table, list(self.columns)) if file is None else None,
                file=file,
            )
            self.complete = True
            undriven.report_unmet(scenario, result.injected)
            recorder.report_unlisted(self.fmus, result.columns)
            metrics = measured(scenario.metric, self.metrics, result.columns)
        return replace(result, metrics=metrics, criteria=criteria.evaluate(scenario.criterion, metrics))

    def start(self, seed: int) -> Parts:
        """Initialize the FMUs and reset the plant for a run with a valid seed; return the parts of a run."""
        scenario, position = self.scenario, self.position
        self.complete = False
        self.begin()
        undriven.report(scenario, self.fmus, self.plant)
        self.plant_used = True
        connections = reference.initialise(scenario, self.fmus, self.plant, seed, position)
        return Parts(scenario, self.fmus, self.plant, connections, self.stop, self.when, position=position)

    def _loop(self, parts: Parts, known: Result, file: Path | None, sums: recorder.Checksums) -> Recording:
        """Run the closed loop; the trace goes to a file if one is given."""
        if file is None:
            done = self._steps(parts)
            sums.write(list(done.table.T))
            return done
        from cosim.trace.parquet import streaming

        with streaming(file, list(self.columns), known.about()) as writer:
            sums.sink, sums.rows = writer, writer.rows
            done = self._steps(replace(parts, sink=sums))
            writer.finish(done.steps * self.scenario.loop.step)
        return done

    def _steps(self, parts: Parts) -> Recording:
        return native.run(parts) if self.engine == "native" else reference.run(parts)

    def _check_repeatable(self, interrupt: Callable[[], None]) -> None:
        """Repeat the first run of the same FMUs and plant in this process; reject another outcome."""
        first = repeats.first_runs.get(self.key)
        if first is None or any(fmu.dead or fmu.closed for fmu in self.fmus):
            return
        while True:
            # the repetition may leave a used plant where it was new
            used = any(fmu.used for fmu in self.fmus), self.plant_used
            if (known := repeats.verdict(self.key, used)) is not None:
                break
            with repeats.muted():
                same = self._repeated(first, used[0], interrupt) == first.outcome
            repeats.verdicts[self.key, used] = same
            self.position.page.repeated += 1
        if not known:
            problem = "keeps state: its first run gives other results when it is repeated in the same process"
            error = repeats.NewProcessError(f"{self.position.ran()} {problem}", repeats.SEPARATE)
            error.state = True
            raise error

    def _repeated(self, first: repeats.FirstRun, used: bool, interrupt: Callable[[], None]) -> object:
        """Outcome of another run, with the instances of this session if they are used, otherwise new ones."""
        sums = recorder.Checksums()
        if not used:
            # one after the other, as runs are: instances of a library may share its variables
            fmus.close(self.fmus, self.position)
        try:
            previous = self if used else None
            other = Session(first.scenario, self.log_events, first.engine, previous, self.position)
        except CosimError as error:
            return error.message
        try:
            other._steps(replace(other.start(first.seed), interrupt=interrupt, sink=sums))
            return sums.columns
        except CosimError as error:
            return error.message
        finally:
            if not used:
                other.close()
            self._open(other if used else self)

    def _result(self, seed: int) -> Result:
        """Return the parts of a result that are known before the run."""
        labels = self.labels.items()
        return Result(
            scenario=self.scenario.name,
            title=self.scenario.title,
            seed=seed,
            engine=self.engine,
            units={name: label.unit for name, label in labels},
            items={name: items for name, items in self.columns.items() if items},
            descriptions={name: label.description for name, label in labels},
            displays={name: v.display for name, (_, _, v) in labels if v and v.display},
            fmus={fmu.owner.fmu: fmu.file.guid for fmu in self.fmus},
        )

    def close(self) -> None:
        """Free the FMUs and close the plant; the session cannot run afterwards.

        All FMU variables are read here, because an error can no longer affect the result of the run.
        """
        for choice, fmu in zip(self.scenario.fmus, self.fmus, strict=True):
            if self.complete and fmu.running:
                self.position.at(Stage.READ, choice.label)
                fmu.read_all()
        fmus.close(self.fmus, self.position)
        self.close_plant()

    def close_plant(self) -> None:
        """Close the plant, unless it is closed or reused."""
        if self.has_plant:
            self.has_plant = False
            self.position.at(Stage.CLOSE_PLANT)
            plant.close(self.plant, self.scenario.plant.name)
        self.position.at(Stage.NONE)


def checked_seed(seed: Any) -> int:
    """Return the seed of the noise after a check of its type and range."""
    try:
        whole = operator.index(seed)
    except TypeError:
        whole = -1
    if whole < 0:
        raise CosimError(f"`seed` is `{seed!r}`, it must be a non-negative integer")
    return whole


def open_plant(scenario: Scenario, previous: Session | None) -> plant.Plant:
    """Plant of a scenario; an equal plant of the previous session is reused, another one closed."""
    wanted = chosen(scenario)
    if previous is not None:
        before = previous.scenario
        if (wanted, scenario.loop.record_qpos) == (chosen(before), before.loop.record_qpos):
            previous.has_plant = False
            return previous.plant
        previous.close_plant()
    built = plant.build(*wanted)
    if scenario.loop.record_qpos:
        with concerning("loop.record_qpos"):
            plant.record_qpos(built, scenario.plant.name)
    return built


def chosen(scenario: Scenario) -> tuple[str, dict[str, Any], Path]:
    """Name, parameters and folder of the plant; without a plant, its time step follows from the loop."""
    alone = {"timestep": scenario.loop.step / scenario.loop.substeps}
    return scenario.plant.name, scenario.plant.parameters if scenario.plant.name else alone, scenario.folder


def check_timestep(scenario: Scenario, timestep: float) -> None:
    """Check that the plant's substeps fill the communication step exactly."""
    step, substeps = scenario.loop.step, scenario.loop.substeps
    if abs(substeps * timestep - step) > TIMESTEP_TOLERANCE * step:
        hint, fitting = f"Make `loop.step` a multiple of {timestep:g} s.", round(step / timestep)
        if abs(fitting * timestep - step) <= TIMESTEP_TOLERANCE * step and 1 <= fitting <= MAX_SUBSTEPS:
            hint = f"Set `loop.substeps = {fitting}`."
        steps = f"`loop.substeps` = `{substeps}` plant steps of {timestep:g} s"
        with concerning("loop.substeps"):
            raise CosimError(f"{steps} do not fill `loop.step` = `{step:g}` s", hint)


@contextlib.contextmanager
def located(scenario: Scenario) -> Iterator[None]:
    """Add the file or override, and a hint, to errors that concern a key of the scenario."""
    try:
        yield
    except CosimError as error:
        if error.key:
            error.message = f"{scenario.origin(error.key)}: {error.message}"
            if isinstance(error, FmuError | PlantError) or error.key.startswith(("wire.", "inject.")):
                error.hint = error.hint or "List types, units and ranges with `cosim show`."
            error.key = ""
        raise
    except SystemExit as error:
        raise plant.exited(scenario.plant.name, error) from error
    except MemoryError as error:
        problem = f"a run of `loop.duration` = `{scenario.loop.duration:g}` s does not fit into memory"
        raise CosimError(problem, "Use several shorter runs with different seeds.") from error
