"""A fault matrix as data: a controller has one, `MATRIX` in the file of its name."""

from __future__ import annotations

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cosim.scenario.injection import Injection
from cosim.scenario.model import Signal

DONE = "None"
"""Item of the output `fault` that says that there is none: the job must then be done, and good."""


@dataclass(frozen=True)
class Row:
    """One fault.

    Parameters
    ----------
    name
        What is wrong, in the words of the page: "encoder frozen in motion".
    faults
        Which faults are right, by the items of the output `fault`; `DONE` is among them where the job may as
        well be done and good. Every fault that the run shows must be among them.
    truth
        Expression over the trace, a number: the true excursion of the machine until its safe end.
    limit
        What the excursion must not be above, in its unit.
    why
        Where the limit comes from, in one line.
    inject
        The fault, where it is one of values.
    signals
        Stimuli in place of the scenario's for the same target, or beside them.
    changes
        Overrides, `controller.stage.mass=3`.
    scenario
        Scenario that this row changes; empty is that of the matrix.
    unit
        Unit of the excursion, where the expression does not tell it.
    sequence
        Whether all of `faults` must come, in their order: one that is found while another is ended.
    untold
        Why no reading of the machine tells this fault, in one line, which the page says; empty for all that
        must be told.
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
    untold: str = ""


@dataclass(frozen=True)
class Matrix:
    """The faults of one controller.

    Parameters
    ----------
    scenario
        Scenario that its rows change; its criteria do not count here.
    seed
        Seed of all runs, used nowhere else.
    good
        Expression over the trace: the job is done, and the part is good.
    rest
        Expression over the trace: at the end the machine stands; not asked for where `drive_enable` is false.
    rows
        The faults.
    stop
        Condition over the current row that ends a run; empty is that of the scenario. It must leave the
        machine the time to come to its safe end.
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
