"""What a scenario demands or injects to no effect: no error, but a test that tests nothing."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cosim.loop.wires.wiring import first_step
from cosim.scenario.model import Criterion, Injection, Loop, Scenario


def doubts(scenario: Scenario) -> Iterator[tuple[str, str]]:
    """Keys and sentences about injections that never happen and limits that hold for any number."""
    for injection in scenario.inject:
        if not happens(injection, scenario.loop):
            end = f"no step of the run, which ends at {scenario.loop.duration:g} s"
            span = f"from {injection.from_time:g} s to {injection.to_time:g} s"
            yield f"inject.{injection.to}", f"`inject.{injection.to}` {span} reaches {end}: it never happens"
    for criterion in scenario.criterion:
        if name := boundless(criterion):
            key = f"criterion.{criterion.id}"
            yield key, f"`{key}.{name}` is `{getattr(criterion, name)}`, which any number holds"


def happens(injection: Injection, loop: Loop) -> bool:
    """Whether an injection is active in any step of a run that does not end early."""
    begin, end = (first_step(time, loop.step) for time in (injection.from_time, injection.to_time))
    return begin < min(end, loop.steps)


def boundless(criterion: Criterion) -> str:
    """Name of a limit of a criterion that limits nothing; empty if there is none."""
    ends = {"minimum": -math.inf, "maximum": math.inf}
    return next((name for name, end in ends.items() if getattr(criterion, name) == end), "")
