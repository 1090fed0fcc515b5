"""Pages that are made of the program itself: commands, files, Python."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable, Iterator
from typing import Any

import cosim
from cosim.optimize.problem import problem_schema
from cosim.scenario.model import scenario_schema
from cosim.scenario.tables import toml_text
from cosim.sweep.study import study_schema

Schema = dict[str, Any]


def commands() -> str:
    """Page of the commands, as Typer tells them."""
    line = ["-m", "typer", "cosim.cli.app", "utils", "docs", "--name", "cosim", "--title", "Commands"]
    done = subprocess.run([sys.executable, *line], capture_output=True, text=True, check=True)
    # the commands stand in the table of contents; `$ ` would be copied with a line
    return done.stdout.replace("```console\n$ ", "```text\n")


def python() -> str:
    """Page of all public names; mkdocstrings puts in what their documentation says."""
    parts = ["# Python", "`import cosim` is cheap: what a name needs is imported when it is first used."]
    for name in cosim.__all__:
        place = cosim.LOCATIONS.get(name, f"cosim.{name}.results.{name}")
        parts.append(f'::: {place}\n    options:\n      heading: "cosim.{name}"\n      toc_label: "{name}"')
    return "\n\n".join(parts) + "\n"


def keys(schema: Schema, prefix: str = "") -> Iterator[tuple[str, Schema, bool]]:
    """Tables of a file by name, each with its schema and whether there may be many of it."""
    for name, part in schema.get("properties", {}).items():
        many = part.get("type") == "array"
        inner = part["items"] if many else part
        if "properties" in inner:
            yield prefix + name, inner | {"description": part.get("description", "")}, many
            yield from keys(inner, f"{prefix}{name}.")


def file(title: str, schema: Schema, kind: str) -> str:
    """Page of one kind of file: its tables, and their keys."""
    about = f"{schema['description']} `cosim schema {kind}` prints this as a JSON schema, for editors."
    parts = [f"# {title}", f"{about} A key that is no table stands at the top of the file.", table(schema)]
    for name, inner, many in keys(schema):
        parts += [f"## `{f'[[{name}]]' if many else f'[{name}]'}`", inner["description"], table(inner)]
    return "\n\n".join(part for part in parts if part) + "\n"


def table(schema: Schema) -> str:
    """Keys of one table that are no tables themselves."""
    required = schema.get("required", [])
    rows = [
        f"| `{name}` | {kind(part)} | {default(part, name in required)} | {part.get('description', '')} |"
        for name, part in schema["properties"].items()
        if "properties" not in part and "properties" not in part.get("items", {})
    ]
    return "\n".join(["| Key | Values | If left out | Meaning |", "|---|---|---|---|", *rows]) if rows else ""


def kind(part: Schema) -> str:
    """Values that a key takes."""
    if "enum" in part:
        return ", ".join(f"`{value}`" for value in part["enum"] if value != "")
    if choices := part.get("anyOf") or part.get("oneOf"):
        return " or ".join(kind(choice) for choice in choices)
    types = part.get("type", "any value")
    text = " or ".join(types) if isinstance(types, list) else str(types)
    if types == "array":
        text = f"array of {kind(part['items'])}"
    bounds = {"exclusiveMinimum": ">", "minimum": ">=", "exclusiveMaximum": "<", "maximum": "<="}
    return " ".join([text, *(f"{sign} {part[key]:g}" for key, sign in bounds.items() if key in part)])


def default(part: Schema, required: bool) -> str:
    """Value of a key that is left out."""
    if required:
        return "required"
    if "default" not in part:
        return ""
    text = toml_text(part["default"])
    return f"`{text}`" if text != "''" else ""


PAGES: dict[str, Callable[[], str]] = {
    "reference/commands.md": commands,
    "reference/scenario.md": lambda: file("Scenario files", scenario_schema(), "scenario"),
    "reference/study.md": lambda: file("Study files", study_schema(), "study"),
    "reference/optimization.md": lambda: file("Optimization files", problem_schema(), "optimization"),
    "reference/python.md": python,
}
"""What makes each page."""
