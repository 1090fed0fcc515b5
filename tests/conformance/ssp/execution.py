"""Runs a loop from an SSP package in a master and prints what it found as JSON.

Arguments are MASTER SSP STEP STEPS OUTPUT..., an output is `component::variable`. A process of its own: what
Python the plant leaves in some masters ends their process at its exit.
"""

from __future__ import annotations

import json
import os
import sys
import zipfile
from typing import Any


def libcosim(file: str, step: float, steps: int, outputs: list[tuple[str, str]]) -> list[float]:
    """Run in libcosim, which takes the step from the package."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(ssp_path=file)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    assert execution.step(step_count=steps)
    assert execution.status().current_time == round(1e9 * step * steps)
    values = []
    for owner, name in outputs:
        index = execution.slave_index_from_instance_name(owner)
        known = {v.name.decode(): v.reference for v in execution.slave_variables(slave_index=index)}
        values += observer.last_real_values(slave_index=index, variable_references=[known[name]])
    return values


def ecos(file: str, step: float, steps: int, outputs: list[tuple[str, str]]) -> list[float]:
    """Run in Ecos."""
    from ecospy import EcosSimulation

    simulation = EcosSimulation(step_size=step, ssp_path=file)
    simulation.init(parameter_set="initialValues")
    simulation.step(steps)
    return [simulation.get_real(f"{owner}::{name}") for owner, name in outputs]


def fmpy(file: str, step: float, steps: int, outputs: list[tuple[str, str]]) -> list[float]:
    """Run in FMPy, which takes parameters by the names of their components, and items by numbers."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssv

    parameters: Any = read_ssv(file, "resources/controller.ssv")
    numbers = items(file)
    for parameter in parameters.parameters:
        parameter.value = numbers.get(parameter.name, {}).get(parameter.value, parameter.value)
        parameter.name = f"controller.{parameter.name}"
    rows = simulate_ssp(file, stop_time=(steps - 0.5) * step, step_size=step, parameter_set=parameters)
    assert len(rows) == steps
    # what has no connector is not recorded
    reported = {parameter.name: parameter.value for parameter in parameters.parameters}
    names = [f"{owner}.{name}" for owner, name in outputs]
    return [float(rows[name][-1] if name in rows.dtype.names else reported[name]) for name in names]


def items(file: str) -> dict[str, dict[str, str]]:
    """Numbers of the items of the enumerations of the controller, by their variables."""
    from fmpy import read_model_description

    with zipfile.ZipFile(file) as archive, archive.open("resources/controller.fmu") as fmu:
        variables = read_model_description(fmu).modelVariables
    return {
        variable.name: {item.name: item.value for item in variable.declaredType.items}
        for variable in variables
        if variable.type == "Enumeration"
    }


def main(master: str, file: str, step: str, steps: str, *outputs: str) -> None:
    """Run and print."""
    run = {"libcosim": libcosim, "Ecos": ecos, "FMPy": fmpy}[master]
    ends = [(owner, name) for owner, _, name in (output.partition("::") for output in outputs)]
    print(json.dumps(run(file, float(step), int(steps), ends)), flush=True)
    os._exit(0)


if __name__ == "__main__":
    main(*sys.argv[1:])
