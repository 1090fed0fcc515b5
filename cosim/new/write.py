"""The text of a new scenario."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator

from cosim.new.draft import Draft, End, Side
from cosim.scenario.injection import INJECTED

PLAIN = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*|\[\d+\])*")
"""Names that need no quotes in an expression."""


def text(draft: Draft) -> str:
    """Write a scenario that can run; unconnected ports are comments."""
    return "\n\n".join([*head(draft), *wires(draft), *left(draft), *examples(draft)]) + "\n"


def head(draft: Draft) -> Iterator[str]:
    """Title, loop, FMU and plant."""
    names = [port(side, end) for side in draft.sides for end in side.undriven]
    undriven = f"""
# undriven: remove the `# `; the list names inputs that keep their start value
# undriven = [{", ".join(names)}]"""
    yield f"title = {quoted(draft.title)}{undriven if names else ''}"
    substeps = "\n" + noted(f"substeps = {draft.substeps}", "plant steps in each communication step")
    yield f"""\
[loop]
{noted(f"step = {draft.step!r}", "s, communication step of the FMU")}{substeps if draft.plant else ""}
{noted(f"duration = {seconds(draft.duration)}", "s")}

[controller]
fmu = {quoted(draft.fmu)}

[controller.parameters]    # `cosim show` lists them"""
    if draft.plant:
        values = draft.parameters.items()
        parameters = [f"\n{name} = {quoted(value)}    # {reason}" for name, (value, reason) in values]
        yield f"[plant]\nname = {quoted(draft.plant)}\n\n[plant.parameters]{''.join(parameters)}"


def wires(draft: Draft) -> Iterator[str]:
    """Wires between ends that fit."""
    for target, source in zip(draft.sides, reversed(draft.sides), strict=True):
        for match in target.wires:
            doubt = "" if match.sure else "# the only remaining pair: check it\n"
            scale, offset = match.conversion
            line = noted(f"scale = {scale!r}", f"{match.source.unit} to {match.target.unit}")
            scaled = f"\n{line}" if match.conversion.changes else ""
            moved = f"\noffset = {offset!r}" if offset else ""
            from_, to = port(source, match.source), port(target, match.target)
            yield f"{doubt}[[wire]]\nfrom = {from_}\nto = {to}{scaled}{moved}"


def left(draft: Draft) -> Iterator[str]:
    """List undriven and unused ports as comments."""
    for side, what in zip(draft.sides, ("undriven inputs of the FMU", "undriven commands"), strict=True):
        if side.undriven:
            yield f"# {what}: remove the `# ` of a signal, or make it a wire with `from`"
        for end in side.undriven:
            yield f"""\
# {end.note or "(no description)"}
# [[signal]]
# to = {port(side, end)}
# times = [0.0]
# values = [{end.start}]"""
    for side, other in zip(draft.sides, reversed(draft.sides), strict=True):
        used = {match.source for match in other.wires}
        if unread := [f"\n#   {side.name}.{end.name}: {end.note}" for end in side.sources if end not in used]:
            yield f"# not wired:{''.join(unread)}"


def examples(draft: Draft) -> Iterator[str]:
    """Fault of the first measurement, metric of the first output, and a criterion to fill in."""
    others = ", ".join(kind for kind in INJECTED if kind != "frozen")
    controller, _ = draft.sides
    for match in controller.wires[:1]:
        yield f"""\
# a fault on the wire: remove the `# ` and check the reaction of the FMU
# [[inject]]
# to = {port(controller, match.target)}
# from_time = {seconds(0.5 * draft.duration)}
{noted("# frozen = true", f"or {others}")}"""
    for first in controller.sources[:1]:
        yield f"""\
[[metric]]
name = "peak"
value = {quoted(f"max(abs({column(first.name)}))")}

# set your limit and remove the `# `
# [[criterion]]
# id = "peak"
# claim = {quoted(f"{first.name} stays small")}
# metric = "peak"
# maximum = 1.0"""


def noted(line: str, note: str) -> str:
    """Line with a note."""
    return f"{line:<26}# {note}"


def seconds(time: float) -> str:
    """Time without the rounding errors of its computation."""
    return repr(float(f"{time:.12g}"))


def port(side: Side, end: End) -> str:
    """Name of a port in TOML."""
    return quoted(f"{side.name}.{end.name}")


def column(name: str) -> str:
    """Column of an output in an expression."""
    full = f"controller.{name}"
    return full if PLAIN.fullmatch(full) else f"column({json.dumps(full, ensure_ascii=False)})"


def quoted(text: str) -> str:
    """Text in TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
