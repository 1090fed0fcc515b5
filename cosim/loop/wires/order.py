"""The order of FMUs in a step, and the wires that need a delay."""

from __future__ import annotations

from cosim.errors import ScenarioError
from cosim.scenario.model import Scenario, Wire


def goes_back(wire: Wire, names: list[str]) -> bool:
    """Whether a wire between FMUs ends at its source or at an FMU that steps before it."""
    source, target = sides(wire)
    return names.index(source) >= names.index(target)


def check(wire: Wire, scenario: Scenario) -> None:
    """Check that a wire against the order of the steps has a delay.

    Raises
    ------
    ScenarioError
        It has no delay: the value is not yet known in this step.
    """
    names = [choice.name for choice in scenario.fmus]
    if wire.delay > 0 or not goes_back(wire, names):
        return
    source, target = sides(wire)
    hint = "Set `delay = 1` to use the value of the previous step"
    if scenario.fmus[0].alone:
        problem = f"`from` = `{wire.source}`: an input of the controller needs a `plant.` measurement"
        raise ScenarioError(problem, f"Or use its own output with a delay. {hint}.")
    if source in reached(target, scenario):
        problem = (
            "closes an algebraic loop: all wires from its target back to its source act in the same step"
        )
    else:
        problem = f"is against the order of the steps {ordered(names)}"
        hint += f", or list `{source}` before `{target}`"
    raise ScenarioError(f"the wire from `{wire.source}` to `{wire.to}` without `delay` {problem}", hint)


def reached(start: str, scenario: Scenario) -> set[str]:
    """FMUs that depend on a given one in the same step, including itself."""
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
    """Names of the FMUs or plant at the ends of a wire."""
    return wire.source.partition(".")[0], wire.to.partition(".")[0]


def ordered(names: list[str]) -> str:
    """Names in their order."""
    return ", ".join(f"`{name}`" for name in names)
