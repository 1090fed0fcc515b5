"""What differs between a recording and a run, under a map of what was renamed and what changes on purpose."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Literal

from .record import Recorded, fits

FILE = Path(__file__).with_name("renamed.toml")
STATE = "end state"

Kind = Literal["changed", "missing", "new", "intended"]


@dataclass(frozen=True)
class Difference:
    """A column that is not what was recorded.

    Parameters
    ----------
    column
        Column under its name of today, or `end state`.
    kind
        `changed` and `missing` are errors; `new` and `intended` (an exception of the map) are only reported.
    note
        What may help to understand it, or empty.
    """

    scenario: str
    column: str
    kind: Kind
    note: str = ""

    @property
    def fault(self) -> bool:
        """Whether it must not be."""
        return self.kind in ("changed", "missing")


@dataclass(frozen=True)
class Renamed:
    """Name of a column today, and of the items of an enumeration that are called otherwise."""

    column: str
    items: dict[str, str] = field(default_factory=dict)

    def text(self, recorded: str) -> str:
        """Return a recorded hash with the names of the items of today."""
        values, colon, names = recorded.partition(":")
        return values + colon + ",".join(self.items.get(name, name) for name in names.split(","))


@dataclass(frozen=True)
class Intended:
    """Columns (patterns, names of today) of scenarios (a pattern) that change on purpose, and why."""

    scenarios: str
    columns: list[str]
    reason: str

    def covers(self, scenario: str, column: str) -> bool:
        """Whether it is about this column."""
        return fits(scenario, self.scenarios) and any(fnmatchcase(column, p) for p in self.columns)


@dataclass(frozen=True)
class Changes:
    """The map: renamed columns by scenario pattern and recorded name, and the exceptions."""

    renamed: dict[str, dict[str, Renamed]] = field(default_factory=dict)
    exceptions: list[Intended] = field(default_factory=list)

    def of(self, scenario: str) -> dict[str, Renamed]:
        """Find the renamed columns of a scenario."""
        tables = [table for pattern, table in self.renamed.items() if fits(scenario, pattern)]
        return {old: new for table in tables for old, new in table.items()}

    def reason(self, scenario: str, column: str) -> str:
        """Return why a column differs on purpose, empty where it must not."""
        return next((e.reason for e in self.exceptions if e.covers(scenario, column)), "")


def read(file: Path = FILE) -> Changes:
    """Read the map from its TOML file."""
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    exceptions = [Intended(**entry) for entry in content.pop("exception", [])]
    tables = {
        pattern: {old: renamed(old, new) for old, new in table.items()} for pattern, table in content.items()
    }
    return Changes(tables, exceptions)


def renamed(old: str, new: str | dict[str, Any]) -> Renamed:
    """Read one entry of the map: the name of today, or a table with `items` and perhaps `column`."""
    return Renamed(new) if isinstance(new, str) else Renamed(**{"column": old, **new})


def compare(scenario: str, recorded: Recorded, now: Recorded, changes: Changes) -> list[Difference]:
    """List what differs; under the map, names and order may, values may not."""
    names = changes.of(scenario)
    expected = [
        (new.column, new.text(value))
        for old, value in recorded.columns.items()
        for new in [names.get(old, Renamed(old))]
    ]
    new = {c: value for c, value in now.columns.items() if c not in {column for column, _ in expected}}
    found = [
        differing(scenario, column, value, now.columns.get(column), new)
        for column, value in expected
        if now.columns.get(column) != value
    ]
    if recorded.state != now.state:
        found.append(Difference(scenario, STATE, "changed"))
    return [excused(one, changes) for one in found] + [Difference(scenario, c, "new") for c in new]


def differing(scenario: str, column: str, value: str, now: str | None, new: dict[str, str]) -> Difference:
    """Describe a missing or changed column with a possible reason."""
    if now is None:
        same = [name for name, hashed in new.items() if hashed == value]
        return Difference(
            scenario, column, "missing", f"`{same[0]}` has its values" if len(same) == 1 else ""
        )
    # the same order of items under other names
    items = value.partition(":")[0] == now.partition(":")[0]
    return Difference(scenario, column, "changed", f"only in names, {value} -> {now}" if items else "")


def excused(found: Difference, changes: Changes) -> Difference:
    """Return the difference, as an intended one if the map knows a reason."""
    reason = changes.reason(found.scenario, found.column)
    return Difference(found.scenario, found.column, "intended", reason) if reason else found
