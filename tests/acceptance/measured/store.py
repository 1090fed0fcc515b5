"""What tests measured for the tables of the documents: a file for each table, a value for each row."""

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
"""What the numbers depend on."""
NEAR = 0.1
"""Relative difference of two numbers that are the same: other processors and libraries round otherwise."""

Values = Mapping[str, float | str]


def load(table: str) -> dict[str, Values]:
    """Values of the rows of a table by their names, each with the `code` that they were measured with."""
    rows: dict[str, Values] = json.loads((FOLDER / f"{table}.json").read_text("utf-8"))
    return rows


def measured(table: str, row: str, **values: float) -> None:
    """Hold what was measured against what is kept for a row; with `BLESS` in the environment keep it instead.

    Raises
    ------
    AssertionError
        Something else is kept.
    """
    file = FOLDER / f"{table}.json"
    rows = load(table) if file.is_file() else {}
    if "BLESS" in os.environ:
        rows[row] = {"code": code(), **{name: float(f"{value:.6g}") for name, value in values.items()}}
        file.write_text(json.dumps(rows, indent=1, sort_keys=True) + "\n", "utf-8")
        return
    kept = {name: value for name, value in rows.get(row, {}).items() if name != "code"}
    assert kept.keys() == values.keys(), f"{table}, {row}: {[*kept]} are kept, not {[*values]}"
    other = [
        f"{name} {kept[name]} is now {value:.6g}"
        for name, value in values.items()
        if not near(kept[name], value)
    ]
    assert other == [], f"{table}, {row}: {', '.join(other)}\nhint: `BLESS=1` keeps what is measured"


def near(kept: float | str, value: float) -> bool:
    """Whether two numbers are the same, or counts that differ by one."""
    if isinstance(kept, str):
        return False
    counts = kept.is_integer() and float(value).is_integer()
    return math.isclose(kept, value, rel_tol=NEAR, abs_tol=1.0 if counts else 0.0)


def code() -> str:
    """Version of the project and day of the last change of what the numbers depend on."""
    version = tomllib.loads((ROOT / "Cargo.toml").read_text("utf-8"))["workspace"]["package"]["version"]
    told, changed = git("log", "-1", "--format=%cs"), git("status", "--porcelain")
    return f"{version} of {told}" + (" with changes" if changed else "")


def git(*words: str) -> str:
    """Answer of git about what the numbers depend on."""
    line = ["git", *words, "--", *CODE]
    return subprocess.run(line, cwd=ROOT, capture_output=True, text=True, check=True).stdout.strip()
