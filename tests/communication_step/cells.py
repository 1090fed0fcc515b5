"""One cell of a table: a closed loop at one communication step, delay and `io_delay`."""

from __future__ import annotations

import logging
import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import product

import cosim
from cosim.errors import CosimError, PlantError

from .loops import Loop

SAMPLES = (0.1, 0.5, 1.0, 2.0, 5.0, 10.0)
"""Communication steps, in sample periods."""
DELAYS = (0, 1, 2)
"""Communication steps from an output to its action."""
LONGEST_DELAY = 8
"""Maximum of `io_delay`, samples."""
WORKS = 2.0
"""Maximum ratio of the number of a working loop to that of the nominal cell."""
ROUNDING = 1e-9
WARNING = "the communication step `"
"""Part of the warning of an FMU whose communication step is too long."""


@dataclass(frozen=True)
class Cell:
    """Communication step in samples, delay in steps, and whether `io_delay` is right."""

    samples: float
    delay: int
    right: bool

    @property
    def told(self) -> int:
        """`io_delay`: the samples of the delay, rounded; where it is wrong one less, or 1 instead of 0."""
        samples = min(LONGEST_DELAY, math.floor(self.delay * self.samples + 0.5))
        if self.right:
            return samples
        return samples - 1 if samples else 1


NOMINAL = Cell(1.0, 1, True)
CELLS = tuple(Cell(*one) for one in product(SAMPLES, DELAYS, (True, False)))


@dataclass(frozen=True)
class Outcome:
    """Result: the number of a complete cycle, otherwise the reason; and whether the FMU warned."""

    number: float | None
    problem: str
    warned: bool

    @property
    def gravity(self) -> tuple[bool, float]:
        """How bad it is: what was not done is worse than any number."""
        return bool(self.problem), self.number or 0.0


def overrides(loop: Loop, cell: Cell) -> list[str]:
    """Override what makes the cell of the scenario."""
    step = float(f"{cell.samples * loop.period:.12g}")
    substeps = math.ceil(step / loop.timestep - ROUNDING)
    commands = [wire.to for wire in cosim.load(loop.scenario).wire if wire.source.startswith("controller.")]
    return [
        f"loop.step={step!r}",
        f"loop.substeps={substeps}",
        f"plant.timestep={step / substeps!r}",
        f"loop.compute_delay={min(cell.delay, 1)}",
        f"loop.record_every={max(1, round(1 / cell.samples))}",
        f"controller.io_delay={cell.told}",
        *(f"wire.{command}.delay={max(cell.delay - 1, 0)}" for command in commands),
    ]


def measure(loop: Loop, cell: Cell) -> Outcome:
    """Run the cell with all its seeds; the worst outcome."""
    scenario = cosim.load(loop.scenario, set=overrides(loop, cell))
    with listening() as heard:
        try:
            with cosim.Session(scenario, engine="native") as session:
                seeds = range(scenario.loop.seed, scenario.loop.seed + loop.seeds)
                runs = [evaluated(loop, session.run(seed=seed)) for seed in seeds]
        except PlantError:
            runs = [(None, "plant stops")]
        except CosimError as error:
            if not error.message.startswith("the FMU rejected its parameters"):
                raise
            runs = [(None, "rejected")]
    warned = any(WARNING in text for text in heard)
    return max((Outcome(*run, warned) for run in runs), key=lambda outcome: outcome.gravity)


def warnings(loop: Loop, cell: Cell, steps: int) -> int:
    """Count the warnings of the FMU about the communication step in some steps of the cell."""
    scenario = cosim.load(loop.scenario, set=overrides(loop, cell))
    short = replace(scenario.loop, duration=steps * scenario.loop.step, record_every=1, stop_when="")
    with listening() as heard:
        cosim.run(replace(scenario, loop=short, metric=(), criterion=()), engine="native")
    return sum(WARNING in text for text in heard)


def evaluated(loop: Loop, result: cosim.Result) -> tuple[float | None, str]:
    """Return the number of a run that ended as it should, else its first fault or its last state."""
    assert result.trace is not None
    names = {number: name for name, number in result.items["controller.fault"].items()}
    faults = [names[int(number)] for number in result.trace["controller.fault"]]
    fault = next((name for name in faults if name != "None"), "")
    if fault:
        return None, f"`{fault}`"
    if loop.is_done(result):
        return loop.number(result), ""
    states = {number: name for name, number in result.items["controller.state"].items()}
    return None, f"**no fault, `{states[int(result.trace['controller.state'][-1])]}`**"


@contextmanager
def listening() -> Iterator[list[str]]:
    """Listen to what FMUs say meanwhile, instead of showing it."""
    heard: list[str] = []

    class Ear(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            heard.append(record.getMessage())

    log, ear = logging.getLogger("cosim.fmu"), Ear()
    log.addHandler(ear)
    log.propagate = False
    try:
        yield heard
    finally:
        log.removeHandler(ear)
        log.propagate = True
