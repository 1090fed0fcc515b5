"""Runs of scenarios with changes by the native engine, and what is read from their results."""

import functools
import os
from typing import Any

import cosim

Columns = Any

WORKERS = 1 if "PYTEST_XDIST_WORKER" in os.environ else None
"""Processes for a sample: only this one if the tests themselves are distributed over the cores."""


@functools.lru_cache(maxsize=16)
def run(name: str, *changes: str, seed: int | None = None) -> cosim.Result:
    """Run a scenario with changes, as `--set` takes them; the last results are kept."""
    return cosim.run(cosim.load(name, set=changes), seed, engine="native")


def trace(result: cosim.Result) -> Columns:
    """Trace of a run that kept it."""
    assert result.trace is not None
    return result.trace


def value(result: cosim.Result, metric: str) -> float:
    """Value of a metric."""
    return float(result.metrics[metric].value)
