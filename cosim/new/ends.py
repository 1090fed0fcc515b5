"""Ports to wire, with type, unit, range and description for comments."""

from __future__ import annotations

import math
from dataclasses import dataclass

from cosim.fmu.archive import FmuFile, Variable
from cosim.loop import plant
from cosim.loop.plant import Channel
from cosim.new.match import End


@dataclass(frozen=True)
class Described:
    """A port with its comment and a start value as TOML."""

    end: End
    note: str
    start: str = "0.0"


def variables(file: FmuFile, causality: str) -> list[Described]:
    """List numeric inputs or outputs of an FMU."""
    return [variable(found) for found in file.named(causality) if found.base]


def variable(found: Variable) -> Described:
    """One variable of an FMU."""
    items = " | ".join(name for name, _ in found.items)
    limits = items or limits_text(found.minimum, found.maximum)
    note = ", ".join(part for part in (found.kind, found.unit, limits, found.description) if part)
    return Described(End(found.name, found.unit), one_line(note), start(found))


def start(found: Variable) -> str:
    """Start value as TOML."""
    if found.base == "Real":
        return repr(float(found.start or 0.0))
    if found.kind == "Boolean":
        return "true" if found.start in ("true", "1") else "false"
    return str(int(found.start or 0))


def channels(found: tuple[Channel, ...]) -> list[Described]:
    """List measurements or commands of a plant."""
    return [Described(End(one.name, one.unit), channel_note(one), repr(plant.start(one))) for one in found]


def channel_note(found: Channel) -> str:
    """Return the unit, range and description of a channel."""
    limits = limits_text(found.minimum, found.maximum)
    return one_line(", ".join(part for part in (found.unit, limits, found.description) if part))


def limits_text(minimum: float | str, maximum: float | str) -> str:
    """Range with optional ends."""
    low, high = (
        f"{float(end):g}" if end not in ("", None) and math.isfinite(float(end)) else ""
        for end in (minimum, maximum)
    )
    return f"{low} .. {high}".strip() if low or high else ""


def one_line(text: str) -> str:
    """Text for a comment."""
    return " ".join(text.split())
