"""CHANGELOG lists the names that version 0.2.0 replaced, as the FMUs do in `resources/renamed.toml`."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
CHANGELOG = ROOT / "CHANGELOG.md"
BEGIN, END = "<!-- renamed: generated -->\n", "<!-- end of renamed -->"


def rows(file: Path) -> Iterator[str]:
    """Rows of the table of one controller: variables, then items of enumerations."""
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    fmu = file.parents[1].name
    for old, new in content.get("variables", {}).items():
        yield f"| {fmu} | `{old}` | {f'`{new}`' if new else 'removed'} |"
    for kind, items in content.get("items", {}).items():
        for old, new in items.items():
            yield f"| {fmu} | `{kind}::{old}` | {f'`{kind}::{new}`' if new else 'removed'} |"


def table() -> str:
    """Table of all controllers."""
    files = sorted(ROOT.glob("fmu-*/resources/renamed.toml"))
    lines = [row for file in files for row in rows(file)]
    return "\n".join(("", "| FMU | old | new |", "|---|---|---|", *lines, ""))


def test_the_changelog_lists_all_replaced_names() -> None:
    head, begin, rest = CHANGELOG.read_text(encoding="utf-8").partition(BEGIN)
    _, end, tail = rest.partition(END)
    assert begin
    assert end
    wanted = f"{head}{BEGIN}{table()}\n{END}{tail}"
    if os.environ.get("BLESS"):
        CHANGELOG.write_text(wanted, encoding="utf-8")
    assert CHANGELOG.read_text(encoding="utf-8") == wanted, (
        "hint: `BLESS=1 pytest tests/house` renews the table"
    )
