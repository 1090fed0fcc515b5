"""Verdicts of criteria: a run without criteria is not passed, and values are converted to the unit."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.errors import ExpressionError
from cosim.units import conversion

from ..conftest import END
from ..sweep import studies
from ..test_cli import CRITERION
from ..test_cli import cosim as command

Write = Callable[..., Path]


def test_nothing_demanded_is_not_passed(write: Write) -> None:
    write(END)
    assert cosim.run(cosim.load("lag.toml")).passed is None
    done = command("run", "lag.toml", "--json", "a.json")
    assert done.returncode == 0
    assert "no criteria; seed 1" in done.stdout
    assert json.loads(Path("a.json").read_text())["passed"] is None


def test_a_sweep_of_what_is_not_demanded_is_done_not_passed(write: Write, folder: Path) -> None:
    write(END)
    (folder / "study.toml").write_text(studies.GRID)
    done = studies.sweep("study.toml", "--json", "-")
    assert done.returncode == 0
    found = json.loads(done.stdout)
    assert (found["statuses"], found["passed"]) == ({"done": 12}, None)
    assert {row["status"] for row in studies.rows(folder / "study.sweep")} == {"done"}
    again = studies.sweep("study.toml")
    assert "12 of 12 runs: 12 done; no criteria" in again.stdout


UNITS = {
    ("m", "um"): 1e6,
    ("mm/s", "m/s"): 1e-3,
    ("m/s2", "mm/s2"): 1e3,
    ("N.m", "kN.mm"): 1.0,
    ("m^-1", "1/mm"): 1e-3,
    ("rpm", "rad/s"): 0.10471975511965977,
    ("1", "%"): 100.0,
    ("furlong", "furlong"): 1.0,
}

BEYOND = [("nm^-99", "m^-99"), ("nm99", "m99"), (".".join(["nm9"] * 5), ".".join(["m9"] * 5))]
"""Units whose scale is not a number of 64 bits."""


@pytest.mark.parametrize(("units", "factor"), UNITS.items())
def test_units_convert(units: tuple[str, str], factor: float) -> None:
    found = conversion(*units)
    assert found is not None
    assert found.factor == pytest.approx(factor, rel=1e-12)


@pytest.mark.parametrize(
    ("source", "target"), [("m", "s"), ("m", "1"), ("furlong", "m"), ("m//s", "m"), ("m2", "m"), *BEYOND]
)
def test_units_that_do_not_fit_do_not_convert(source: str, target: str) -> None:
    assert conversion(source, target) is None


def test_a_criterion_is_held_in_its_own_unit(write: Write) -> None:
    file = write(CRITERION)
    held = cosim.run(cosim.load(file, set=["criterion.end.unit=mm", "criterion.end.maximum=700"]))
    verdict = held.to_dict()["criteria"][0]
    assert verdict["value"] == pytest.approx(1e3 * held.metrics["end"].value)
    assert (verdict["unit"], verdict["passed"]) == ("mm", True)
    assert held.metrics["end"].unit == "m"
    # 667 mm is more than 0.7 mm, which the number alone does not show
    assert cosim.run(cosim.load(file, set=["criterion.end.unit=mm"])).passed is False


def test_a_unit_that_does_not_fit_is_rejected_before_the_run(write: Write) -> None:
    file = write(CRITERION)
    expected = r"--set criterion.end.*`criterion.end.unit` is `s`, `metric.end` is in `m`, which does not"
    with pytest.raises(ExpressionError, match=expected):
        cosim.Session(cosim.load(file, set="criterion.end.unit=s"))


def test_a_metric_without_unit_is_in_that_of_the_criterion(write: Write) -> None:
    file = write(CRITERION.replace('unit = "m"\n', "").replace("last(plant.x)", "sqrt(last(plant.x))"))
    verdict = cosim.run(cosim.load(file, set="criterion.end.unit=mm")).criteria[0]
    assert verdict.unit == "mm"
    assert verdict.value == pytest.approx(0.8165, abs=1e-3)


SHARE = CRITERION.replace('unit = "m"\n', "{}").replace("last(plant.x)", "last(plant.x) / (1 * m)")
"""A metric of which no unit is known."""


def test_percent_of_a_metric_without_unit_is_no_guess(write: Write) -> None:
    file = write(SHARE.format(""))
    expected = r"`criterion.end.unit` is `%`, `metric.end` has no unit; it is ambiguous"
    with pytest.raises(ExpressionError, match=expected) as caught:
        cosim.Session(cosim.load(file, set="criterion.end.unit=%"))
    assert caught.value.hint == 'Set `unit = "1"` in the metric if it is a fraction, otherwise `unit = "%"`.'


@pytest.mark.parametrize(("unit", "factor"), [("1", 100.0), ("%", 1.0)])
def test_percent_of_a_metric_with_unit_converts(unit: str, factor: float, write: Write) -> None:
    file = write(SHARE.format(f'unit = "{unit}"\n'))
    found = cosim.run(cosim.load(file, set="criterion.end.unit=%"))
    assert found.metrics["end"].unit == unit
    assert found.criteria[0].value == pytest.approx(factor * found.metrics["end"].value)


def test_a_number_that_is_a_part_of_one_is_no_length(write: Write) -> None:
    file = write(SHARE.format('unit = "1"\n'))
    with pytest.raises(ExpressionError, match=r"`metric.end` is in `1`, which does not convert to it"):
        cosim.Session(cosim.load(file, set="criterion.end.unit=mm"))
