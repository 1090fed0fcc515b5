"""Merged TOML tables of a scenario: the file it extends, the file itself, the overrides of a run."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NoReturn

from cosim import paths
from cosim.errors import ScenarioError, closest, show
from cosim.scenario.assignment import Assignment
from cosim.scenario.kinds import check_kind
from cosim.scenario.tables import IDENTITY, dotted, item_key, join
from cosim.scenario.toml import check_sizes, parse_file, toml_value

SET = "--set"
KeyPath = list[str | int]
"""Path to a value: names of tables and indices of arrays."""
RENAMED = {"idle": "undriven"}
"""Keys of version 0.1 and their replacements."""


@dataclass
class Overrides:
    """Merged tables, and for every key the file or override that set it (for messages)."""

    table: dict[str, Any] = field(default_factory=dict)
    origins: dict[str, str] = field(default_factory=dict)
    files: list[Path] = field(default_factory=list)

    def fail(self, key: str, problem: str, hint: str = "") -> NoReturn:
        """Raise an error that names the origin and the key."""
        raise ScenarioError(f"{self.origin(key)}: `{key}` {problem}", hint)

    def origin(self, key: str) -> str:
        """File or override that set `key`."""
        return find_origin(self.origins, key) or f"`{paths.shown(self.files[-1])}`"

    def apply(self, table: dict[str, Any], origin: str) -> None:
        """Merge `table` into the existing tables; items of arrays of tables merge by identity."""
        dropped = table.pop("drop", [])
        if not isinstance(dropped, list) or not all(isinstance(entry, str) for entry in dropped):
            raise ScenarioError(f"{origin}: `drop` is {show(dropped)}, it must be an array of texts")
        if dropped and not self.table:
            hint = "Use `drop` only to omit inherited items."
            raise ScenarioError(f"{origin}: `drop` needs `extends`", hint)
        for entry in dropped:
            drop(self.table, entry, origin)
        self.table = merge(self.table, table)
        self.origins |= dict.fromkeys(walk(table), origin)

    def put(self, path: KeyPath, value: Any, origin: str) -> None:
        """Set the value at a path; shared tables are copied first."""
        self.table = replaced(self.table, path, value)
        self.origins[dotted(path, self.table)] = origin

    def copy(self) -> Overrides:
        """Copy that can be changed independently."""
        return Overrides(self.table, dict(self.origins), self.files)


def find_origin(origins: dict[str, str], key: str) -> str:
    """Origin of `key`, or of the nearest table around it; empty if there is none."""
    while key:
        if key in origins:
            return origins[key]
        key = re.sub(r"(^|\.|\[)[^.\[]*$", "", key)
    return ""


def read(path: Path) -> Overrides:
    """Read a scenario file and, first, the file it extends."""
    merged = Overrides()
    chain = [(path.resolve(), parse_scenario(path))]
    while (parent := chain[-1][1].pop("extends", None)) is not None:
        origin = f"`{paths.shown(chain[-1][0])}`"
        if not isinstance(parent, str):
            raise ScenarioError(f"{origin}: `extends` is {show(parent)}, it must be a text")
        file = paths.find_scenario(parent, near=chain[-1][0].parent).resolve()
        if file in (visited for visited, _ in chain):
            raise ScenarioError(f"{origin}: `extends` = `{parent}` leads back to `{paths.shown(file)}`")
        chain.append((file, parse_scenario(file)))
    for file, table in reversed(chain):
        merged.files.append(file)
        merged.apply(table, f"`{paths.shown(file)}`")
    return merged


def parse_scenario(file: Path) -> dict[str, Any]:
    """Parse one file of a scenario; reject studies."""
    table = parse_file(file)
    check_kind(table, file, "scenario")
    for key in table.keys() & RENAMED.keys():
        raise ScenarioError(f"`{paths.shown(file)}`: `{key}` was renamed", f"Use `{RENAMED[key]}`.")
    return table


def replaced(table: Any, path: KeyPath, value: Any) -> Any:
    """Copy of a table with one changed value; copies only the tables on its path."""
    if not path:
        return value
    name, *rest = path
    if isinstance(name, int):
        return [*table[:name], replaced(table[name], rest, value), *table[name + 1 :]]
    around = table if isinstance(table, dict) else {}
    return {**around, name: replaced(around.get(name), rest, value)}


def merge(base: dict[str, Any], over: dict[str, Any]) -> dict[str, Any]:
    """Merge two tables into a new one; arrays of tables merge by identity, other values are replaced."""
    merged = dict(base)
    for name, value in over.items():
        old = merged.get(name)
        if isinstance(old, dict) and isinstance(value, dict):
            merged[name] = merge(old, value)
        elif name in IDENTITY and is_tables(old) and is_tables(value):
            merged[name] = merge_items(name, list(old or ()), value)
        else:
            merged[name] = value
    return merged


def merge_items(name: str, base: list[Any], over: list[Any]) -> list[Any]:
    """Replace items of the same identity in place (all of them), append the others."""
    identity = IDENTITY[name]
    replaced = {str(item.get(identity)) for item in over}
    merged: list[Any] = []
    placed: set[str] = set()
    for item in base:
        key = str(item.get(identity))
        if key not in replaced:
            merged.append(item)
        elif key not in placed:
            merged += [new for new in over if str(new.get(identity)) == key]
            placed.add(key)
    return merged + [item for item in over if str(item.get(identity)) not in placed]


def is_tables(value: Any) -> bool:
    """Whether the value is an array of tables."""
    return isinstance(value, list) and all(isinstance(item, dict) for item in value)


def identities(name: str, items: list[dict[str, Any]]) -> list[Any]:
    """List the identifying values of the tables of an array."""
    return [item.get(IDENTITY[name]) for item in items]


def walk(table: dict[str, Any], prefix: str = "") -> list[str]:
    """Every dotted key in a table, tables and array items included."""
    keys: list[str] = []
    for name, value in table.items():
        key = join(prefix, name)
        keys.append(key)
        if isinstance(value, dict):
            keys += walk(value, key)
        elif is_tables(value):
            for index, item in enumerate(value):
                inner = item_key(key, index, item)
                keys += [inner, *walk(item, inner)]
    return keys


def drop(table: dict[str, Any], entry: str, origin: str) -> None:
    """Remove what was inherited: `criterion` (all of them) or `criterion.<id>`."""
    name, _, wanted = entry.partition(".")
    if name not in IDENTITY:
        problem = f"{origin}: `drop` holds `{entry}`, which does not start with a known name"
        raise ScenarioError(problem, closest(name, IDENTITY))
    items = table.get(name, [])
    if not wanted or not is_tables(items):
        table.pop(name, None)
        return
    kept = [item for item in items if item.get(IDENTITY[name]) != wanted]
    if len(kept) == len(items):
        problem = f"{origin}: `drop` holds `{entry}`, which is not inherited"
        raise ScenarioError(problem, closest(entry, [f"{name}.{one}" for one in identities(name, items)]))
    table[name] = kept


def override(merged: Overrides, assignments: Sequence[str | Assignment]) -> None:
    """Apply overrides `KEY=VALUE`, and those of options.

    `controller.<fmi name>` and `plant.<parameter>` set parameters (`controller.fmu` and `plant.name`
    the FMU and the plant). With several FMUs the name of the FMU replaces `controller`. `loop.<key>`, `title`
    and `description` set these keys. `wire.<to>.<key>`, `signal.<to>.<key>`, `inject.<to>.<key>`,
    `metric.<name>.<key>` and `criterion.<id>.<key>` change one item. Values are TOML; invalid TOML is a
    text.
    """
    for assignment in assignments:
        if isinstance(assignment, str):
            key, equals, text = map(str.strip, assignment.partition("="))
            if not equals or not key:
                problem = f"`{SET} {assignment}` is not of the form KEY=VALUE"
                raise ScenarioError(problem, "Use, for example, `--set loop.duration=1.0`.")
            option, value = f"{SET} {key}", text
        else:
            option, key, value = assignment
        try:
            if isinstance(assignment, str):
                value = toml_value(value, key)
            check_sizes(value, key=key)
        except ScenarioError as error:
            raise ScenarioError(f"`{option}`: {error.message}", error.hint) from None
        assign(merged, key, value, f"`{option}`")


def assign(merged: Overrides, key: str, value: Any, origin: str) -> None:
    """Set one dotted key of the merged tables; `origin` names its source in messages."""
    merged.put(key_path(merged, key, origin), value, origin)


def key_path(merged: Overrides, key: str, origin: str) -> KeyPath:
    """Path in the merged tables for a dotted key."""
    tables = parameterized(merged.table)
    section, _, name = key.partition(".")
    if section in tables and name:
        path, own = tables[section]
        return [*path, name] if name in own else [*path, "parameters", name.removeprefix("parameters.")]
    items = [root for root in IDENTITY if root != "fmu"]
    if key in ("title", "description"):
        return [key]
    roots = (*tables, "loop", *items)
    if section not in roots:
        where = origin if key in origin else f"{origin}: `{key}`"
        hint = closest(key, [*(f"{root}." for root in roots), "title", "description"])
        raise ScenarioError(f"{where}: not a key of a scenario", hint)
    if not name.strip("."):
        entries = merged.table.get(section, [])
        names = identities(section, entries) if section in items and is_tables(entries) else []
        known = closest("", [f"{section}.{name}" for name in names])
        raise ScenarioError(f"{origin}: there is no name after `{section}.`", known)
    return [section, name] if section == "loop" else item_path(merged, section, name, origin)


def parameterized(table: dict[str, Any]) -> dict[str, tuple[KeyPath, tuple[str, ...]]]:
    """Paths of the tables with parameters, by their names in keys, and their other keys."""
    found: dict[str, tuple[KeyPath, tuple[str, ...]]] = {"controller": (["controller"], ("fmu",))}
    if is_tables(table.get("fmu")):
        names = enumerate(str(name) for name in identities("fmu", table["fmu"]))
        found = {name: (["fmu", index], ("fmu", "step")) for index, name in names}
    return {**found, "plant": (["plant"], ("name",))}


def item_path(merged: Overrides, section: str, name: str, origin: str) -> KeyPath:
    """Path of a key in an item of an array of tables; `name` is `<identity>.<key>`."""
    items = merged.table.get(section, [])
    if not is_tables(items):
        merged.fail(section, f"is {show(items)}, it must be an array of tables")
    identity, _, inner = name.rpartition(".")
    names = identities(section, items)
    if identity not in names:
        known = closest(f"{section}.{identity or name}", [f"{section}.{one}" for one in names])
        raise ScenarioError(f"{origin}: the scenario has no {section} `{identity or name}`", known)
    if (count := names.count(identity)) > 1:
        problem = f"{origin}: the scenario has {count} tables `{section}` for `{identity}`"
        raise ScenarioError(problem, "Change the file; an override changes only one.")
    return [section, names.index(identity), inner]


def title_of(file: Path) -> str:
    """Title of a scenario file, otherwise of the file it extends; empty if none has one."""
    visited: set[Path] = set()
    while file not in visited:
        visited.add(file)
        table = parse_file(file)
        parent = table.get("extends")
        if "title" in table or not isinstance(parent, str):
            return str(table.get("title", ""))
        file = paths.find_scenario(parent, near=file.parent).resolve()
    return ""
