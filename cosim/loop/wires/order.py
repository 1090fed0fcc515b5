"""The order of FMUs in a step, and which wires need a delay in it."""

from __future__ import annotations

from cosim.errors import ScenarioError
from cosim.scenario.model import Scenario, Wire


def goes_back(wire: Wire, names: list[str]) -> bool:
    """Whether a wire between FMUs ends at one that steps before its source, or at its source itself."""
    source, target = sides(wire)
    return names.index(source) >= names.index(target)


def check(wire: Wire, scenario: Scenario) -> None:
    """Check that a wire between FMUs that goes back against the order of their steps has a delay.

    Raises
    ------
    ScenarioError
        It has none: in this step the value is not known yet.
    """
    names = [choice.name for choice in scenario.fmus]
    if wire.delay > 0 or not goes_back(wire, names):
        return
    source, target = sides(wire)
    hint = "`delay = 1` takes the value of the step before"
    if scenario.fmus[0].alone:
        problem = f"`from` = `{wire.source}`: an input of the controller takes a `plant.` reading"
        raise ScenarioError(problem, f"or its own output with a delay: {hint}")
    if source in reached(target, scenario):
        problem = (
            "closes an algebraic loop: from its target back to its source every wire acts in the same step"
        )
    else:
        problem = f"goes back in the order of the steps {ordered(names)}"
        hint += f", or list `{source}` before `{target}`"
    raise ScenarioError(f"the wire from `{wire.source}` to `{wire.to}` without `delay` {problem}", hint)


def reached(start: str, scenario: Scenario) -> set[str]:
    """FMUs that depend in the same step on one, which is among them itself."""
    names = {choice.name for choice in scenario.fmus}
    steps = [sides(wire) for wire in scenario.wire if not wire.delay]
    found, waiting = set[str](), [start]
    while waiting:
        name = waiting.pop()
        if name in names and name not in found:
            found.add(name)
            waiting += [target for source, target in steps if source == name]
    return found


def sides(wire: Wire) -> tuple[str, str]:
    """Names of what a wire leads from and to."""
    return wire.source.partition(".")[0], wire.to.partition(".")[0]


def ordered(names: list[str]) -> str:
    """Names in their order."""
    return ", ".join(f"`{name}`" for name in names)
