"""Detect contact in a closed loop: `fmu-dob` with a stage of 10 kg and a surface at 100 um.

    python quick_start.py [fmu-dob.fmu]

The stage is a mass with a thrust constant of 20 N/A; the surface is a spring. Prints the contact position.
"""

import sys
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, SURFACE = 1e-4, 1e-4  # s, m
DONE, FAULT = 7, 8  # numbers of the items of `State`


def run(fmu: str | Path) -> dict[str, np.ndarray]:
    """Run one approach until `Done`; time, position, contact force, current, contact position, state."""
    description = read_model_description(str(fmu))
    vr = {variable.name: variable.valueReference for variable in description.modelVariables}
    controller = FMU2Slave(guid=description.guid, unzipDirectory=extract(str(fmu)), instanceName="dob",
                           modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    controller.instantiate()
    controller.setupExperiment(startTime=0.0)
    controller.enterInitializationMode()
    controller.exitInitializationMode()
    noise, rows = np.random.default_rng(1), []
    position = speed = current = 0.0
    for k in range(30_000):
        measured = 1e-9 * round((position + 0.5e-9 * noise.standard_normal()) / 1e-9)  # encoder of 1 nm
        controller.setReal([vr["position"]], [measured])
        controller.setBoolean([vr["enable"]], [k > 100])  # a rising edge starts the approach
        controller.doStep(k * STEP, STEP)
        force = 4e5 * max(0.0, position - SURFACE)
        speed += STEP * (20.0 * current - force) / 10.0  # the command of the step before: `io_delay` is 1
        position += STEP * speed
        current, contact = controller.getReal([vr["current"], vr["contact_position"]])
        [state] = controller.getInteger([vr["state"]])
        rows.append((k * STEP, position, force, current, contact, state))
        if state in (DONE, FAULT):
            break
    controller.terminate()
    controller.freeInstance()
    names = ("time", "position", "force", "current", "contact_position", "state")
    return dict(zip(names, np.array(rows).T, strict=True))


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "target" / "fmu" / "fmu-dob.fmu"
    result = run(sys.argv[1] if len(sys.argv) > 1 else default)
    outcome = "Done" if result["state"][-1] == DONE else "not done"
    print(f"{outcome} after {result['time'][-1]:.3f} s")
    print(f"contact at {1e6 * result['contact_position'][-1]:.3f} um, surface at {1e6 * SURFACE:.0f} um")
    print(f"maximum force {1e3 * result['force'].max():.0f} mN")
