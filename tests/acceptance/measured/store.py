"""Measured numbers for the tables of the pages: a file for each table, an entry for each row."""

from __future__ import annotations

import json
import math
import os
import subprocess
import tomllib
from collections.abc import Mapping
from pathlib import Path

ROOT = Path(__file__).resolve().parents[3]
HERE = Path(__file__).parent
FOLDER = HERE / "numbers"
CODE = ("control-blocks", "cosim", "fmi2-export", "fmu-*/src", "plants", "scenarios", ":(exclude)*.md")
"""Files on which the numbers depend."""
NEAR = 0.1
"""Relative tolerance: other processors and libraries round differently."""

Values = Mapping[str, float | str]


def load(table: str) -> dict[str, Values]:
    """Values of the rows of a table by their names, each with the `code` that they were measured with."""
    rows: dict[str, Values] = json.loads((FOLDER / f"{table}.json").read_text("utf-8"))
    return rows


def measured(table: str, row: str, **values: float) -> None:
    """Compare measured values with the stored ones of a row; with `BLESS` in the environment, store them.

    Raises
    ------
    AssertionError
        The stored values differ.
    """
    file = FOLDER / f"{table}.json"
    rows = load(table) if file.is_file() else {}
    if "BLESS" in os.environ:
        rows[row] = {"code": code(), **{name: float(f"{value:.6g}") for name, value in values.items()}}
        file.write_text(json.dumps(rows, indent=1, sort_keys=True) + "\n", "utf-8")
        return
    kept = {name: value for name, value in rows.get(row, {}).items() if name != "code"}
    assert kept.keys() == values.keys(), f"{table}, {row}: {[*kept]} are stored, not {[*values]}"
    other = [
        f"{name} {kept[name]} is now {value:.6g}"
        for name, value in values.items()
        if not near(kept[name], value)
    ]
    assert other == [], f"{table}, {row}: {', '.join(other)}\nhint: `BLESS=1` stores the measured values"


def near(kept: float | str, value: float) -> bool:
    """Whether two numbers agree within the tolerance, or two counts within one."""
    if isinstance(kept, str):
        return False
    counts = kept.is_integer() and float(value).is_integer()
    return math.isclose(kept, value, rel_tol=NEAR, abs_tol=1.0 if counts else 0.0)


def code() -> str:
    """Version of the project and date of the last change of the files on which the numbers depend."""
    version = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["version"]
    date, changed = git("log", "-1", "--format=%cs"), git("status", "--porcelain")
    return f"{version} of {date}" + (" with changes" if changed else "")


def git(*words: str) -> str:
    """Output of git about the files on which the numbers depend."""
    line = ["git", *words, "--", *CODE]
    return subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
