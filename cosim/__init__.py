"""Co-simulation of FMUs with plants: scenarios, the reference engine, results and criteria.

>>> import cosim
>>> result = cosim.run(cosim.load("dob", set=["plant.gap=2e-4"]), seed=7)  # doctest: +SKIP
>>> result.passed, result.metrics["depth"].value, result.trace["controller.current"]  # doctest: +SKIP

Importing this package is cheap; the first name that needs numpy or FMPy imports them.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cosim.errors import CosimError
    from cosim.loop.evaluate import evaluate
    from cosim.loop.result import Result
    from cosim.loop.session import Session
    from cosim.optimize.results import OptimizeResult, optimize
    from cosim.pool.limits import Limits
    from cosim.pool.runs import run, run_each, run_many
    from cosim.scenario.load import load
    from cosim.scenario.model import Scenario
    from cosim.sweep.results import SweepResult, sweep
    from cosim.trace.files import read as read_trace

__all__ = [
    "CosimError", "Limits", "OptimizeResult", "Result", "Scenario", "Session", "SweepResult", "evaluate",
    "load", "optimize", "read_trace", "run", "run_each", "run_many", "sweep",
]  # fmt: skip

LOCATIONS = {
    "CosimError": "cosim.errors.CosimError",
    "Limits": "cosim.pool.limits.Limits",
    "OptimizeResult": "cosim.optimize.results.OptimizeResult",
    "Result": "cosim.loop.result.Result",
    "Scenario": "cosim.scenario.model.Scenario",
    "Session": "cosim.loop.session.Session",
    "SweepResult": "cosim.sweep.results.SweepResult",
    "evaluate": "cosim.loop.evaluate.evaluate",
    "load": "cosim.scenario.load.load",
    "optimize": "cosim.optimize.results.optimize",
    "read_trace": "cosim.trace.files.read",
    "run": "cosim.pool.runs.run",
    "run_each": "cosim.pool.runs.run_each",
    "run_many": "cosim.pool.runs.run_many",
    "sweep": "cosim.sweep.results.sweep",
}
"""Where each public name is defined."""
for package in ("optimize", "sweep"):
    # the first import of a package sets its name here, which belongs to a function
    import_module(f"{__name__}.{package}")
    globals().pop(package, None)
del package
RENAMED = {"judge": "evaluate"}
"""Public names of version 0.1 and their replacements."""


def __getattr__(name: str) -> Any:
    """Import a public name on first use."""
    if name in RENAMED:
        raise AttributeError(f"`cosim.{name}` was renamed in 0.2.0: use `cosim.{RENAMED[name]}`")
    if name not in LOCATIONS:
        raise AttributeError(f"module `{__name__}` has no attribute `{name}`")
    module, _, there = LOCATIONS[name].rpartition(".")
    value = getattr(import_module(module), there)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    """Public names, imported or not."""
    return sorted({*globals(), *__all__})
