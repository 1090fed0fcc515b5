"""Results: criteria, JSON, trace files, plots."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from html import unescape
from pathlib import Path

import fmpy
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import cosim
from cosim.errors import CosimError
from cosim.fmu.archive import open_fmu
from cosim.fmu.description import DisplayUnit
from cosim.formatting.quantity import text
from cosim.metrics.criteria import Verdict
from cosim.scenario.model import Criterion
from cosim.show import plot

from .conftest import DATA, END, SETTLING, pack

Write = Callable[..., Path]
LIBRARY = f"binaries/{fmpy.platform}/probe{fmpy.sharedLibraryExtension}"

MEASURED = f"""{SETTLING}{END}
[[metric]]
name = "never"
unit = "s"
value = "first_time(plant.x > 99)"
[[metric]]
name = "undefined"
value = "0 / 0"
[[criterion]]
id = "end"
claim = "settles"
paper = "about 0.7"
metric = "end"
minimum = 0.6
maximum = 0.7
[[criterion]]
id = "moved"
claim = "leaves zero"
metric = "end"
minimum = 0.1
"""

MEASURED_YES = """
[[metric]]
name = "moves"
value = "any(plant.x > 0)"
[[criterion]]
id = "moves"
claim = "moves"
metric = "moves"
equals = true
"""


def criterion(minimum: float | None, maximum: float | None, equals: float | bool | None) -> Criterion:
    return Criterion("c", "claim", "m", minimum=minimum, maximum=maximum, equals=equals)


limits = st.none() | st.floats(allow_nan=False)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@given(minimum=limits, maximum=limits, equals=limits)
def test_what_is_not_finite_never_passes(
    value: float, minimum: float | None, maximum: float | None, equals: float | None
) -> None:
    assert not Verdict(criterion(minimum, maximum, equals), value, "1").passed


finite = st.floats(allow_nan=False, allow_infinity=False)


@given(finite, finite)
def test_limits_are_inclusive(value: float, limit: float) -> None:
    assert Verdict(criterion(limit, None, None), value, "1").passed == (value >= limit)
    assert Verdict(criterion(None, limit, None), value, "1").passed == (value <= limit)
    assert Verdict(criterion(None, None, limit), value, "1").passed == (value == limit)
    assert Verdict(criterion(limit, limit, limit), limit, "1").passed


def test_yes_and_no_are_booleans_in_the_json(write: Write) -> None:
    found = cosim.run(cosim.load(write(MEASURED_YES))).to_dict()["criteria"][0]
    assert found["value"] is True
    assert found["limit"] == "= true"
    number = cosim.load(write(MEASURED_YES), set=["criterion.moves.equals=1"])
    assert cosim.run(number).to_dict()["criteria"][0]["value"] is not True


def test_equals_takes_booleans() -> None:
    assert Verdict(criterion(None, None, True), 1.0, "1").passed
    assert not Verdict(criterion(None, None, True), 0.0, "1").passed


def test_the_json_holds_what_the_run_measured(write: Write) -> None:
    result = cosim.run(cosim.load(write(MEASURED)), seed=7)
    found = json.loads(result.to_json(), parse_constant=lambda name: pytest.fail(f"not strict JSON: {name}"))
    names = "loop scenario seed engine metrics criteria status passed simulated_s wall_s"
    assert list(found) == names.split()
    assert (found["loop"], found["scenario"], found["seed"], found["engine"]) == (
        "lag",
        "lag",
        7,
        "reference",
    )
    assert found["metrics"]["end"] == {"value": result.metrics["end"].value, "unit": "m"}
    assert found["metrics"]["never"] == {"value": "Infinity", "unit": "s"}
    assert found["metrics"]["undefined"]["value"] == "NaN"
    assert math.isinf(float(found["metrics"]["never"]["value"]))
    assert found["criteria"][0] == {
        "id": "end",
        "claim": "settles",
        "paper": "about 0.7",
        "value": result.metrics["end"].value,
        "limit": ">= 0.6 and <= 0.7",
        "unit": "m",
        "passed": True,
    }
    assert found["criteria"][1]["passed"] is True
    assert found["passed"] is True
    assert found["simulated_s"] == 0.05
    assert found["wall_s"] > 0.0


def test_a_run_fails_with_any_criterion(write: Write) -> None:
    result = cosim.run(cosim.load(write(MEASURED), set=["criterion.moved.metric=undefined"]))
    assert [verdict.passed for verdict in result.criteria] == [True, False]
    assert not result.passed


def test_a_metric_must_be_one_number(write: Write) -> None:
    scenario = cosim.load(write(MEASURED), set=["metric.end.value=plant.x"])
    with pytest.raises(CosimError, match=r"`metric.end.value` = `plant.x` gives 50 values, not one\nhint: "):
        cosim.run(scenario)


def test_the_csv_is_read_by_fmpy(write: Write, folder: Path) -> None:
    result = cosim.run(cosim.load(write()))
    assert result.trace is not None
    result.save_trace(folder / "trace.csv")
    ours = fmpy.read_csv(folder / "trace.csv")
    assert ours.dtype.names == result.trace.dtype.names
    assert ours.dtype.names[0] == "time"
    for name in ours.dtype.names:
        assert ours[name].tobytes() == result.trace[name].tobytes()
    fmpy.write_csv(folder / "fmpy.csv", result.trace)
    theirs = fmpy.read_csv(folder / "fmpy.csv")
    assert theirs["plant.x"].tobytes() == result.trace["plant.x"].tobytes()


def test_the_npz_is_read_by_numpy_alone(write: Write, folder: Path) -> None:
    result = cosim.run(cosim.load(write()))
    assert result.trace is not None
    result.save_trace(folder / "trace.npz")
    with np.load(folder / "trace.npz", allow_pickle=False) as saved:
        assert saved["trace"].dtype == result.trace.dtype
        assert saved["trace"].tobytes() == result.trace.tobytes()


def test_units_of_columns_are_known(write: Write) -> None:
    result = cosim.run(cosim.load(write()))
    assert result.units["time"] == "s"
    assert result.units["controller.in"] == "m"
    assert result.units["plant.x"] == "m"


PANELS = """
[plot]
zoom = "controller.calls == 20"
[[plot.panels]]
title = "Lag"
columns = ["plant.x", "controller.in"]
unit = "mm"
scale = 1e3
[[plot.panels]]
columns = ["controller.mode_out"]
"""


LOGARITHMIC = PANELS.replace("scale = 1e3", "log = true")
VARIANTS = [
    "",
    PANELS,
    PANELS.replace("== 20", "> 999"),
    LOGARITHMIC,
    LOGARITHMIC.replace('"plant.x", "controller.in"', '"plant.extra"'),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("added", VARIANTS)
def test_a_plot_is_drawn_and_the_same_each_time(write: Write, folder: Path, added: str) -> None:
    scenario = cosim.load(write(added))
    with cosim.Session(scenario) as session:
        session.check_drawn()
        result = session.run()
    for name in ("one.svg", "two.svg", "one.png"):
        plot.save(scenario, result, folder / name)
    assert (folder / "one.svg").read_bytes() == (folder / "two.svg").read_bytes()
    assert (folder / "one.png").read_bytes().startswith(b"\x89PNG")


DISPLAYED = [
    ('<BaseUnit m="1"/>', '<BaseUnit m="1"/><DisplayUnit name="um" factor="1e6"/>'),
    ('<Real unit="m" start="0"/>', '<Real unit="m" displayUnit="um" start="0"/>'),
    ('causality="output"><Real unit="m"/>', 'causality="output"><Real unit="m" displayUnit="um"/>'),
]
MODES = f"""{SETTLING}
[[signal]]
to = "controller.mode"
times = [0.0, 0.02]
values = ["Slow", "Fast"]
"""


@pytest.fixture
def texts(write: Write, folder: Path, probe_library: bytes) -> Callable[[str], list[str]]:
    """Texts of the plot of a scenario with a probe that has display units."""
    description = (DATA / "probe.xml").read_text()
    for old, new in DISPLAYED:
        assert old in description
        description = description.replace(old, new)
    pack(folder / "probe.fmu", description, {LIBRARY: probe_library})

    def texts_of(added: str) -> list[str]:
        scenario = cosim.load(write(added))
        plot.save(scenario, cosim.run(scenario), folder / "plot.svg")
        # matplotlib draws letters and leaves the text as a comment
        return re.findall(r"<!-- (.*?) -->", (folder / "plot.svg").read_text())

    return texts_of


def panel(columns: str, more: str = "") -> str:
    return f"{MODES}\n[[plot.panels]]\ncolumns = {columns}\n{more}\n"


@pytest.mark.parametrize("more", ["", "log = true\n"])
def test_a_dollar_begins_no_formula(texts: Callable[[str], list[str]], more: str) -> None:
    title = r"$\frac{$ and $x$"
    shown = texts(panel('["plant.x"]', f"title = '{title}'\nunit = '$'\n{more}"))
    assert {title, "$"} <= {unescape(text).strip() for text in shown}
    assert not any("mathdefault" in text for text in shown if not more)


def test_a_panel_without_a_unit_is_in_the_display_unit_of_the_fmu(texts: Callable[[str], list[str]]) -> None:
    shown = texts(panel('["controller.in"]'))
    assert "um" in shown
    assert "1e6" in shown  # the lag starts at 1 m
    # a ground-truth signal of the plant is plotted with it in the same unit
    both = texts(panel('["plant.x", "controller.in"]'))
    assert ("um" in both, "m" in both) == (True, False)
    mixed = texts(panel('["plant.random", "controller.in"]'))
    assert "um" not in mixed


@pytest.mark.parametrize(
    ("more", "unit", "tick"), [('unit = "m"', "m", "1.0"), ('unit = "mm"\nscale = 1e3', "mm", "1000")]
)
def test_the_unit_of_a_panel_goes_before(
    texts: Callable[[str], list[str]], more: str, unit: str, tick: str
) -> None:
    shown = texts(panel('["controller.in"]', more))
    assert unit in shown
    assert tick in shown
    assert "um" not in shown


@pytest.mark.parametrize("columns", ['["controller.mode_out"]', '["controller.mode", "controller.mode_out"]'])
def test_enumerations_are_named_on_the_axis(texts: Callable[[str], list[str]], columns: str) -> None:
    shown = texts(panel(columns))
    assert {"Slow", "Fast"} <= set(shown)
    assert "Off" not in shown


def test_a_scenario_without_panels_names_enumerations_and_uses_display_units(
    texts: Callable[[str], list[str]],
) -> None:
    shown = texts(MODES)
    assert {"Slow", "Fast", "um", "controller.mode_out", "controller.calls"} <= set(shown)
    assert "m" not in shown


GAP = """<SimpleType name="Gap">
<Real unit="m" displayUnit="shifted" relativeQuantity="true"/></SimpleType>"""


def test_a_difference_has_no_offset_in_its_display_unit(folder: Path) -> None:
    description = (DATA / "probe.xml").read_text()
    for old, new in [
        ('<BaseUnit m="1"/>', '<BaseUnit m="1"/><DisplayUnit name="shifted" factor="2" offset="5"/>'),
        ('<Real unit="m" start="0"/>', '<Real unit="m" displayUnit="shifted" start="0"/>'),
        ('causality="output"><Real unit="m"/>', 'causality="output"><Real declaredType="Gap"/>'),
        ("</TypeDefinitions>", f"{GAP}</TypeDefinitions>"),
    ]:
        description = description.replace(old, new)
    pack(folder / "probe.fmu", description, {LIBRARY: b""})
    variables = open_fmu(folder / "probe.fmu").variables
    assert variables["in"].display == DisplayUnit("shifted", 2.0, 5.0)
    assert variables["out"].display == DisplayUnit("shifted", 2.0)
    assert variables["gain"].display is None


@pytest.mark.parametrize(
    ("columns", "problem"),
    [
        ('"plant.xx"', r"`plant\.xx`, which is not a column"),
        ("", r"`plot\.panels\[0\]\.columns` is empty"),
    ],
)
def test_a_wrong_column_of_a_plot_is_found_before_the_run(
    write: Write, folder: Path, columns: str, problem: str
) -> None:
    scenario = cosim.load(write(PANELS.replace('"plant.x", "controller.in"', columns)))
    with cosim.Session(scenario) as session, pytest.raises(CosimError, match=problem):
        session.check_drawn()


QUANTITIES = [
    (4.5e-7, "m", "450 nm"),
    (9.9999e-7, "m", "1 um"),
    (-1.234567e-3, "m", "-1.235 mm"),
    (0.0, "m", "0 m"),
    (12.0, "m", "12 m"),
    (3600.0, "s", "3600 s"),
    (2.5e-3, "s", "2.5 ms"),
    (5e4, "Hz", "50 kHz"),
    (1.2e-30, "m", "1.2e-30 m"),
    (5e-324, "m", "4.941e-324 m"),
    (3e14, "Pa", "3e+14 Pa"),
    (17_249.8, "rpm", "17250 rpm"),
    (-1.25e7, "1/s", "-12500000 1/s"),
    (1.234567e7 + 0.5, "1/s", "1.235e+07 1/s"),
    (math.inf, "s", "inf s"),
    (math.nan, "m", "nan m"),
    (7.0, "1", "7"),
    (0.123456, "1", "0.1235"),
    (100.0, "rad/s", "100 rad/s"),
]


@pytest.mark.parametrize(("value", "unit", "shown"), QUANTITIES)
def test_quantities_are_shown_with_a_prefix(value: float, unit: str, shown: str) -> None:
    assert text(value, unit) == shown
