"""Undriven inputs, which keep their start value, and settings without effect."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cosim.errors import closest
from cosim.fmu.instance import Instance
from cosim.loop.plant import Plant, start
from cosim.loop.wires.connect import targets
from cosim.loop.wires.fault import steps_of
from cosim.loop.wires.transform import first_step
from cosim.scenario.injection import Injection
from cosim.scenario.model import Loop, Scenario
from cosim.warned import warn_once

MAX_NAMES = 8
"""Maximum number of names in one warning."""
NEUTRAL = {"offset": 0.0, "scale": 1.0, "ramp": 0.0, "noise": 0.0, "drop": 0.0}
"""Numbers without effect, by the kind of an injection."""


def report(scenario: Scenario, fmus: Sequence[Instance], plant: Plant) -> None:
    """Log undriven inputs that `undriven` does not list, and ineffective settings."""
    known = ends(fmus, plant)
    if text := unknown(scenario, known):
        warn_once(f"{scenario.origin('undriven')}: {text}")
    if forgotten := undriven(scenario, known):
        warn_once(f"{scenario.origin('wire')}: {sentence(forgotten, plant)}")
    for key, doubt in ineffective_settings(scenario):
        warn_once(f"{scenario.origin(key)}: {doubt}")


def report_unmet(scenario: Scenario, injected: Sequence[float | None]) -> None:
    """Log injections whose condition was never true."""
    for entry, begin in zip(scenario.inject, injected, strict=True):
        if entry.when and begin is None:
            key = f"inject.{entry.to}.when"
            text = f"`{key}` = `{entry.when}` was true too late or in no row of the run: it never started"
            warn_once(f"{scenario.origin(key)}: {text}")


def unknown(scenario: Scenario, known: list[str]) -> str:
    """Sentence about unknown names in `undriven`; empty if there are none."""
    names = [name for name in scenario.undriven if name not in known]
    if not names:
        return ""
    quoted = ", ".join(f"`{name}`" for name in names)
    return f"`undriven` lists {quoted}, which is not an input or command. {closest(names[0], known)}"


def ends(fmus: Sequence[Instance], plant: Plant) -> list[str]:
    """List everything that can be driven: inputs of the FMUs, commands of the plant."""
    inputs = [f"{fmu.name}.{variable.name}" for fmu in fmus for variable in fmu.file.named("input")]
    return inputs + [f"plant.{channel.name}" for channel in plant.commands]


def sentence(forgotten: list[str], plant: Plant) -> str:
    """Sentence about undriven inputs; shows the start value of commands that do not start at 0."""
    held = {f"plant.{channel.name}": start(channel) for channel in plant.commands if start(channel)}
    names = [f"`{name}`" + (f" (stays at {held[name]:g})" if name in held else "") for name in forgotten]
    more = f" and {len(names) - MAX_NAMES} more" if len(names) > MAX_NAMES else ""
    shown = ", ".join(names[:MAX_NAMES]) + more
    return f"nothing drives {shown}: add the missing wires and list the others in `undriven`"


def undriven(scenario: Scenario, known: list[str]) -> list[str]:
    """List names of `known` without wire, signal, injection or start value that `undriven` does not list."""
    started = {f"{choice.name}.{name}" for choice in scenario.fmus for name in choice.parameters}
    meant = {to for _, to in targets(scenario)} | started | set(scenario.undriven)
    return [name for name in known if name not in meant]


def ineffective_settings(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Keys and sentences about injections that never start and limits that any number meets."""
    for injection in scenario.inject:
        if not happens(injection, scenario.loop):
            end = f"no step of the run, which ends at {scenario.loop.duration:g} s"
            until = "" if injection.to_time is None else f" to {injection.to_time:g} s"
            span = f"from {injection.from_time:g} s{until}"
            yield f"inject.{injection.to}", f"`inject.{injection.to}` {span} reaches {end}: it never starts"
        kind = injection.kind
        if getattr(injection, kind) == NEUTRAL.get(kind):
            key = f"inject.{injection.to}.{kind}"
            yield key, f"`{key}` is `{getattr(injection, kind):g}`, which changes nothing"
    for criterion in scenario.criterion:
        for name, infinite in (("minimum", -math.inf), ("maximum", math.inf)):
            if getattr(criterion, name) == infinite:
                key = f"criterion.{criterion.id}"
                yield key, f"`{key}.{name}` is `{infinite}`, which any number meets"
                break


def happens(injection: Injection, loop: Loop) -> bool:
    """Whether an injection is active in any step of a run that does not end early."""
    if injection.from_time is None:
        return True
    begin = first_step(injection.from_time, loop.step)
    return begin < min(begin + steps_of(injection, loop), loop.steps)
