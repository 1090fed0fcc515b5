"""Ineffective settings: criteria and injections without effect. They make a test meaningless."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cosim.loop.wires.fault import steps_of
from cosim.loop.wires.wiring import first_step
from cosim.scenario.injection import Injection
from cosim.scenario.model import Criterion, Loop, Scenario

NEUTRAL = {"offset": 0.0, "scale": 1.0, "ramp": 0.0, "noise": 0.0, "drop": 0.0}
"""Numbers without effect, by the kind of an injection."""


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
        if name := without_bound(criterion):
            key = f"criterion.{criterion.id}"
            yield key, f"`{key}.{name}` is `{getattr(criterion, name)}`, which any number meets"


def happens(injection: Injection, loop: Loop) -> bool:
    """Whether an injection is active in any step of a run that does not end early."""
    if injection.from_time is None:
        return True
    begin = first_step(injection.from_time, loop.step)
    return begin < min(begin + steps_of(injection, loop), loop.steps)


def without_bound(criterion: Criterion) -> str:
    """Name of an infinite limit of a criterion; empty if there is none."""
    ends = {"minimum": -math.inf, "maximum": math.inf}
    return next((name for name, end in ends.items() if getattr(criterion, name) == end), "")
