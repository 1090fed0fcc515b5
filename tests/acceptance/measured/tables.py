"""The tables of the documents: rows of what is kept, with the words of `tables.toml`.

A table stands on a page between two marks, which name it. A row `TABLE#ROW` is one of another table.
Words may name a value of another row of the same: `{row[value]}`.
"""

from __future__ import annotations

import re
import tomllib
from typing import Any

from .store import HERE, ROOT, Values, load

MARKED = re.compile(r"(<!-- measured: ([\w-]+) -->\n).*?(<!-- end -->\n)", re.DOTALL)
"""A table on a page, and its marks."""
SECTION = re.compile(r"^## Measured$.*?(?=^## |\Z)", re.DOTALL | re.MULTILINE)
"""What the README of a controller tells of measurements; `docs/results.md` tells nothing else."""
PAGES = [ROOT / "docs/results.md", ROOT / "plants/README.md", *sorted(ROOT.glob("fmu-*/README.md"))]
TABLES: dict[str, dict[str, Any]] = tomllib.loads((HERE / "tables.toml").read_text("utf-8"))


def text(name: str) -> str:
    """Lines of a table, with what measured it."""
    table = TABLES[name]
    kept = {row: own(name, row) for row, _ in table["rows"]}
    lines = [f"| {table['head']} |", "|---" * (table["head"].count("|") + 1) + "|"]
    for row, words in table["rows"]:
        cells = words if "{" in words else f"{words} | {table['cells']}"
        values: dict[str, Any] = {**beside(name, row), **kept[row]}
        told = cells.format(**values)
        # what did not happen within any time
        lines.append(f"| {told.replace('inf s', 'never').replace('inf N', 'a fault')} |")
    codes = sorted({str(kept[row]["code"]) for row, _ in table["rows"]})
    command = table.get("command") or f"pytest {table['tests']}"
    told = f"`{command}` measures it, here with version {', '.join(codes)}."
    return "\n".join([*lines, "", told, ""])


def own(name: str, row: str) -> Values:
    """Take what is kept for a row of a table, or of the one that the row names."""
    return beside(name, row)[row.rpartition("#")[2]]


def beside(name: str, row: str) -> dict[str, Values]:
    """Rows of the table that a row is of."""
    return load(row.rpartition("#")[0] or name)


def told_of_measurements(page: str) -> str:
    """Section of a page that tells what was measured, or all of it."""
    found = SECTION.search(page)
    return found[0] if found else page


def renewed(page: str) -> str:
    """Page with the tables that its marks name."""
    return MARKED.sub(lambda found: f"{found[1]}\n{text(found[2])}\n{found[3]}", page)
