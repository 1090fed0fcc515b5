"""Co-simulation of FMI 2.0 FMUs with plants: scenarios, the reference loop, results and criteria.

>>> import cosim
>>> result = cosim.run(cosim.load("dob", set=["plant.gap=2e-4"]), seed=7)  # doctest: +SKIP
>>> result.passed, result.metrics["depth"].value, result.trace["controller.current"]  # doctest: +SKIP
"""

from cosim.errors import CosimError
from cosim.loop.judge import judge
from cosim.loop.result import Result
from cosim.loop.session import Session, run
from cosim.loop.stored import read as read_trace
from cosim.scenario.load import load
from cosim.scenario.model import Scenario
from cosim.sweep.many import run_each, run_many

__all__ = [
    "CosimError",
    "Result",
    "Scenario",
    "Session",
    "judge",
    "load",
    "read_trace",
    "run",
    "run_each",
    "run_many",
]
