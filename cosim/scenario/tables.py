"""TOML tables to dataclasses: unknown keys and wrong types are errors that name the key."""

from __future__ import annotations

import dataclasses
import functools
import types
import typing
from collections.abc import Callable
from typing import Any, Literal, NoReturn, TypeVar

from cosim.errors import closest, similar

T = TypeVar("T")
Fail = Callable[[str, str, str], NoReturn]
"""Raises the caller's error from (key, problem, hint)."""


def parse(kind: type[T], table: dict[str, Any], key: str, fail: Fail) -> T:
    """Build the dataclass `kind` from a TOML table.

    Parameters
    ----------
    kind
        Dataclass; a field may carry `metadata={"key": ...}` where the TOML key is another, or "" for none.
    table
        The TOML table.
    key
        Dotted key of the table, for messages; empty at the root.
    fail
        Called with key, problem and hint at the first error.
    """
    hints, fields = annotated(typing.cast("typing.Hashable", kind))
    for name in table:
        if name not in fields:
            fail(join(key, name), "is not a known key", closest(name, fields))

    values: dict[str, Any] = {}
    for name, field in fields.items():
        if name in table:
            values[field.name] = convert(hints[field.name], table[name], join(key, name), fail)
        elif is_required(field):
            fail(join(key, name), "is missing", "")
    return kind(**values)


@functools.lru_cache(64)
def annotated(kind: Any) -> tuple[dict[str, Any], dict[str, dataclasses.Field[Any]]]:
    """Types of a dataclass by field name, and its fields by TOML key."""
    fields = dataclasses.fields(kind)
    return typing.get_type_hints(kind), {toml_key(field): field for field in fields if toml_key(field)}


def convert(kind: Any, value: Any, key: str, fail: Fail) -> Any:
    """Convert one TOML value to the annotated type `kind`; numbers are never silently truncated."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if kind is Any:
        return value
    if origin is types.UnionType or origin is typing.Union:
        inner = type(value) if type(value) in arguments else arguments[0]
        return convert(inner, value, key, fail)
    if origin is Literal:
        if value not in arguments or isinstance(value, bool):
            choices = " or ".join(f"`{argument}`" for argument in arguments)
            fail(key, f"is {show(value)}, it must be {choices}", similar(str(value), map(str, arguments)))
        return value
    if origin is tuple:
        return tuple(
            convert(arguments[0], item, item_key(key, index, item), fail)
            for index, item in enumerate(of_type(list, value, key, fail))
        )
    if origin is dict:
        return dict(of_type(dict, value, key, fail))
    if dataclasses.is_dataclass(kind):
        return parse(typing.cast("type[Any]", kind), of_type(dict, value, key, fail), key, fail)
    return of_type(kind, value, key, fail)


NAMES = {
    float: "a number",
    int: "an integer",
    str: "a text",
    bool: "true or false",
    list: "an array",
    dict: "a table",
}
IDENTITY = {"wire": "to", "signal": "to", "inject": "to", "metric": "name", "criterion": "id"}
"""Key by which an item of an array of tables is known."""


def of_type(kind: type[T], value: Any, key: str, fail: Fail) -> T:
    """Return `value` if it is a `kind`; an integer is also a number, a Boolean never is."""
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        return typing.cast("T", float(value))
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        found = NAMES.get(type(value), type(value).__name__)
        fail(key, f"is {show(value)} ({found}), it must be {NAMES.get(kind, kind.__name__)}", "")
    return value


def toml_key(field: dataclasses.Field[Any]) -> str:
    """Name of a field in the TOML file."""
    return str(field.metadata.get("key", field.name))


def is_required(field: dataclasses.Field[Any]) -> bool:
    """Whether the field has no default."""
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def item_key(key: str, index: int, item: Any) -> str:
    """Dotted key of an array item: by its identity where it has one (`wire.controller.position`)."""
    identity = item.get(IDENTITY.get(key, "")) if isinstance(item, dict) else None
    return f"{key}.{identity}" if isinstance(identity, str) else f"{key}[{index}]"


def join(key: str, name: str) -> str:
    """Dotted key of `name` inside the table `key`."""
    return f"{key}.{name}" if key else name


def show(value: Any) -> str:
    """Value as it would stand in a TOML file, in backticks."""
    text = str(value).lower() if isinstance(value, bool) else repr(value)
    return f"`{text if len(text) <= 60 else text[:57] + '...'}`"
