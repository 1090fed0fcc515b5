"""Which variables of an FMU are recorded."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.fmu.description import FmuFile, Variable
from cosim.loop.recorder import LOCALS_MAX, recorded


def variable(name: str, causality: str, variability: str = "discrete", kind: str = "Real") -> Variable:
    return Variable(name, 0, kind, causality, variability, "", "0", "", "", "")


def fmu(locals_: int) -> FmuFile:
    variables = [
        variable("u", "input"),
        variable("y", "output"),
        *(variable(f"x{i}", "local") for i in range(locals_)),
        variable("g", "local", "constant"),
        variable("m", "local", "fixed"),
        variable("t", "output", kind="String"),
    ]
    return FmuFile(Path(), Path(), "", "", "", "", {v.name: v for v in variables})


@pytest.mark.parametrize(
    ("locals_", "choice", "found"),
    [
        (2, None, ["y", "x0", "x1"]),
        (2, True, ["y", "x0", "x1"]),
        (2, False, ["y"]),
        (LOCALS_MAX + 1, None, ["y"]),
    ],
)
def test_outputs_are_recorded_and_local_variables_by_choice(
    locals_: int, choice: bool | None, found: list[str]
) -> None:
    assert [v.name for v in recorded(fmu(locals_), choice)] == found


def test_all_local_variables_are_recorded_on_request() -> None:
    assert len(recorded(fmu(LOCALS_MAX), None)) == 1 + LOCALS_MAX
    assert len(recorded(fmu(LOCALS_MAX + 1), True)) == 2 + LOCALS_MAX
