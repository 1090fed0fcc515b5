"""Traces made by hand, and runs that gave them."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from cosim.loop.result import Result
from cosim.metrics.criteria import Measured, Verdict
from cosim.report import charts
from cosim.report.charts import STEPS
from cosim.scenario.injection import Injection
from cosim.scenario.model import Chart, Controller, Criterion, Loop, Metric, Plot, Scenario
from cosim.trace.columns import Array, Held

ROWS = 4000


def traced(**columns: Array) -> Held:
    """Trace with a time of 1 ms a row; `_` of a name is its dot."""
    named = {"time": 1e-3 * np.arange(ROWS), **{k.replace("_", ".", 1): v for k, v in columns.items()}}
    table = np.zeros(ROWS, dtype=[(name, np.float64) for name in named])
    for name, values in named.items():
        table[name] = values
    return Held(table)


def lines(chart: Chart, trace: Held) -> dict[str, tuple[Array, Array]]:
    evaluate = charts.evaluator(chart, trace, dict.fromkeys(trace))
    return {line.name: (line.x, line.y) for line in charts.lines(chart, evaluate)}


TIME: Array = (1e-3 * np.arange(ROWS)).astype(np.float64)


def scenario(*drawn: Chart, **more: Any) -> Scenario:
    plot = Plot(charts=drawn, **more)
    return Scenario("t", Loop(1e-3, 4.0), Controller("x"), plot=plot, file=Path("t.toml"))


def result(trace: Held, value: str, **limits: Any) -> tuple[Scenario, Result]:
    """Run with one criterion in mm on a metric in m."""
    criterion = Criterion("depth", "c", "m", unit="mm", **limits)
    of = replace(scenario(), metric=(Metric("m", value, "m"),), criterion=(criterion,))
    units = dict.fromkeys(trace, "m")
    of = replace(of, inject=(Injection("plant.u", 0.5, value=0.0), Injection("plant.v", 9.0, value=0.0)))
    found = Result(
        "t", "t", 1, "native", {"m": Measured("m", 2e-3, "m")}, [Verdict(criterion, 2.0, "mm")], 4.0, 1.0,
        trace.table, units=units, items={"controller.fault": {"None": 1, "Stuck": 3}}, injected=(0.5, None),
    )  # fmt: skip
    return of, found


def unpacked(entry: dict[str, Any]) -> Array:
    """Values of packed data, as in the script of the page."""
    numbers = np.frombuffer(base64.b64decode(entry["data"]), "<u2").astype(float)
    return np.where(numbers > STEPS, np.nan, entry["low"] + entry["span"] * numbers / STEPS)


def texts(picture: str) -> list[str]:
    """Texts of a drawing for print."""
    return [
        "".join(part.itertext()).strip() for part in drawn(picture).iter("{http://www.w3.org/2000/svg}text")
    ]


def points(picture: str, color: str) -> NDArray[np.float64]:
    """Points of the longest line of a color in a drawing for print, shape (points, 2)."""
    root = drawn(picture)
    style = "".join(part.text or "" for part in root.iter("{http://www.w3.org/2000/svg}style"))
    classes = {name for name, rules in re.findall(r"\.(s\d+)\{(.*?)\}", style) if f"stroke: {color}" in rules}
    lines = [
        np.array(re.findall(r"-?[\d.]+", part.get("d", "")), dtype=float).reshape(-1, 2)
        for part in root.iter("{http://www.w3.org/2000/svg}path")
        if part.get("class") in classes
    ]
    return max(lines, key=len)


def drawn(picture: str) -> Any:
    """Root of a drawing for print."""
    return ElementTree.fromstring(unquote(picture.partition(",")[2]))
