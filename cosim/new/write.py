"""The text of a new scenario."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence

from cosim.new.draft import Draft
from cosim.new.match import End, Match
from cosim.scenario.injection import INJECTED

PLAIN = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*|\[\d+\])*")
"""Names that need no quotes in an expression."""


def text(draft: Draft) -> str:
    """Write a scenario that can run; unconnected ports are comments."""
    return "\n".join([*head(draft), *wires(draft), *left(draft), *faults(draft), *demands(draft)]) + "\n"


def head(draft: Draft) -> Iterator[str]:
    """Loop, FMU and plant."""
    yield f"title = {quoted(draft.title)}"
    names = [f"{side}.{end.name}" for side, ends in draft.undriven.items() for end in ends]
    if names:
        yield "# undriven: remove the `# `; the list names inputs that keep their start value"
        yield f"# undriven = [{', '.join(map(quoted, names))}]"
    yield ""
    yield "[loop]"
    yield f"step = {draft.step!r}".ljust(26) + "# s, communication step of the FMU"
    if draft.plant:
        yield f"substeps = {draft.substeps}".ljust(26) + "# plant steps in each communication step"
    yield f"duration = {float(f'{draft.steps * draft.step:.12g}')!r}".ljust(26) + "# s"
    yield ""
    yield "[controller]"
    yield f"fmu = {quoted(draft.fmu)}"
    yield ""
    yield "[controller.parameters]    # `cosim show` lists them"
    yield ""
    if draft.plant:
        yield "[plant]"
        yield f"name = {quoted(draft.plant)}"
        yield ""
        yield "[plant.parameters]"
        for name, (value, reason) in draft.parameters.items():
            yield f"{name} = {quoted(value)}    # {reason}"
        yield ""


def wires(draft: Draft) -> Iterator[str]:
    """Wires between ends that fit."""
    for match in draft.readings:
        yield from wire(match, "plant", "controller")
    for match in draft.commands:
        yield from wire(match, "controller", "plant")


def wire(match: Match, source: str, target: str) -> Iterator[str]:
    """One wire."""
    if not match.sure:
        yield "# the only remaining pair: check it"
    yield "[[wire]]"
    yield f"from = {quoted(f'{source}.{match.source.name}')}"
    yield f"to = {quoted(f'{target}.{match.target.name}')}"
    if match.conversion.changes:
        scale, offset = match.conversion
        yield f"scale = {scale!r}".ljust(26) + f"# {match.source.unit} to {match.target.unit}"
        if offset:
            yield f"offset = {offset!r}"
    yield ""


def left(draft: Draft) -> Iterator[str]:
    """List undriven and unused ports as comments."""
    yield from signals("controller", draft.undriven["controller"], "undriven inputs of the FMU")
    yield from signals("plant", draft.undriven["plant"], "undriven commands")
    yield from unread("controller", draft.outputs, draft.commands)
    yield from unread("plant", draft.sensed, draft.readings)


def signals(side: str, rest: list[End], title: str) -> Iterator[str]:
    """Signals for ends without a wire, as comments."""
    if rest:
        yield f"# {title}: remove the `# ` of a signal, or make it a wire with `from`"
        yield ""
    for end in rest:
        yield f"# {end.note}" if end.note else "# (no description)"
        yield "# [[signal]]"
        yield f"# to = {quoted(f'{side}.{end.name}')}"
        yield "# times = [0.0]"
        yield f"# values = [{end.start}]"
        yield ""


def unread(side: str, ends: Sequence[End], matches: list[Match]) -> Iterator[str]:
    """List sources without a wire as comments."""
    used = {match.source for match in matches}
    rest = [end for end in ends if end not in used]
    if rest:
        yield "# not wired:"
        yield from (f"#   {side}.{end.name}: {end.note}" for end in rest)
        yield ""


def faults(draft: Draft) -> Iterator[str]:
    """Fault of the first measurement, as a comment."""
    for match in draft.readings[:1]:
        yield "# a fault on the wire: remove the `# ` and check the reaction of the FMU"
        yield "# [[inject]]"
        yield f"# to = {quoted(f'controller.{match.target.name}')}"
        yield f"# from_time = {float(f'{0.5 * draft.steps * draft.step:.12g}')!r}"
        yield "# frozen = true".ljust(26) + f"# or {', '.join(kind for kind in INJECTED if kind != 'frozen')}"
        yield ""


def demands(draft: Draft) -> Iterator[str]:
    """Metric of the first output, and a criterion to fill in."""
    if not draft.outputs:
        return
    first = draft.outputs[0]
    yield "[[metric]]"
    yield 'name = "peak"'
    yield f"value = {quoted(f'max(abs({column(first.name)}))')}"
    yield ""
    yield "# set your limit and remove the `# `"
    yield "# [[criterion]]"
    yield '# id = "peak"'
    yield f"# claim = {quoted(f'{first.name} stays small')}"
    yield '# metric = "peak"'
    yield "# maximum = 1.0"


def column(name: str) -> str:
    """Column of an output in an expression."""
    full = f"controller.{name}"
    return full if PLAIN.fullmatch(full) else f"column({json.dumps(full, ensure_ascii=False)})"


def quoted(text: str) -> str:
    """Text in TOML."""
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")
