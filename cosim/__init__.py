"""Co-simulation of FMI 2.0 FMUs with plants: scenarios, the reference loop, results and criteria.

>>> import cosim
>>> result = cosim.run(cosim.load("dob", set=["plant.gap=2e-4"]), seed=7)  # doctest: +SKIP
>>> result.passed, result.metrics["depth"].value, result.trace["controller.current"]  # doctest: +SKIP
"""

from cosim.errors import CosimError
from cosim.loop.result import Result
from cosim.loop.session import Session
from cosim.pool.runs import run, run_each, run_many
from cosim.scenario.load import load
from cosim.scenario.model import Scenario

__all__ = ["CosimError", "Result", "Scenario", "Session", "load", "run", "run_each", "run_many"]
