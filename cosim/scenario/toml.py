"""TOML of files and overrides: parsing, and rejection of meaningless content."""

from __future__ import annotations

import re
import tomllib
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.errors import ScenarioError, show
from cosim.scenario.tables import join

MAX_NESTED = 32
"""Maximum nesting of tables and arrays; our files have at most five levels."""
POINT = re.compile(r"[+-]?(\d+\.|\.\d+)([eE][+-]?\d+)?")
"""Numbers that start or end with a decimal point, which TOML does not know."""
TOO_DEEP = f"tables and arrays are nested more than {MAX_NESTED} deep"


def parse_file(path: Path) -> dict[str, Any]:
    """Parse one TOML file; nested parameter tables become dotted names."""
    try:
        # Windows editors start a file with a byte order mark
        table = parse_text(path.read_text(encoding="utf-8-sig"))
        check_sizes(table)
    except OSError as error:
        raise ScenarioError(f"cannot read `{path}`: {error.strerror}") from None
    except UnicodeDecodeError as error:
        raise ScenarioError(f"`{paths.shown(path)}` is not a text file in UTF-8: {error.reason}") from None
    except tomllib.TOMLDecodeError as error:
        hint = "Put texts in quotes; write digits before and after the decimal point: `step = 1e-4`."
        raise ScenarioError(f"`{paths.shown(path)}` is not valid TOML: {error}", hint) from None
    except ScenarioError as error:
        raise ScenarioError(f"`{paths.shown(path)}`: {error.message}", error.hint) from None
    fmus = table.get("fmu")
    for section in (table.get("controller"), table.get("plant"), *(fmus if isinstance(fmus, list) else ())):
        if isinstance(section, dict) and isinstance(section.get("parameters"), dict):
            section["parameters"] = flatten(section["parameters"])
            check_arrays(section["parameters"], path)
    return table


def check_arrays(parameters: dict[str, Any], path: Path) -> None:
    """Check that parameters do not give both an array and an item of it."""
    for name in parameters:
        whole = name.partition("[")[0]
        if whole != name and isinstance(parameters.get(whole), list):
            problem = f"the parameters `{whole}` and `{name}` contradict each other"
            raise ScenarioError(f"`{paths.shown(path)}`: {problem}", "Give the array or its items.")


def parse_text(text: str) -> dict[str, Any]:
    """Parse TOML; reject what only Python cannot read."""
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        raise
    except RecursionError:
        raise ScenarioError(TOO_DEEP) from None
    except ValueError as error:  # a number of thousands of digits
        raise ScenarioError(f"cannot be read: {error}") from None


def check_sizes(value: Any, level: int = 0, key: str = "") -> None:
    """Check the nesting depth and that integers have 64 bits, as TOML requires; `key` is for messages."""
    if level > MAX_NESTED:
        raise ScenarioError(TOO_DEEP)
    if isinstance(value, dict):
        for name, item in value.items():
            check_sizes(item, level + 1, join(key, name))
    elif isinstance(value, list):
        for index, item in enumerate(value):
            check_sizes(item, level + 1, f"{key}[{index}]")
    elif isinstance(value, int) and not -(2**63) <= value < 2**63:
        problem = f"`{key}` is {show(value)}, but integers have 64 bits"
        raise ScenarioError(problem, "Use a float, for example `1e20`.")


def flatten(table: dict[str, Any], prefix: str = "") -> dict[str, Any]:
    """Nested tables to dotted names: `{"a": {"b": 1}}` to `{"a.b": 1}`."""
    flat: dict[str, Any] = {}
    for name, value in table.items():
        key = join(prefix, name)
        flat |= flatten(value, key) if isinstance(value, dict) else {key: value}
    return flat


def toml_value(text: str, key: str) -> Any:
    """TOML value of a text, or the text itself if it is not TOML; `key` is its key."""
    try:
        parsed = parse_text(f"value = {text}")
    except tomllib.TOMLDecodeError:
        return float(text) if POINT.fullmatch(text) else text
    for value in parsed.values():
        check_sizes(value, key=key)
    return parsed["value"] if set(parsed) == {"value"} else text
