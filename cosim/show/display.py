"""Tables of the command line: descriptions and criteria."""

from __future__ import annotations

import dataclasses
import math
import re
import typing
from collections.abc import Sequence
from typing import Any

from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from cosim.errors import CosimError, closest
from cosim.fmu.description import Variable
from cosim.fmu.instance import Instance
from cosim.formatting.quantity import number, text
from cosim.formatting.verdicts import cells, columns, counted, outcome
from cosim.loop.plant import Channel, Plant, start
from cosim.loop.result import Result
from cosim.metrics.criteria import Verdict
from cosim.scenario.injection import Injection
from cosim.scenario.model import Scenario
from cosim.scenario.tables import toml_key
from cosim.show.listing import plain_table

STYLES = {True: "bold green", False: "bold red", None: "bold"}
"""Style of a verdict by `passed`."""
CAUSALITIES = {
    "input": "inputs",
    "output": "outputs",
    "parameter": "parameters",
    "calculatedParameter": "calculated",
}


def scenario(
    found: Scenario, fmus: Sequence[Instance], plant: Plant, wanted: Sequence[str] = ()
) -> RenderableType:
    """Return the description of one closed loop, or only tables with a word of `wanted` in the title."""
    tables = {
        f"{fmu.name} {title}": variable_table(variables, choice.parameters)
        for choice, fmu in zip(found.fmus, fmus, strict=True)
        for causality, title in CAUSALITIES.items()
        if (variables := fmu.file.named(causality))
    }
    if found.plant.name:
        tables |= {
            f"plant `{found.plant.name}`: parameters": parameter_table(plant, found.plant.parameters),
            "plant measurements": channel_table(plant.readings),
            "plant commands": channel_table(plant.commands),
            "plant ground truth": channel_table(plant.truths),
        }
    tables["wires, signals and injections"] = wire_table(found)
    words = {title: re.findall(r"\w+", title) for title in tables}
    for part in wanted:
        if not any(part in found for found in words.values()):
            known = dict.fromkeys(word for found in words.values() for word in found if word != "and")
            raise CosimError(f"`{found.name}` has no part `{part}`", closest(part, known))
    shown = [title for title in tables if not wanted or set(words[title]) & set(wanted)]
    parts = [part for t in shown for part in (Text(f"\n{t}", style="bold underline"), tables[t])]
    return Group(*([] if wanted else [head(found, fmus)]), *parts)


def head(found: Scenario, fmus: Sequence[Instance]) -> Text:
    """Title, description and settings of a scenario."""
    loop = found.loop
    head = Text().append(f"{found.name}: {found.title}\n", style="bold")
    if found.description.strip():
        head.append(f"\n{found.description.strip()}\n")
    delay = f"compute delay {loop.compute_delay} step" + ("" if loop.compute_delay == 1 else "s")
    steps = f"step {text(loop.step, 's')}, {loop.substeps} plant steps each, {loop.duration:g} s long"
    head.append(f"\nloop: {steps}, {loop.order}, {delay}, seed {loop.seed}\n")
    return head.append("\n".join(f"{fmu.name}: {fmu.file.name} ({fmu.file.path.name})" for fmu in fmus))


def variable_table(variables: list[Variable], given: dict[str, Any]) -> Table:
    """Variables of an FMU."""
    rows = [
        (
            one.name,
            value_text(given.get(one.name), start_text(one)),
            one.unit,
            range_text(one),
            one.description,
        )
        for one in variables
    ]
    return plain_table("name", "value", "unit", "range", "description", rows=rows)


def value_text(given: Any, default: str) -> Text:
    """Value in use; one that differs from the default is bold and shows both."""
    if given is None or shorten(given) == default:
        return Text(default)
    return Text(f"{shorten(given)} (default {default})", style="bold")


def start_text(variable: Variable) -> str:
    """Start value, enumerations by name."""
    if variable.base == "Real" and variable.start:
        return f"{float(variable.start):g}"
    names = {str(number): name for name, number in variable.items}
    return names.get(variable.start, variable.start)


def range_text(variable: Variable) -> str:
    """Range of a variable: limits, or the items of an enumeration."""
    items = " ".join(name for name, _ in variable.items)
    return items or limits_text(variable.minimum, variable.maximum)


def limits_text(minimum: Any, maximum: Any) -> str:
    """Two optional limits."""
    limits = [math.inf if limit in (None, "") else float(limit) for limit in (minimum, maximum)]
    low, high = (f"{limit:g}" if math.isfinite(limit) else "" for limit in limits)
    return f"{low} .. {high}" if low or high else ""


def parameter_table(plant: Plant, given: dict[str, Any]) -> Table:
    """Parameters of a plant, from the metadata of its dataclass."""
    table = plain_table("name", "value", "unit", "range", "description", "source")
    for field in dataclasses.fields(typing.cast(Any, plant.Parameters)):
        key, default = toml_key(field), field.default
        if field.default_factory is not dataclasses.MISSING:
            default = field.default_factory()
        shown = value_text(given.get(key), "required" if default is dataclasses.MISSING else shorten(default))
        unit, *texts = (str(field.metadata.get(name, "")) for name in ("unit", "description", "source"))
        limits = limits_text(field.metadata.get("minimum"), field.metadata.get("maximum"))
        table.add_row(key, shown, unit, limits, *texts)
    return table


def channel_table(channels: tuple[Channel, ...]) -> Table:
    """Channels of a plant."""
    table = plain_table("name", "unit", "start", "noise", "resolution", "range", "description")
    for channel in channels:
        numbers = (start(channel), channel.noise, channel.quantum)
        shown = (text(number, channel.unit) if number else "" for number in numbers)
        limits = limits_text(channel.minimum, channel.maximum)
        table.add_row(channel.name, channel.unit, *shown, limits, channel.description)
    return table


def wire_table(found: Scenario) -> Table:
    """Wires, signals and injections."""
    table = plain_table("to", "from", "options")
    defaults = {"scale": 1.0, "offset": 0.0, "delay": 0, "stream": ""}
    for wire in found.wire:
        options = [
            f"{key} {value}" if isinstance(value, str) else f"{key} {value:g}"
            for key, value in dataclasses.asdict(wire).items()
            if key not in ("source", "to") and value is not None and value != defaults.get(key)
        ]
        table.add_row(wire.to, wire.source, ", ".join(options))
    for signal in found.signal:
        pairs = zip(signal.times, signal.values, strict=False)
        points = ", ".join(f"{shorten(value)} from {time:g} s" for time, value in pairs)
        shown = f"{signal.column or 'the column'} of {signal.file}" if signal.file else points
        table.add_row(signal.to, "signal", shown)
    for entry in found.inject:
        table.add_row(entry.to, "injection", injection_text(entry))
    return table


def injection_text(entry: Injection) -> str:
    """Describe the effect and the time of an injection."""
    said = "" if entry.kind == "frozen" else f" {getattr(entry, entry.kind):g}"
    begin = f"from {entry.from_time:g} s" if entry.from_time is not None else f"when {entry.when}"
    after = f" after {entry.after:g} s" if entry.after else ""
    end = "" if entry.to_time is None else f" to {entry.to_time:g} s"
    lasting = "" if entry.duration is None else f" for {entry.duration:g} s"
    return f"{entry.kind}{said} {begin}{after}{end}{lasting}"


def result(found: Result) -> RenderableType:
    """Metrics without a criterion, the table of criteria, and the verdict."""
    held = {verdict.criterion.metric for verdict in found.criteria}
    others = [metric for metric in found.metrics.values() if metric.name not in held]
    parts: list[RenderableType] = [Text(f"{found.scenario}: {found.title}", style="bold")]
    if found.criteria:
        parts += ["", criteria_table(found.criteria)]
    if others:
        rows = [(one.name, text(one.value, one.unit), one.description) for one in others]
        parts += ["", plain_table("metric", "value", "description", rows=rows)]
    return Group(*parts, "", summary(found))


def criteria_table(verdicts: list[Verdict]) -> Table:
    """Table of criteria; without `paper` if no criterion compares with a paper."""
    table = Table(show_edge=False, pad_edge=False, header_style="bold", border_style="dim")
    names = columns(verdicts)
    for name in names:
        if name in ("claim", "paper"):
            table.add_column(name, ratio=1 if name == "claim" else None, overflow="fold")
        else:
            table.add_column(name, justify="left" if name == "result" else "right", no_wrap=True)
    for verdict in verdicts:
        *parts, _ = (Text(cell) for cell in cells(verdict, names))
        table.add_row(*parts, pass_text(verdict))
    return table


def pass_text(verdict: Verdict) -> Text:
    """Return the result of a criterion, in color."""
    return Text(outcome(verdict), style="green" if verdict.passed else "bold red")


def summary(found: Result) -> Text:
    """One line: verdict, seed and speed."""
    verdict = Text(counted(found.criteria), style=STYLES[found.passed])
    verdict.append(f"; seed {found.seed}, {speed(found)}", style="not bold default")
    return verdict


def speed(found: Result) -> str:
    """Return the simulated time, and the wall time of a run."""
    simulated = f"{number(found.simulated_s)} s"
    if not found.wall_s:
        return f"{simulated} evaluated from a stored trace"
    ratio = number(found.simulated_s / found.wall_s, 2)
    return f"{simulated} simulated in {number(found.wall_s, 3)} s ({ratio} x real time)"


def shorten(value: Any) -> str:
    """Value of a parameter as text."""
    if isinstance(value, bool):
        return str(value).lower()
    return f"{value:g}" if isinstance(value, float) else str("" if value is None else value)
