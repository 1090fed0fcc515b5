"""What nothing drives: an input or command that a scenario forgot keeps its start value for the whole run."""

from __future__ import annotations

import functools
import logging

from cosim.errors import ScenarioError, closest, concerning
from cosim.fmu.archive import FmuFile
from cosim.loop.connect import targets
from cosim.loop.plant import Plant
from cosim.scenario.model import Scenario

log = logging.getLogger("cosim")


def report(scenario: Scenario, file: FmuFile, plant: Plant) -> None:
    """Log the inputs of the FMU and the commands of the plant that nothing drives and `idle` does not list.

    Raises
    ------
    ScenarioError
        `idle` lists something that is neither.
    """
    known = [f"controller.{variable.name}" for variable in file.named("input")]
    known += [f"plant.{channel.name}" for channel in plant.commands]
    for name in scenario.idle:
        if name not in known:
            with concerning("idle"):
                problem = f"`idle` lists `{name}`, which is no input of the FMU and no command of the plant"
                raise ScenarioError(problem, closest(name, known))
    if forgotten := undriven(scenario, known):
        names = ", ".join(f"`{name}`" for name in forgotten)
        where = scenario.origin("wire")
        warn(f"{where}: nothing drives {names}: wire what is missing, list the rest in `idle`")


def undriven(scenario: Scenario, known: list[str]) -> list[str]:
    """List the names of `known` without wire, signal, injection or start value that `idle` does not list."""
    started = {f"controller.{name}" for name in scenario.controller.parameters}
    meant = {to for _, to in targets(scenario)} | started | set(scenario.idle)
    return [name for name in known if name not in meant]


@functools.cache
def warn(text: str) -> None:
    """Log a warning once in a process."""
    log.warning("%s", text)
