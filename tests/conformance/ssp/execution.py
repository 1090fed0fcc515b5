"""Runs a loop from an SSP package in a master and prints as JSON what it found: `MASTER SSP STEPS`.

A process of its own: what Python the plant leaves in some masters ends their process at its exit.
"""

from __future__ import annotations

import json
import os
import sys
from typing import Any

STEP = 1e-4
OUTPUTS = [("controller", "contact_position"), ("plant", "plant.depth_max"), ("controller", "learn.time")]


def libcosim(file: str, steps: int) -> list[float]:
    """Run in libcosim, which takes the step from the package."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver

    log_output_level(CosimLogLevel.ERROR)
    execution = CosimExecution.from_ssp_file(ssp_path=file)
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer=observer)
    assert execution.step(step_count=steps)
    assert execution.status().current_time == round(1e9 * STEP * steps)
    values = []
    for owner, name in OUTPUTS:
        index = execution.slave_index_from_instance_name(owner)
        known = {v.name.decode(): v.reference for v in execution.slave_variables(slave_index=index)}
        values += observer.last_real_values(slave_index=index, variable_references=[known[name]])
    return values


def ecos(file: str, steps: int) -> list[float]:
    """Run in Ecos."""
    from ecospy import EcosSimulation

    simulation = EcosSimulation(step_size=STEP, ssp_path=file)
    simulation.init(parameter_set="initialValues")
    simulation.step(steps)
    return [simulation.get_real(f"{owner}::{name}") for owner, name in OUTPUTS]


def fmpy(file: str, steps: int) -> list[float]:
    """Run in FMPy, which is told the parameters by the names of their components."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import read_ssv

    parameters: Any = read_ssv(file, "resources/controller.ssv")
    for parameter in parameters.parameters:
        parameter.name = f"controller.{parameter.name}"
    learn = {parameter.name: parameter.value for parameter in parameters.parameters}["controller.learn.time"]
    stop = (steps - 0.5) * STEP
    rows = simulate_ssp(file, stop_time=stop, step_size=STEP, parameter_set=parameters)
    assert len(rows) == steps
    return [*(float(rows[f"{owner}.{name}"][-1]) for owner, name in OUTPUTS[:2]), float(learn)]


def main(master: str, file: str, steps: str) -> None:
    """Run and print."""
    run = {"libcosim": libcosim, "Ecos": ecos, "FMPy": fmpy}[master]
    print(json.dumps(run(file, int(steps))), flush=True)
    os._exit(0)


if __name__ == "__main__":
    main(*sys.argv[1:])
