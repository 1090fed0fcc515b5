"""Run the rows of a fault matrix and evaluate each."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

import cosim
from cosim.formatting.quantity import text
from cosim.metrics.criteria import Measured
from cosim.scenario.injection import Injection
from cosim.scenario.model import Metric, Scenario

from .matrix import DONE, Matrix, Row

FAULT = "controller.fault"
ENABLE = "controller.drive_enable"


@dataclass(frozen=True)
class Outcome:
    """Result of one row.

    Parameters
    ----------
    row
        The row.
    found
        Faults that the controller raised, in their order.
    after
        Time from the start of the injection, or of the run, to the first later one of them, s.
    excursion
        Actual excursion, in `unit`.
    problems
        Requirements that are not met.
    """

    row: Row
    found: tuple[str, ...]
    after: float
    excursion: float
    unit: str
    problems: tuple[str, ...]


class Runner:
    """Runs the rows of one matrix, each once; each session reuses what the one before has open."""

    def __init__(self, matrix: Matrix) -> None:
        self.matrix = matrix
        self.session: cosim.Session | None = None
        self.done: dict[str, Outcome] = {}

    def outcome(self, row: Row) -> Outcome:
        """Outcome of a row."""
        if row.name not in self.done:
            scenario = changed(self.matrix, row)
            self.session = cosim.Session(scenario, engine="native", previous=self.session)
            self.done[row.name] = evaluated(row, self.session.run(), scenario)
        return self.done[row.name]

    def outcomes(self) -> list[Outcome]:
        """Outcomes of all rows."""
        return [self.outcome(row) for row in self.matrix.rows]

    def close(self) -> None:
        """Close the open session."""
        if self.session is not None:
            self.session.close()
            self.session = None


@contextlib.contextmanager
def running(matrix: Matrix) -> Iterator[Runner]:
    """Runner of a matrix, closed at the end."""
    runner = Runner(matrix)
    try:
        yield runner
    finally:
        runner.close()


def changed(matrix: Matrix, row: Row) -> Scenario:
    """Scenario of a row: with its fault and the metrics of its excursion and result."""
    scenario = cosim.load(row.scenario or matrix.scenario, set=list(row.changes))
    loop = replace(scenario.loop, seed=matrix.seed, stop_when=matrix.stop or scenario.loop.stop_when)
    targets = {signal.to for signal in row.signals}
    return replace(
        scenario,
        loop=loop,
        inject=(*scenario.inject, *row.inject),
        signal=(*(one for one in scenario.signal if one.to not in targets), *row.signals),
        metric=(
            Metric("excursion", row.truth, row.unit),
            Metric("good", matrix.good, "1"),
            Metric("rest", matrix.rest, "1"),
        ),
        criterion=(),
    )


def evaluated(row: Row, result: cosim.Result, scenario: Scenario) -> Outcome:
    """Outcome of a row from its run."""
    assert result.trace is not None
    trace, metrics = result.trace, result.metrics
    items = {number: name for name, number in result.items[FAULT].items()}
    faults = [items[number] for number in trace[FAULT]]
    raised = {
        name: float(trace["time"][faults.index(name)]) for name in dict.fromkeys(faults) if name != DONE
    }
    found = tuple(raised)
    began = min((time for time in result.injected if time is not None), default=0.0)
    excursion = metrics["excursion"]
    good, rest = (bool(metrics[name].value) for name in ("good", "rest"))
    driven = ENABLE not in result.units or bool(trace[ENABLE][-1])
    problems = (
        *unmet(row, found, good),
        *early(row, raised, began),
        *(f"`inject.{one.to}` never started" for one in late(result, scenario)),
        *(f"`{name}` is not finite" for name in broken(result, scenario)),
        *([] if rest or not driven else ["the machine moves at the end with its drive on"]),
        *([] if excursion.value <= row.limit else [beyond(row, excursion)]),
    )
    return Outcome(row, found, answered(raised, began), excursion.value, excursion.unit, problems)


def beyond(row: Row, excursion: Measured) -> str:
    """Sentence about an excursion above its limit."""
    limit = text(row.limit, excursion.unit)
    return f"the excursion is {text(excursion.value, excursion.unit)}, it must not be above {limit}"


def unmet(row: Row, found: tuple[str, ...], good: bool) -> Iterator[str]:
    """Sentences about faults that are not correct or missing."""
    right = " or ".join(f"`{name}`" for name in row.faults)
    if row.undetectable and good:
        yield "no fault was expected: the cycle completed with a good result"
    if not found and row.undetectable:
        return
    if not found and DONE not in row.faults:
        yield f"undetected: no fault, expected {right}"
    if not found and DONE in row.faults and not good:
        yield "undetected: no fault, and no good result"
    if row.sequence and found != row.faults:
        yield f"raised {', '.join(found)}, expected {', '.join(row.faults)} in this order"
    for name in found:
        if name not in row.faults:
            yield f"raised `{name}`, expected {right}"


def answered(raised: dict[str, float], began: float) -> float:
    """Time (s) from `began` to the first fault raised since; NaN without one."""
    return next((time - began for time in raised.values() if time >= began), np.nan)


def early(row: Row, raised: dict[str, float], began: float) -> Iterator[str]:
    """Sentences about faults that were raised before the one of the row began, at a time in s."""
    for name, time in raised.items():
        if time < began and not row.sequence:
            yield f"raised `{name}` {text(began - time, 's')} before the injection"


def late(result: cosim.Result, scenario: Scenario) -> Iterator[Injection]:
    """Injections that never started."""
    for entry, began in zip(scenario.inject, result.injected, strict=True):
        if began is None:
            yield entry


def broken(result: cosim.Result, scenario: Scenario) -> Iterator[str]:
    """Columns with NaN or infinity; an input may get them from an injection."""
    assert result.trace is not None
    changed = {entry.to for entry in scenario.inject}
    for name in result.units:
        if name not in changed and not np.isfinite(result.trace[name]).all():
            yield name
