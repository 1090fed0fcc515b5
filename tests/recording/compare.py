"""Differences between a recording and a run, with a map of new names and intended changes.

The new names of the controllers come from `fmu-*/resources/renamed.toml`, all others from `renamed.toml`.
"""

from __future__ import annotations

import tomllib
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Any, Literal

from .record import Recorded, fits

FILE = Path(__file__).with_name("renamed.toml")
ROOT = Path(__file__).resolve().parents[2]
CONTROLLER = "controller."
"""Name of the FMU of a controller in the scenarios of its loop."""
STATE = "end state"

Kind = Literal["changed", "missing", "new", "intended"]


@dataclass(frozen=True)
class Difference:
    """A column that differs from the recording.

    Parameters
    ----------
    column
        Column under its current name, or `end state`.
    kind
        `changed` and `missing` are errors; `new` and `intended` (an exception of the map) are only reported.
    note
        Remark, or empty.
    """

    scenario: str
    column: str
    kind: Kind
    note: str = ""

    @property
    def fault(self) -> bool:
        """Whether it is an error."""
        return self.kind in ("changed", "missing")


@dataclass(frozen=True)
class Renamed:
    """Current name of a column, empty if it was removed, and new names of items of an enumeration."""

    column: str
    items: dict[str, str] = field(default_factory=dict)

    def text(self, recorded: str) -> str:
        """Return a recorded hash with the current names of the items."""
        values, colon, names = recorded.partition(":")
        return values + colon + ",".join(self.items.get(name, name) for name in names.split(","))


@dataclass(frozen=True)
class Intended:
    """Columns (patterns of current names) of scenarios (a pattern) with an intended change."""

    scenarios: str
    columns: list[str]
    reason: str

    def covers(self, scenario: str, column: str) -> bool:
        """Whether it applies to this column."""
        return fits(scenario, self.scenarios) and any(fnmatchcase(column, p) for p in self.columns)


@dataclass(frozen=True)
class Controller:
    """New names of the columns of a controller, empty for a removed one, and of all items of enumerations."""

    columns: dict[str, str] = field(default_factory=dict)
    items: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Changes:
    """The map: renamed columns by scenario pattern and recorded name, exceptions, names of controllers."""

    renamed: dict[str, dict[str, Renamed]] = field(default_factory=dict)
    exceptions: list[Intended] = field(default_factory=list)
    controllers: dict[str, Controller] = field(default_factory=dict)

    def of(self, scenario: str) -> dict[str, Renamed]:
        """Find the renamed columns of a scenario."""
        tables = [table for pattern, table in self.renamed.items() if fits(scenario, pattern)]
        return {old: new for table in tables for old, new in table.items()}

    def current(self, scenario: str, column: str) -> Renamed:
        """Return the current name of a recorded column, with the new names of the items of its FMU."""
        found = self.of(scenario).get(column)
        controller = self.controllers.get(scenario.partition("/")[0])
        if controller is None or not column.startswith(CONTROLLER):
            return found or Renamed(column)
        known = found or Renamed(controller.columns.get(column, column))
        return Renamed(known.column, {**controller.items, **known.items})

    def reason(self, scenario: str, column: str) -> str:
        """Return the reason of an intended change, empty if there is none."""
        return next((e.reason for e in self.exceptions if e.covers(scenario, column)), "")


def read(file: Path = FILE) -> Changes:
    """Read the map from its TOML file."""
    content = tomllib.loads(file.read_text(encoding="utf-8"))
    exceptions = [Intended(**entry) for entry in content.pop("exception", [])]
    tables = {
        pattern: {old: renamed(old, new) for old, new in table.items()} for pattern, table in content.items()
    }
    return Changes(tables, exceptions, controllers())


def controllers() -> dict[str, Controller]:
    """Read the new names of each controller."""
    found = {}
    for file in sorted(ROOT.glob("fmu-*/resources/renamed.toml")):
        content = tomllib.loads(file.read_text("utf-8"))
        columns = {
            f"{CONTROLLER}{old}": f"{CONTROLLER}{new}" if new else ""
            for old, new in content.get("variables", {}).items()
        }
        tables = content.get("items", {}).values()
        items = {old: new for table in tables for old, new in table.items() if new}
        found[file.parents[1].name.removeprefix("fmu-")] = Controller(columns, items)
    return found


def renamed(old: str, new: str | dict[str, Any]) -> Renamed:
    """Read one entry of the map: the current name, or a table with `items` and optionally `column`."""
    return Renamed(new) if isinstance(new, str) else Renamed(**{"column": old, **new})


def compare(scenario: str, recorded: Recorded, now: Recorded, changes: Changes) -> list[Difference]:
    """List the differences; under the map, names and order may change, values may not."""
    expected = [
        (name.column, name.text(value))
        for old, value in recorded.columns.items()
        if (name := changes.current(scenario, old)).column
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
