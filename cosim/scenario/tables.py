"""TOML tables to dataclasses: unknown keys, wrong types and values out of range name their key.

For the reason not to use a library see ARCHITECTURE.md, "The validator".
"""

from __future__ import annotations

import dataclasses
import datetime
import functools
import math
import types
import typing
from collections.abc import Callable
from typing import Any, Literal, NoReturn, TypeVar

from cosim.errors import closest, show, similar

T = TypeVar("T")
Fail = Callable[..., NoReturn]
"""Raises the error of the caller from key, problem and optional hint."""
Reader = Callable[[Any], Any]
"""Converts a TOML value into that of the dataclass, or raises `Mismatch`."""
IDENTITY = {"fmu": "name", "wire": "to", "signal": "to", "inject": "to", "metric": "name", "criterion": "id"}
"""Key that identifies an item of an array of tables."""
NAMES = {
    float: "a number", int: "an integer", str: "a text", bool: "true or false", list: "an array",
    dict: "a table", datetime.date: "a date", datetime.datetime: "a date with a time",
    datetime.time: "a time of the day",
}  # fmt: skip


class Mismatch(Exception):  # noqa: N818
    """An invalid value; `path` is its location in the table."""

    def __init__(self, problem: str, hint: str = "", *path: str | int) -> None:
        super().__init__(problem)
        self.problem, self.hint, self.path = problem, hint, list(path)


def parse(kind: type[T], table: dict[str, Any], key: str, fail: Fail) -> T:
    """Build the dataclass `kind` from a TOML table, whose dotted `key` is for messages.

    The metadata of a field may hold a different TOML `key` ("" for none), the closed range
    `minimum` .. `maximum`, its `unit`, and a text of the requirement (`demand`).
    """
    try:
        return typing.cast("T", built(kind, table))
    except Mismatch as found:
        fail(dotted(found.path, table, key), found.problem, found.hint)


def parse_value(kind: Any, name: str, value: Any, key: str, fail: Fail) -> Any:
    """Value of one key of a table, as in `parse`."""
    fields = readers(kind)
    if name not in fields:
        fail(join(key, name), "is not a known key", closest(name, fields))
    try:
        return fields[name][1](value)
    except Mismatch as found:
        fail(dotted([name, *found.path], {name: value}, key), found.problem, found.hint)


@functools.lru_cache(64)
def readers(kind: Any) -> dict[str, tuple[str, Reader]]:
    """Name and reader of each field of a dataclass, by its TOML key."""
    hints = typing.get_type_hints(kind)
    return {
        toml_key(field): (field.name, ranged(reader(hints[field.name]), field.metadata))
        for field in dataclasses.fields(kind)
        if toml_key(field)
    }


@functools.lru_cache(512)
def reader(kind: Any) -> Reader:
    """Reader of the annotated type `kind`; numbers are never silently truncated."""
    origin, arguments = typing.get_origin(kind), typing.get_args(kind)
    if kind is Any:
        return lambda value: value
    if origin is types.UnionType or origin is typing.Union:
        choices = {taken: reader(choice) for choice in arguments for taken in kinds(choice)}
        return functools.partial(one_of, choices)
    if origin is Literal:
        return functools.partial(chosen, arguments)
    if origin is tuple:
        return functools.partial(array, reader(arguments[0]))
    if origin is dict:
        return functools.partial(mapping, reader(arguments[1]))
    if dataclasses.is_dataclass(kind):
        return functools.partial(built, kind)
    return functools.partial(of_type, kind)


def built(kind: Any, value: Any) -> Any:
    """Dataclass of a table."""
    table, fields = of_type(dict, value), readers(kind)
    for name in table:
        if name not in fields:
            raise Mismatch("is not a known key", closest(name, fields), name)
    values = {fields[name][0]: read_inside(fields[name][1], item, name) for name, item in table.items()}
    for field in dataclasses.fields(kind):
        if is_required(field) and toml_key(field) not in table:
            raise Mismatch("is missing", "", toml_key(field))
    return kind(**values)


def read_inside(read: Reader, item: Any, name: str | int) -> Any:
    """Value of an item of a table or array."""
    try:
        return read(item)
    except Mismatch as found:
        found.path.insert(0, name)
        raise


def array(read: Reader, value: Any) -> tuple[Any, ...]:
    """Tuple of an array."""
    return tuple(read_inside(read, item, index) for index, item in enumerate(of_type(list, value)))


def mapping(read: Reader, value: Any) -> dict[str, Any]:
    """Table of any keys."""
    return {name: read_inside(read, item, name) for name, item in of_type(dict, value).items()}


def kinds(choice: Any) -> set[Any]:
    """Types of the values of one choice of a union."""
    items = typing.get_args(choice) if typing.get_origin(choice) is Literal else ()
    return {type(item) for item in items} or {choice}


def one_of(choices: dict[Any, Reader], value: Any) -> Any:
    """Value of the choice with its type, otherwise of the first that accepts it."""
    return choices.get(type(value), next(iter(choices.values())))(value)


def chosen(arguments: tuple[Any, ...], value: Any) -> Any:
    """Value from a list; `1.0` and `true` are not `1`."""
    if any(type(value) is type(argument) and value == argument for argument in arguments):
        return value
    choices = " or ".join(f"`{argument}`" for argument in arguments)
    raise Mismatch(f"is {show(value)}, it must be {choices}", similar(str(value), map(str, arguments)))


def of_type(kind: Any, value: Any) -> Any:
    """Return `value` if it is a `kind`; an integer is also a number, a Boolean never is."""
    if kind is float and isinstance(value, int) and not isinstance(value, bool):
        return float(value)
    if not isinstance(value, kind) or (isinstance(value, bool) and kind is not bool):
        found = NAMES.get(type(value), type(value).__name__)
        raise Mismatch(f"is {show(value)} ({found}), it must be {NAMES.get(kind, kind.__name__)}")
    return value


def ranged(read: Reader, limits: typing.Mapping[str, Any]) -> Reader:
    """Reader that also checks the range in the metadata of a field."""
    minimum, maximum = limits.get("minimum"), limits.get("maximum")
    if minimum is None and maximum is None:
        return read
    low, high = -math.inf if minimum is None else minimum, math.inf if maximum is None else maximum
    unit = f" {limits.get('unit', '').removeprefix('1')}".rstrip()
    ends = " .. ".join("" if end is None else f"{end:g}" for end in (minimum, maximum))

    def checked(value: Any) -> Any:
        converted = read(value)
        for number in converted if isinstance(converted, tuple) else (converted,):
            # the comparison rejects NaN
            if isinstance(number, int | float) and not low <= number <= high:
                if "demand" in limits:
                    raise Mismatch(f"is `{number}`{unit}, it must {limits['demand']}")
                raise Mismatch(f"is `{number}`, it must be in {ends}{unit}")
        return converted

    return checked


def toml_key(field: dataclasses.Field[Any]) -> str:
    """Name of a field in the TOML file."""
    return str(field.metadata.get("key", field.name))


def is_required(field: dataclasses.Field[Any]) -> bool:
    """Whether the field has no default."""
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def dotted(path: list[str | int], value: Any, key: str = "") -> str:
    """Key of the value at a path below `value` with the key `key`."""
    for part in path:
        inner = value[part] if isinstance(part, int) or part in value else None
        key = item_key(key, part, inner) if isinstance(part, int) else join(key, part)
        value = inner
    return key


def item_key(key: str, index: int, item: Any) -> str:
    """Dotted key of an array item, by its identity if it has one (`wire.controller.position`)."""
    identity = item.get(IDENTITY.get(key, "")) if isinstance(item, dict) else None
    return f"{key}.{identity}" if isinstance(identity, str) else f"{key}[{index}]"


def join(key: str, name: str) -> str:
    """Dotted key of `name` inside the table `key`."""
    return f"{key}.{name}" if key else name
