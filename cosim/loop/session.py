"""One run of a scenario."""

from __future__ import annotations

import contextlib
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from cosim import interrupts, paths
from cosim.closing import Closing
from cosim.errors import CosimError, PlantError, concerning
from cosim.fmu import readable
from cosim.fmu.archive import FmuFile, Variable, open_fmu
from cosim.fmu.instance import Instance
from cosim.loop import idle, native, plant, reference, trace
from cosim.loop.connect import driven
from cosim.loop.engines import Engine, checked
from cosim.loop.place import Place, Stage
from cosim.loop.reference import Parts, Progress, Run
from cosim.loop.result import Result
from cosim.loop.wiring import child
from cosim.metrics import criteria
from cosim.metrics.expression import Expression
from cosim.scenario.model import Scenario
from cosim.trace import endings
from cosim.trace.columns import structured
from cosim.trace.measure import measured

TIMESTEP_TOLERANCE = 1e-9
MOST_SUBSTEPS = 10**6
"""Substeps that a hint proposes at most; more is a mistake in the time step."""


class Session(Closing):
    """A scenario with its FMU and plant opened once; each `run` resets both.

    Parameters
    ----------
    scenario
        The scenario, see `cosim.load`.
    log_events
        Whether the FMU shall log events beside warnings and errors.
    engine
        `reference` is FMPy's loop, `native` does the same in native code, bit for bit; a plant written in
        Python runs in the reference loop in any case.
    previous
        A session that is not used any more: what it has open is taken over where it fits, else closed.
    place
        Told whose code runs; None is of no interest.

    Raises
    ------
    CosimError
        The FMU or plant cannot be opened, or does not fit the scenario.
    """

    def __init__(
        self,
        scenario: Scenario,
        log_events: bool = False,
        engine: Engine = "reference",
        previous: Session | None = None,
        place: Place | None = None,
    ) -> None:
        self.scenario = scenario
        self.place = place or Place()
        self.place.begin(
            scenario.controller.fmu, scenario.plant.name, scenario.loop.steps, scenario.loop.step
        )
        with located(scenario):
            with concerning("controller.fmu"):
                self.file = open_fmu(paths.find_fmu(scenario.controller.fmu, scenario.folder))
            self.place.at(Stage.BUILD_PLANT)
            self.plant = open_plant(scenario, previous)
            self.engine = native.choose(checked(engine), scenario.plant.name, self.plant)
            check_timestep(scenario, self.plant.timestep)
            inputs = driven(scenario, self.file)
            self.place.at(Stage.LOAD)
            self.fmu = open_instance(self.file, inputs, log_events, previous)
            self.place.at(Stage.NONE)
            try:
                self._compile()
            except CosimError:
                self.fmu.close()
                raise

    def _compile(self) -> None:
        """Compile all expressions against the columns of the trace."""
        found = trace.columns(self.fmu, self.plant)
        columns = {name: dict(v.items) if v and v.items else None for name, v in found.items()}
        self.columns = columns
        self.metrics = criteria.compile_metrics(
            self.scenario.metric, columns, trace.units(self.file, self.plant)
        )
        criteria.check_units(self.scenario.criterion, self.scenario.metric, self.metrics)
        stop = self.scenario.loop.stop_when
        with concerning("loop.stop_when"):
            self.stop = Expression(stop, columns, "`loop.stop_when`", rowwise=True) if stop else None

    def run(
        self, seed: int | None = None, progress: Progress | None = None, stream: str | Path | None = None
    ) -> Result:
        """Run the scenario once.

        Parameters
        ----------
        seed
            Seed of all noise; None is the scenario's.
        progress
            Told the steps done and in all.
        stream
            Parquet file that takes the trace while the run goes; None keeps it in memory.

        Raises
        ------
        CosimError
            The run could not be done, and leaves no file, or the session is closed.
        KeyboardInterrupt
            After the step in which Ctrl-C came.
        """
        scenario, place = self.scenario, self.place
        seed = scenario.loop.seed if seed is None else seed
        file = None if stream is None else endings.streamed(Path(stream))
        place.begin(scenario.controller.fmu, scenario.plant.name, scenario.loop.steps, scenario.loop.step)
        with located(scenario), interrupts.deferred() as interrupt:
            idle.report(scenario, self.file, self.plant)
            place.at(Stage.INITIALISE)
            self.fmu.initialise(scenario.controller.parameters)
            place.at(Stage.RESET_PLANT)
            reference.reset_plant(self.plant, scenario, child(seed, "plant"))
            result = self._result(seed)
            parts = Parts(scenario, self.fmu, self.plant, seed, self.stop, progress, interrupt, place)
            begin = time.perf_counter()
            done = self._loop(parts, result, file)
            result = replace(
                result,
                simulated_s=done.steps * scenario.loop.step,
                wall_s=time.perf_counter() - begin,
                trace=structured(done.table, list(self.columns)) if file is None else None,
                file=file,
            )
            place.at(Stage.NONE)
            readable.report(self.fmu)
            metrics = measured(scenario.metric, self.metrics, result.columns)
        return replace(result, metrics=metrics, criteria=criteria.judge(scenario.criterion, metrics))

    def _loop(self, parts: Parts, known: Result, file: Path | None) -> Run:
        """Run the loop; the trace goes into a file if there is one."""
        run = native.run if self.engine == "native" else reference.run
        if file is None:
            return run(parts)
        from cosim.trace.parquet import streaming

        with streaming(file, list(self.columns), known.about()) as writer:
            done = run(replace(parts, sink=writer))
            writer.finish(done.steps * self.scenario.loop.step)
        return done

    def _result(self, seed: int) -> Result:
        """Return what is known of a result before the run."""
        units = trace.units(self.file, self.plant)
        descriptions = trace.descriptions(self.file, self.plant)
        return Result(
            scenario=self.scenario.name,
            title=self.scenario.title,
            seed=seed,
            engine=self.engine,
            metrics={},
            criteria=[],
            simulated_s=0.0,
            wall_s=0.0,
            units={name: units[name] for name in self.columns},
            items={name: items for name, items in self.columns.items() if items},
            descriptions={name: descriptions[name] for name in self.columns},
            displays=trace.displays(self.file),
            fmus={self.scenario.controller.fmu: self.file.guid},
        )

    def close(self) -> None:
        """Free the FMU; the session cannot run any more."""
        self.place.at(Stage.CLOSE)
        self.fmu.close()
        self.place.at(Stage.NONE)


def open_plant(scenario: Scenario, previous: Session | None) -> plant.Plant:
    """Plant of a scenario, that of the previous session if it is the same."""
    if previous is not None:
        wanted, before = (
            (chosen(one), one.folder, one.loop.record_qpos) for one in (scenario, previous.scenario)
        )
        if wanted == before:
            return previous.plant
    built = plant.build(*chosen(scenario), scenario.folder)
    if scenario.loop.record_qpos:
        with concerning("loop.record_qpos"):
            plant.record_qpos(built, scenario.plant.name)
    return built


def chosen(scenario: Scenario) -> tuple[str, dict[str, Any]]:
    """Name and parameters of the plant; where there is none, the steps of nothing fill those of the loop."""
    if not scenario.plant.name:
        return "", {"timestep": scenario.loop.step / scenario.loop.substeps}
    return scenario.plant.name, scenario.plant.parameters


def open_instance(
    file: FmuFile, inputs: list[Variable], log_events: bool, previous: Session | None
) -> Instance:
    """Instance of an FMU, that of the previous session if it moves the same variables."""
    if previous is not None:
        same = previous.file is file and previous.fmu.driven == inputs
        if same and previous.fmu.log_events == log_events and not previous.fmu.dead:
            return previous.fmu
        previous.close()
    return Instance(file, inputs, trace.numeric_outputs(file), log_events)


def check_timestep(scenario: Scenario, timestep: float) -> None:
    """Check that the plant's substeps fill the communication step exactly."""
    step, substeps = scenario.loop.step, scenario.loop.substeps
    if abs(substeps * timestep - step) > TIMESTEP_TOLERANCE * step:
        fitting = round(step / timestep)
        fits = abs(fitting * timestep - step) <= TIMESTEP_TOLERANCE * step and 1 <= fitting <= MOST_SUBSTEPS
        hint = (
            f"set `loop.substeps = {fitting}`"
            if fits
            else f"`loop.step` must be a multiple of {timestep:g} s"
        )
        steps = f"`loop.substeps` = `{substeps}` plant steps of {timestep:g} s"
        with concerning("loop.substeps"):
            raise CosimError(f"{steps} do not fill `loop.step` = `{step:g}` s", hint)


@contextlib.contextmanager
def located(scenario: Scenario) -> Iterator[None]:
    """Put the file or override in front of errors that concern a key of the scenario, and a hint behind."""
    try:
        yield
    except CosimError as error:
        if error.key:
            error.message = f"{scenario.origin(error.key)}: {error.message}"
            error.hint = error.hint or "`cosim show` lists types, units and ranges"
            error.key = ""
        raise
    except SystemExit as error:
        problem = f"the plant `{scenario.plant.name}` ended the process: `sys.exit({error.code!r})`"
        raise PlantError(problem, "a plant raises an exception for what it cannot do") from error
    except MemoryError as error:
        problem = f"a run of `loop.duration` = `{scenario.loop.duration:g}` s does not fit into memory"
        raise CosimError(problem, "several shorter runs with other seeds need less") from error
