"""Move over a ring of a toric lens in a closed loop: a rigid arm, a spindle at 600 rpm and a slide at 5 mm/s.

    python quick_start.py [fmu-fts.fmu]

Prints the tracking error at the end of the cut, after which the controller is in the state `Done`.
"""

import sys
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, INERTIA, FRICTION = 1e-4, 8e-4, 2e-3
IDLE, TRACK, DONE = 1, 4, 9  # numbers of the items
COLUMNS = ("time", "slide", "reference", "error", "rms", "state")


def run(fmu: str | Path) -> dict[str, np.ndarray]:
    """Run the cut until the controller is done; return the signals at every tenth step."""
    description = read_model_description(fmu)
    reference = {v.name: v.valueReference for v in description.modelVariables}
    controller = FMU2Slave(
        guid=description.guid,
        unzipDirectory=extract(fmu),
        modelIdentifier=description.coSimulation.modelIdentifier,
        instanceName="fts",
    )
    controller.instantiate()
    controller.setupExperiment(startTime=0.0)
    controller.enterInitializationMode()
    controller.setReal([reference["surface.inner_radius"]], [0.027])
    controller.exitInitializationMode()
    inputs = [reference[name] for name in ("arm_angle", "spindle_angle", "slide_position")]
    outputs = [reference[n] for n in ("torque", "reference.depth", "error.tracking", "error.rms")]
    [state, mode] = [reference["state"]], [reference["mode"]]
    random = np.random.default_rng(1999)
    angle = speed = torque = 0.0
    slide, rows, now = 0.04, [], IDLE
    for k in range(20_000):
        time = k * STEP
        controller.setReal(inputs, [angle + 1e-7 * random.standard_normal(), 62.83 * time, slide])
        controller.setInteger(mode, [TRACK])
        controller.setBoolean([reference["enable"]], [k > 100])
        controller.doStep(time, STEP)
        command, depth, error, rms = controller.getReal(outputs)
        [now] = controller.getInteger(state)
        # the torque acts one step later (`io_delay` = 1); the slide moves once the tool is on its path
        speed += STEP * (torque - FRICTION * speed) / INERTIA
        angle += STEP * speed
        slide += STEP * (0.005 if time > 0.5 else 0.0)
        torque = command
        if k % 10 == 0 or now == DONE:
            rows.append((time, slide, depth, error, rms, now))
        if now == DONE:
            break
    controller.terminate()
    controller.freeInstance()
    return dict(zip(COLUMNS, np.array(rows).T, strict=True))


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "target" / "fmu" / "fmu-fts.fmu"
    result = run(sys.argv[1] if len(sys.argv) > 1 else default)
    cut = result["rms"][result["state"] == 5]
    print(f"{'Done' if result['state'][-1] == DONE else 'not done'} after {result['time'][-1]:.3f} s")
    print(f"error of the last revolution {1e6 * cut[-1]:.3f} um rms")
