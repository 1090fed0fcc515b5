"""A fault matrix as data: a controller has one, `MATRIX` in the module of its name."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

DONE = "None"
"""Item of the output `fault` for no fault: the cycle must then complete with a good result."""


@dataclass(frozen=True)
class Row:
    """One simulated fault.

    Parameters
    ----------
    name
        Description on the page: "encoder frozen in motion".
    faults
        Correct faults, by the items of the output `fault`; with `DONE` if the cycle may also complete with a
        good result. Every fault that the run raises must be among them.
    truth
        Expression over the trace, a number: the actual excursion until the end of the reaction.
    limit
        Maximum of the excursion, in its unit.
    why
        Reason for the limit, in one line.
    inject
        The fault, if it changes values.
    signals
        Stimuli that replace those of the scenario for the same target, or add to them.
    changes
        Overrides, `controller.stage.mass=3`.
    scenario
        Scenario that this row changes; empty: that of the matrix.
    unit
        Unit of the excursion, if the expression does not determine it.
    sequence
        Whether all of `faults` must occur in their order: one is found while another is handled.
    undetectable
        Why no measurement shows this fault, in one line for the page; empty if it must be detected.
    """

    name: str
    faults: tuple[str, ...]
    truth: str
    limit: float
    why: str
    inject: tuple[Injection, ...] = ()
    signals: tuple[Signal, ...] = ()
    changes: Sequence[str] = ()
    scenario: str = ""
    unit: str = ""
    sequence: bool = False
    undetectable: str = ""


@dataclass(frozen=True)
class Matrix:
    """The faults of one controller.

    Parameters
    ----------
    scenario
        Scenario that its rows change; its criteria are not evaluated.
    seed
        Seed of all runs, used nowhere else.
    good
        Expression over the trace: the cycle completed, and the part is good.
    rest
        Expression over the trace: at the end the machine is at rest; ignored if `drive_enable` is false.
    rows
        The faults.
    stop
        Condition over the current row that ends a run; empty: that of the scenario. It must leave enough
        time for the reaction to end.
    """

    scenario: str
    seed: int
    good: str
    rest: str
    rows: tuple[Row, ...]
    stop: str = ""


def names() -> list[str]:
    """List the controllers that have a matrix."""
    crates = Path(__file__).resolve().parents[2].glob("fmu-*/Cargo.toml")
    found = sorted(crate.parent.name.removeprefix("fmu-") for crate in crates)
    return [name for name in found if Path(__file__).with_name(f"{name}.py").is_file()]


def load(name: str) -> Matrix:
    """Matrix of a controller."""
    found: Matrix = importlib.import_module(f"{__package__}.{name}").MATRIX
    return found
