"""Nonsense in every place of a scenario: an error of ours or a run, never another exception."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim
from cosim.errors import CosimError

from .conftest import SCENARIO

Write = Callable[..., Path]

FULL = (
    SCENARIO.replace(
        'to = "plant.u"', 'to = "plant.u"\nscale = 2.0\noffset = 0.0\nnoise = 0.1\nquantum = 0.1\ndelay = 1'
    )
    + """
minimum = -1.0
maximum = 1.0

[[signal]]
to = "controller.count"
times = [0.0, 0.01]
values = [1, 2]

[[inject]]
to = "controller.in"
from_time = 0.0
to_time = 0.01
value = 1.0

[[metric]]
name = "end"
unit = "m"
value = "last(plant.x)"
description = "End"

[[criterion]]
id = "end"
claim = "ends"
paper = "ends"
metric = "end"
unit = "m"
minimum = 0.0
maximum = 1.0

[plot]
zoom = "controller.flag"
before = 0.1
after = 0.1

[[plot.panels]]
title = "x"
columns = ["plant.x"]
unit = "m"
scale = 1.0
"""
)
LINES = [number for number, line in enumerate(FULL.splitlines()) if " = " in line]
NONSENSE = [
    "-1", "5", "1e300", "9" * 30, "nan", "-inf", '"x"', '""', "true", "[]", "[1]", "[[1]]",
    '["a"]', "{}", "{a = 1}",
]  # fmt: skip


@pytest.mark.parametrize("number", LINES)
def test_nonsense_as_a_value(write: Write, number: int) -> None:
    lines = FULL.splitlines()
    for nonsense in NONSENSE:
        changed = [*lines[:number], re.sub(r" = .*", f" = {nonsense}", lines[number]), *lines[number + 1 :]]
        refused_or_run(write(text="\n".join(changed)))


@pytest.mark.parametrize("number", LINES)
def test_a_line_is_missing(write: Write, number: int) -> None:
    lines = FULL.splitlines()
    refused_or_run(write(text="\n".join(lines[:number] + lines[number + 1 :])))


HEADERS = [
    "loop", "controller", "plant", "wire", "signal", "inject", "metric", "criterion", "plot",
    "drop", "extends",
]  # fmt: skip


@pytest.mark.parametrize("header", HEADERS)
def test_nonsense_in_a_variant(write: Write, header: str) -> None:
    write(text=FULL)
    for nonsense in [*NONSENSE, "[{}]", "[{to = [1]}]", "[{name = {}}]", "{parameters = 1}"]:
        for before in ("", 'drop = ["metric", "criterion.end"]\n' if header != "drop" else ""):
            text = f'extends = "lag.toml"\n{before}{header} = {nonsense}\n'
            refused_or_run(write(name="variant.toml", text=text))


def refused_or_run(file: Path) -> None:
    """Load and run; only errors that are meant for users may come out."""
    with contextlib.suppress(CosimError):
        cosim.run(cosim.load(file))
