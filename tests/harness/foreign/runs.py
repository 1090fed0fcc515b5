"""Simulates FMUs in a process of its own: `python runs.py`, with a task in JSON on stdin.

The task has `by` (`fmpy` or an engine of cosim) and `cases`, each with `name`, `fmu`, `scenario`, `step` (s),
`count` (steps), `inputs` and `kinds` (values and types by name), `outputs` and `out`. The `.npz` file `out`
gets the outputs: a table `run0` with a row for each step. cosim runs each scenario twice, which
adds `run1`.
"""

from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
from numpy.typing import NDArray

DTYPES = {"Real": np.float64, "Integer": np.int32, "Enumeration": np.int32, "Boolean": np.bool_}


def by_fmpy(case: dict[str, Any]) -> list[NDArray[np.float64]]:
    """Rows of the outputs after each step."""
    import fmpy

    times = [k * case["step"] for k in range(case["count"])]
    inputs = case["inputs"]
    signals = np.zeros(
        case["count"], [("time", float), *((name, DTYPES[case["kinds"][name]]) for name in inputs)]
    )
    for name, values in {"time": times, **inputs}.items():
        signals[name] = values
    found = fmpy.simulate_fmu(
        case["fmu"],
        validate=False,
        start_time=0.0,
        stop_time=case["count"] * case["step"],
        output_interval=case["step"],
        fmi_type="CoSimulation",
        input=signals,
        output=case["outputs"],
    )
    # the first row is that of the initialized FMU
    return [rows(found[1:], case["outputs"])]


def by_cosim(case: dict[str, Any], engine: Any) -> list[NDArray[np.float64]]:
    """Rows of the outputs in two runs, for which one worker reuses the FMU if it can."""
    import cosim

    found = cosim.run_many(case["scenario"], [1, 1], workers=1, keep_trace=True, engine=engine)
    assert {result.engine for result in found} == {engine}
    return [rows(result.trace, [f"controller.{name}" for name in case["outputs"]]) for result in found]


def rows(found: Any, names: list[str]) -> NDArray[np.float64]:
    """Columns of a structured array as a table."""
    return np.column_stack([found[name].astype(np.float64) for name in names])


def main() -> None:
    """Run the task."""
    task = json.load(sys.stdin)
    for case in task["cases"]:
        try:
            found = by_fmpy(case) if task["by"] == "fmpy" else by_cosim(case, task["by"])
        except Exception as error:
            found, text = [], f"{type(error).__name__}: {error}"
        else:
            text = ""
        with open(case["out"], "wb") as file:  # noqa: PTH123
            tables: dict[str, Any] = {f"run{index}": table for index, table in enumerate(found)}
            np.savez(file, error=text, **tables)


if __name__ == "__main__":
    main()
