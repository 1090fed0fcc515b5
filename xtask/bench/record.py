"""Records the inputs of an FMU in a run of its closed loop, for a replay; JSON for `cargo xtask bench`."""

from __future__ import annotations

import json
import sys
from typing import Any

import fmpy
import numpy as np
from part import part

import cosim
from cosim.fmu.binding import Fmi2
from cosim.fmu.description import FmuFile, Variable
from cosim.fmu.values import Value, expand


def recording(session: cosim.Session, trace: Any) -> dict[str, Any]:
    """Everything that makes the FMU go through this run again."""
    file, scenario = session.file, session.scenario
    reals = [v for v in file.named("input") if v.kind == "Real"]
    others = [v for v in file.named("input") if v.kind not in ("Real", "String")]
    sources = [wire.source.partition(".") for wire in scenario.wire]
    outputs = [file.variables[name] for owner, _, name in sources if owner == "controller"]
    return {
        "library": library(file),
        "guid": file.guid,
        "resources": (file.folder / "resources").as_uri(),
        "step": scenario.loop.step,
        "start": [start(v, value) for v, value in expand(file.variables, scenario.controller.parameters)],
        "inputs": [v.reference for v in reals],
        "rows": rows(trace, reals),
        "switches": [spoken(v) for v in others],
        "switched": rows(trace, others),
        "outputs": [v.reference for v in outputs if v.kind == "Real"],
        "state": file.variables["state"].reference,
        "states": dict(file.variables["state"].items),
        "visited": trace["controller.state"].astype(int).tolist(),
    }


def library(file: FmuFile) -> str:
    """Path of the FMU's library for this platform."""
    name = f"{file.identifier}{fmpy.sharedLibraryExtension}"
    return str(file.folder / "binaries" / str(fmpy.platform) / name)


def start(variable: Variable, value: Value) -> tuple[dict[str, Any], str | float]:
    """Pair a variable with its start value, a text or a number."""
    return spoken(variable), value if isinstance(value, str) else float(value)


def spoken(variable: Variable) -> dict[str, Any]:
    """Value reference and FMI's way to move the values."""
    return {"reference": variable.reference, "base": Fmi2.type_of(variable)}


def rows(trace: Any, variables: list[Variable]) -> list[list[float]]:
    """Values of inputs, row by row."""
    columns = [trace[f"controller.{variable.name}"] for variable in variables]
    return np.transpose(columns).tolist() if columns else [[] for _ in trace]


def main(scenario: str, longest: int) -> None:
    """Run a scenario of at most `steps` steps."""
    with cosim.Session(part(scenario, longest), engine="native") as session:
        json.dump(recording(session, session.run().trace), sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
