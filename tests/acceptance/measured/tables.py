"""The tables of the pages: rows of stored numbers, with the texts of `tables.toml`.

A table is on a page between two marks, which name it. A row `TABLE#ROW` belongs to another table.
A text may name a value of another row of the same table: `{row[value]}`.
"""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from .store import HERE, ROOT, Values, load

MARKED = re.compile(r"^(<!-- measured: ([\w-]+) -->\n).*?^(<!-- end -->\n)", re.DOTALL | re.MULTILINE)
"""A table on a page, with its marks."""
SECTION = re.compile(r"^## Measured$.*?(?=^## |\Z)", re.DOTALL | re.MULTILINE)
"""Measurements on a page about something else; a page about results has nothing else."""
FOLDERS = ("docs/*.md", "docs/results/*.md", "fmu-*/*.md", "fmu-*/doc/*.md", "plants/*.md", "plants/doc/*.md")
TABLES: dict[str, dict[str, Any]] = tomllib.loads((HERE / "tables.toml").read_text("utf-8"))


def pages() -> list[Path]:
    """Pages with tables of measurements."""
    found = [page for pattern in FOLDERS for page in sorted(ROOT.glob(pattern))]
    return [page for page in found if MARKED.search(page.read_text("utf-8"))]


def text(name: str) -> str:
    """Lines of a table, and the command that measures it."""
    table = TABLES[name]
    kept = {row: own(name, row) for row, _ in table["rows"]}
    lines = [f"| {table['head']} |", "|---" * (table["head"].count("|") + 1) + "|"]
    for row, words in table["rows"]:
        cells = words if "{" in words else f"{words} | {table['cells']}"
        values: dict[str, Any] = {**rows_of(name, row), **kept[row]}
        filled = cells.format(**values)
        # an event that did not happen
        lines.append(f"| {filled.replace('inf s', 'never').replace('inf N', 'a fault')} |")
    versions = sorted({str(kept[row]["code"]).split(" ")[0] for row, _ in table["rows"]})
    command = table.get("command") or f"pytest {table['tests']}"
    return "\n".join([*lines, "", f"Measured with version {', '.join(versions)} by `{command}`.", ""])


def own(name: str, row: str) -> Values:
    """Return the stored values of a row of a table, or of the one that the row names."""
    return rows_of(name, row)[row.rpartition("#")[2]]


def rows_of(name: str, row: str) -> dict[str, Values]:
    """Rows of the table to which a row belongs."""
    return load(row.rpartition("#")[0] or name)


def measurements(page: Path, content: str) -> str:
    """Part of a page that is about measurements: one section of a page of a controller, all of another."""
    if not page.relative_to(ROOT).parts[0].startswith("fmu-"):
        return content
    found = SECTION.search(content)
    return found[0] if found else ""


def renewed(page: str) -> str:
    """Page with the current tables between its marks."""
    return MARKED.sub(lambda found: f"{found[1]}\n{text(found[2])}\n{found[3]}", page)
