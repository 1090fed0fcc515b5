"""Units: conversions by base units, definitions of FMUs, and temperatures."""

from __future__ import annotations

import pickle
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.check import lint
from cosim.errors import ExpressionError
from cosim.metrics.criteria import compile_metrics, converted, drawn, unit_of
from cosim.metrics.expression import Expression, Items
from cosim.new.draft import End, match
from cosim.scenario.model import Criterion, Metric
from cosim.units import BASES, CONSTANTS, Definition, Unit, beyond_si, conversion, defined, of_fmu

from ..conftest import DATA, entry, grid, pack
from ..loop.test_named import library

Write = Callable[..., Path]
WithUnit = Callable[[str, str, str], None]

EQUAL = {
    "MPa": (10.0, "bar"),
    "bar": (1e5, "Pa"),
    "hPa": (100.0, "N/m2"),
    "J": (1.0, "N.m"),
    "Nm": (1.0, "kg.m2/s2"),
    "kW": (1e3, "V.A"),
    "W": (1.0, "J/s"),
    "min": (60.0, "s"),
    "h": (60.0, "min"),
    "uA": (1e-3, "mA"),
    "µA": (1.0, "uA"),
    "Ohm": (1.0, "V/A"),
    "k\N{OHM SIGN}": (1e3, "Ohm"),
    "Hz": (1.0, "1/s"),
    "rev/min": (1.0, "rpm"),
    "deg": (1.0, "°"),
    "l/min": (1e-3 / 60.0, "m3/s"),
    "m²": (1e6, "mm2"),
    "W/(m2.K)": (1e-3, "mW/(mm2.K)"),
    "g": (1e-3, "kg"),
    "mg": (1e-6, "kg"),
    "cm": (1e-2, "m"),
    "ml": (1e-6, "m3"),
    "kWh": (3.6e6, "J"),
}


@pytest.mark.parametrize(("source", "number", "target"), [(s, *found) for s, found in EQUAL.items()])
def test_units_of_si_convert(source: str, number: float, target: str) -> None:
    found, back = conversion(source, target), conversion(target, source)
    assert found is not None
    assert back is not None
    assert found.factor == pytest.approx(number, rel=1e-14)
    assert not found.offset
    assert back.factor == pytest.approx(1.0 / number, rel=1e-14)


@pytest.mark.parametrize(
    ("source", "target"),
    [
        ("Hz", "rad/s"),
        ("Pa", "J"),
        ("rad", "1"),
        ("kmin", "s"),
        ("MK.", "K"),
        ("", "m"),
        ("pm9.pm9.pm9.pm9", "m9.m9.m9.m9"),
    ],
)
def test_other_quantities_do_not_convert(source: str, target: str) -> None:
    assert conversion(source, target) is None


def test_temperatures_have_an_offset() -> None:
    for source, target, value, wanted in [
        ("degC", "K", 20.0, 293.15),
        ("K", "degC", 273.15, 0.0),
        ("degF", "°C", 212.0, 100.0),
    ]:
        found = conversion(source, target)
        assert found is not None
        assert found(value) == pytest.approx(wanted)
        assert found.back(wanted) == pytest.approx(value)
    assert conversion("W/degC", "W/K") == (1.0, 0.0)


KINDS = {
    "max(p.t)": 26.85,
    "mean(p.t[time > 0])": 26.85,
    "clip(last(p.t), 0, 400)": 26.85,
    "max(p.t) - min(p.t)": None,
    "ptp(p.t) / 2": None,
    "hold(p.t, 1 > 0)[0 < time]": 26.85,
    "max(p.t) - 273.15": None,
    "2 * max(p.t)": None,
    "-max(p.t)": None,
}


@pytest.mark.parametrize(("text", "wanted"), KINDS.items(), ids=KINDS.keys())
def test_a_temperature_converts_only_where_its_zero_is_clear(text: str, wanted: float | None) -> None:
    (made,) = compile_metrics((Metric("t", text),), {"time": None, "p.t": None}, {"p.t": "K"})
    criterion = Criterion("a", "c", "t", unit="degC", maximum=30.0)
    unit = unit_of(Metric("t", text), made)
    if wanted is None:
        # a number without unit is in that of the criterion
        assert (unit, converted(criterion, unit)) == ("", (1.0, 0.0))
        return
    assert converted(criterion, unit)(300.0) == pytest.approx(wanted)
    assert drawn(criterion, unit) == [pytest.approx(300.0 - wanted + 30.0)]


def base(**more: Any) -> SimpleNamespace:
    return SimpleNamespace(**{**dict.fromkeys(BASES, 0), "factor": 1.0, "offset": 0.0, **more})


def test_the_definition_of_an_fmu_precedes_that_of_si() -> None:
    known = of_fmu(
        [
            SimpleNamespace(name="turn", baseUnit=base(rad=1, factor=6.28)),
            SimpleNamespace(name="min", baseUnit=base(m=1, factor=2.0)),
            SimpleNamespace(name="rad/s", baseUnit=base(s=-1)),
            SimpleNamespace(name="rpm", baseUnit=base(s=-1, factor=1.0 / 60.0)),
            SimpleNamespace(name="bad", baseUnit=base(m=1, factor=0.0)),
            SimpleNamespace(name="text", baseUnit=None),
        ]
    )
    assert conversion(Unit("turn", known), "rad") == (6.28, 0.0)
    assert conversion(Unit("turn/s", known), "rad/s") == (6.28, 0.0)
    assert conversion(Unit("min", known), "m") == (2.0, 0.0)
    assert conversion("min", "s") == (60.0, 0.0)
    # a target is in the units of the FMU, too
    assert conversion(Unit("rad", known), "turn") == (1.0 / 6.28, 0.0)
    # some tools omit rad; 1/60 is a frequency
    assert known["rad/s"] == defined("rad/s")
    assert conversion(Unit("rpm", known), "Hz") == (1.0 / 60.0, 0.0)
    assert set(known) == {"turn", "min", "rad/s", "rpm"}
    assert beyond_si([Unit("rad/s", known), Unit("m", known)]) == {}
    names: dict[str, Items | None] = {"time": None, "a.x": None}
    derivative = Expression("derivative(a.x)", names, "`m`", units={"a.x": Unit("turn", known)})
    assert conversion(derivative.unit or "", "rad/s") == (6.28, 0.0)


def test_a_unit_keeps_its_definition_in_another_process() -> None:
    unit = Unit("turn", {"turn": Definition(factor=2.0)})
    copy = pickle.loads(pickle.dumps(unit))
    assert (copy, copy.known) == ("turn", unit.known)


@pytest.fixture
def with_unit(folder: Path, probe_library: bytes) -> WithUnit:
    """Pack the probe with another unit of its output, by the base units of that."""

    def build(file: str, unit: str, base: str) -> None:
        definition = f'<Unit name="{unit}"><BaseUnit {base}/></Unit></UnitDefinitions>'
        text = (DATA / "probe.xml").read_text().replace("</UnitDefinitions>", definition)
        text = text.replace('causality="output"><Real unit="m"', f'causality="output"><Real unit="{unit}"')
        pack(folder / file, text, {library(): probe_library})

    return build


def test_a_criterion_converts_by_the_units_of_the_fmu(write: Write, with_unit: WithUnit) -> None:
    with_unit("s.fmu", "stride", 'm="1" factor="0.75"')
    demand = entry("metric", name="end", value="last(controller.out)")
    demand += entry("criterion", id="end", claim="c", metric="end", unit="mm", maximum=1e9)
    result = cosim.run(cosim.load(write(demand), set=["controller.fmu=s"]))
    assert result.criteria[0].value == pytest.approx(750.0 * result.metrics["end"].value)
    # also from a file, without the FMU
    result.save_trace("t.npz")
    result.save_trace("t.parquet")
    for name in ("t.npz", "t.parquet"):
        again = cosim.evaluate(cosim.load("lag.toml"), cosim.read_trace(name))
        assert again.criteria[0].value == result.criteria[0].value
    with cosim.Session(cosim.load("lag.toml", set=["controller.fmu=s"])) as session:
        (reported,) = (text for text in lint.check(session) if "conversion" in text)
    assert reported.endswith(
        "connects stride of `controller.out` to m without conversion; set `scale = 0.75`"
    )


def test_a_sweep_converts_by_the_units_of_the_fmu(write: Write, folder: Path, with_unit: WithUnit) -> None:
    with_unit("probe.fmu", "stride", 'm="1" factor="0.75"')
    demand = entry("metric", name="end", value="last(controller.out)")
    write(demand + entry("criterion", id="end", claim="c", metric="end", unit="m", maximum=1e9))
    (folder / "study.toml").write_text(grid(pole=[0.1, 0.2]))
    for _ in range(2):
        found = cosim.sweep("study.toml", plots=False)
        assert found.passed is True
    assert (folder / "study.sweep" / "results.jsonl").read_text().count('"definitions"') == 2


def test_a_wire_of_a_temperature_needs_an_offset(write: Write, folder: Path, with_unit: WithUnit) -> None:
    with_unit("t.fmu", "K", 'K="1"')
    commands = '(Channel("u", "degC"), Channel("extra"))'
    plant = f"from probe_plants import Channel, Lag\n\nclass Hot(Lag):\n    commands = {commands}\n"
    (folder / "hot.py").write_text(plant)
    loaded = cosim.load(write(), set=["controller.fmu=t", "plant.name=hot:Hot"])
    with cosim.Session(loaded) as session:
        (reported,) = (text for text in lint.check(session) if "conversion" in text)
    assert reported.endswith("to degC without conversion; set `scale = 1` and `offset = -273.15`")
    (pair,) = match([End("a.temperature", "K")], [End("temperature", "degC")])
    assert pair.conversion == (1.0, -273.15)


def test_names_of_units_in_expressions_hide_no_column() -> None:
    names: dict[str, Items | None] = {"time": None}
    assert Expression("2 * MPa", names, "`m`")(()) == 2e6
    assert Expression("2 * bar", names, "`m`").unit == "Pa"
    assert Expression("minute / hour", names, "`m`")(()) == pytest.approx(1.0 / 60.0)
    for text in ("t > 5", "T > 5", "h", "2 / min", "5 * degC"):
        with pytest.raises(ExpressionError, match="which is not a known column"):
            Expression(text, names, "`m`")
    assert {"mm", "um", "rpm", "kN", "uA", "Ohm", "J"} < set(CONSTANTS)


MICRO, MU = "plant.\N{MICRO SIGN}", "plant.\N{GREEK SMALL LETTER MU}"


@pytest.mark.parametrize("name", [MICRO, MU, "plant.\N{LATIN SMALL LIGATURE FI}", "plant.\N{SCRIPT SMALL L}"])
def test_a_column_is_found_by_its_name_although_python_normalizes_it(name: str) -> None:
    columns: dict[str, Items | None] = {"time": None, name: None}
    for text in (f"max({name})", f'max(column("{name}"))', f"max({name}[{name} > 0])"):
        assert Expression(text, columns, "`m`")(np.array([[0.0], [7.0]])) == 7.0
    metrics = (Metric("b", f"2 * {name.replace('plant', 'metric')}"), Metric(name[6:], f"max({name})"))
    assert compile_metrics(metrics, columns)[0].root.column == name


def test_two_columns_that_python_does_not_distinguish_need_their_exact_name() -> None:
    columns: dict[str, Items | None] = {"time": None, MICRO: None, MU: None}
    with pytest.raises(ExpressionError, match="which may be") as caught:
        Expression(f"max({MICRO})", columns, "`m`")
    assert caught.value.hint == f'Use `column("{MICRO}")`.'
    assert Expression(f'max(column("{MU}"))', columns, "`m`")(np.array([[0.0], [7.0], [8.0]])) == 8.0
    with pytest.raises(ExpressionError, match="differ only in characters that Python does not distinguish"):
        compile_metrics((Metric(MICRO[6:], "1"), Metric(MU[6:], "2")), columns)
