"""The text of a new scenario."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cosim.new.ends import Described
from cosim.new.match import Match
from cosim.scenario.injection import INJECTED

PLAIN = re.compile(r"[A-Za-z_]\w*(\.[A-Za-z_]\w*|\[\d+\])*")
"""Names that an expression takes as they are."""


@dataclass(frozen=True)
class Draft:
    """What a new scenario holds.

    Parameters
    ----------
    title, fmu, plant
        Title, and names or paths as they shall stand in the file; no plant is empty.
    step, substeps, steps
        Communication step in s, plant steps in it, length of the run in steps.
    readings, commands
        Wires to the FMU and to the plant.
    inputs, outputs, sensed, commanded
        All inputs and outputs of the FMU, readings and commands of the plant.
    """

    title: str
    fmu: str
    plant: str
    step: float
    substeps: int
    steps: int
    readings: list[Match]
    commands: list[Match]
    inputs: list[Described]
    outputs: list[Described]
    sensed: list[Described]
    commanded: list[Described]


def text(draft: Draft) -> str:
    """Write a scenario that can run; what could not be wired stands in it as comments."""
    return "\n".join([*head(draft), *wires(draft), *left(draft), *faults(draft), *demands(draft)]) + "\n"


def head(draft: Draft) -> Iterator[str]:
    """Loop, FMU and plant."""
    yield f"title = {quoted(draft.title)}"
    names = [f"controller.{end.end.name}" for end in undriven(draft.inputs, draft.readings)]
    names += [f"plant.{end.end.name}" for end in undriven(draft.commanded, draft.commands)]
    if names:
        yield "# what nothing drives; take away the `# ` and leave in the list what keeps its start value"
        yield f"# idle = [{', '.join(map(quoted, names))}]"
    yield ""
    yield "[loop]"
    yield f"step = {draft.step!r}".ljust(26) + "# s, the FMU is called so often"
    if draft.plant:
        yield f"substeps = {draft.substeps}".ljust(26) + "# steps of the plant in between"
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
        yield "# the only ones that were left: is this meant?"
    yield "[[wire]]"
    yield f"from = {quoted(f'{source}.{match.source.name}')}"
    yield f"to = {quoted(f'{target}.{match.target.name}')}"
    if match.scale != 1.0:
        yield f"scale = {match.scale!r}".ljust(26) + f"# {match.source.unit} to {match.target.unit}"
    yield ""


def left(draft: Draft) -> Iterator[str]:
    """Tell what nothing drives and what nobody reads, as comments."""
    inputs, commands = undriven(draft.inputs, draft.readings), undriven(draft.commanded, draft.commands)
    yield from signals("controller", inputs, "inputs of the FMU that nothing drives")
    yield from signals("plant", commands, "commands that nothing drives")
    yield from unread("controller", draft.outputs, draft.commands)
    yield from unread("plant", draft.sensed, draft.readings)


def undriven(ends: Sequence[Described], matches: list[Match]) -> list[Described]:
    """List the ends without a wire."""
    driven = {match.target.name for match in matches}
    return [end for end in ends if end.end.name not in driven]


def signals(side: str, rest: list[Described], title: str) -> Iterator[str]:
    """Signals for ends without a wire, as comments."""
    if rest:
        yield f"# {title}: take away the `# ` of a signal, or make it a wire with `from`"
        yield ""
    for end in rest:
        yield f"# {end.note}" if end.note else "# (nothing is known of it)"
        yield "# [[signal]]"
        yield f"# to = {quoted(f'{side}.{end.end.name}')}"
        yield "# times = [0.0]"
        yield f"# values = [{end.start}]"
        yield ""


def unread(side: str, ends: Sequence[Described], matches: list[Match]) -> Iterator[str]:
    """Tell sources without a wire, as comments."""
    used = {match.source.name for match in matches}
    rest = [end for end in ends if end.end.name not in used]
    if rest:
        yield "# not wired:"
        yield from (f"#   {side}.{end.end.name}: {end.note}" for end in rest)
        yield ""


def faults(draft: Draft) -> Iterator[str]:
    """Fault of the first reading, as a comment."""
    for match in draft.readings[:1]:
        yield "# a fault on the way: take away the `# `, and see what the FMU makes of it"
        yield "# [[inject]]"
        yield f"# to = {quoted(f'controller.{match.target.name}')}"
        yield f"# from_time = {float(f'{0.5 * draft.steps * draft.step:.12g}')!r}"
        yield "# frozen = true".ljust(26) + f"# or {', '.join(kind for kind in INJECTED if kind != 'frozen')}"
        yield ""


def demands(draft: Draft) -> Iterator[str]:
    """Metric of the first output, and a criterion to fill in."""
    if not draft.outputs:
        return
    first = draft.outputs[0].end
    yield "[[metric]]"
    yield 'name = "peak"'
    yield f"value = {quoted(f'max(abs({column(first.name)}))')}"
    yield ""
    yield "# give it the limit that you demand, and take away the `# `"
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
