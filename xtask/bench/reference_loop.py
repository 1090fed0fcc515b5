"""Where a step of the reference loop spends its time, and what the FMU read; JSON for `cargo xtask bench`."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import Any

import fmpy
import numpy as np

import cosim
from cosim.fmu.archive import Variable
from cosim.fmu.instance import BASE
from cosim.fmu.values import expand

FMU_CALLS = ("set", "step", "get")
PLANT_CALLS = ("sense", "command", "advance", "truth")


class Stopwatch:
    """Sum of the time spent in some methods of an object, s."""

    def __init__(self, target: Any, names: tuple[str, ...]) -> None:
        self.elapsed = 0.0
        for name in names:
            setattr(target, name, self.timed(getattr(target, name)))

    def timed(self, method: Callable[..., Any]) -> Callable[..., Any]:
        """Return the method with its time taken."""

        def call(*arguments: Any) -> Any:
            begin = time.perf_counter()
            result = method(*arguments)
            self.elapsed += time.perf_counter() - begin
            return result

        return call


def recording(session: cosim.Session, result: cosim.Result) -> dict[str, Any]:
    """Everything that makes the FMU go through this run again."""
    file, trace, scenario = session.file, result.trace, session.scenario
    assert trace is not None
    reals = [v for v in file.named("input") if v.kind == "Real"]
    others = [v for v in file.named("input") if v.kind not in ("Real", "String")]
    sources = [wire.source.partition(".") for wire in scenario.wire]
    outputs = [file.variables[name] for part, _, name in sources if part == "controller"]
    return {
        "library": str(
            file.folder / "binaries" / str(fmpy.platform) / f"{file.identifier}{fmpy.sharedLibraryExtension}"
        ),
        "guid": file.guid,
        "step": scenario.loop.step,
        "start": [
            (spoken(v), float(value)) for v, value in expand(file.variables, scenario.controller.parameters)
        ],
        "inputs": [v.reference for v in reals],
        "rows": rows(trace, reals),
        "switches": [spoken(v) for v in others],
        "switched": rows(trace, others),
        "outputs": [v.reference for v in outputs if v.kind == "Real"],
        "state": file.variables["state"].reference,
        "states": dict(file.variables["state"].items),
        "visited": trace["controller.state"].astype(int).tolist(),
    }


def spoken(variable: Variable) -> dict[str, Any]:
    """Value reference and FMI's way to move the values."""
    return {"reference": variable.reference, "base": BASE[variable.kind]}


def rows(trace: Any, variables: list[Variable]) -> list[list[float]]:
    """Values of inputs, row by row."""
    columns = [trace[f"controller.{variable.name}"] for variable in variables]
    return np.transpose(columns).tolist() if columns else [[] for _ in trace]


def main(scenario: str, repeats: int) -> None:
    """Run a scenario plainly and under stopwatches, `repeats` times each."""
    loaded = cosim.load(scenario)
    with cosim.Session(loaded) as session:
        plain = [session.run() for _ in range(repeats)]
        watches = Stopwatch(session.fmu, FMU_CALLS), Stopwatch(session.plant, PLANT_CALLS)
        parts = []
        for _ in range(repeats):
            for watch in watches:
                watch.elapsed = 0.0
            session.run()
            parts.append([watch.elapsed for watch in watches])

    steps = round(plain[0].simulated_s / loaded.loop.step)
    measured = {
        "real_time_factor": [run.simulated_s / run.wall_s for run in plain],
        "step": [1e6 * run.wall_s / steps for run in plain],
        "fmu": [1e6 * fmu / steps for fmu, _ in parts],
        "plant": [1e6 * plant / steps for _, plant in parts],
        "recording": recording(session, plain[-1]),
    }
    json.dump(measured, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
