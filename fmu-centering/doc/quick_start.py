"""Centers a ring on a turning spindle: `fmu-centering` in a closed loop with a plant of a few lines.

    python quick_start.py [fmu-centering.fmu]

The table turns at 20 rpm. The slide is a position servo with a lag. The ring stays where it was pushed.
"""

import sys
from math import asin, cos, sin, sqrt, tau
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

RADIUS, AT_PUSHER, GAP = 0.05, 0.02, 0.05  # m: ring, probe deflection at contact, pusher to a centered ring
SPEED, LAG, STEP = tau / 3, 4e-3, 1e-3  # rad/s, s, s


def run(path: str | Path) -> dict[str, np.ndarray]:
    """Run until the ring is centered: time (s), eccentricity, its estimate and slide (m), state, fault."""
    description = read_model_description(str(path))
    vr = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=extract(str(path)), instanceName="centering",
                    modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.setReal([vr["ring.radius"], vr["approach.travel_max"]], [RADIUS, 0.04])
    fmu.exitInitializationMode()
    inputs = [vr["spindle_angle"], vr["slide_position"], vr["probe_position"]]
    outputs = [vr["slide.position_setpoint"], vr["slide.velocity_setpoint"], vr["eccentricity"]]
    flags, noise, rows = [vr["state"], vr["fault"]], np.random.default_rng(1), []
    center, slide, command = 4e-4 + 3e-4j, 0.0, (0.0, 0.0)  # ring center on the table (complex), m
    for k in range(30_000):
        world = center * complex(cos(SPEED * k * STEP), sin(SPEED * k * STEP))  # as the slide sees it
        surface = world.real + sqrt(RADIUS**2 - world.imag**2)
        probe = max(0.0, AT_PUSHER - (RADIUS + GAP - slide - surface))
        measured = max(0.0, probe + noise.normal(0.0, 3e-8)) if probe > 0 else 0.0
        fmu.setReal(inputs, [SPEED * k * STEP, slide, measured])
        fmu.setBoolean([vr["enable"]], [k >= 10])  # a rising edge starts the cycle
        fmu.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
        slide += STEP * (command[1] + (command[0] - slide) / LAG)  # the last command: `io_delay` is 1
        push = probe - AT_PUSHER
        if push > 0:  # the pusher overlaps the ring: the ring moves away along its normal
            tilt = asin(world.imag / RADIUS)
            center -= push / cos(tilt) * complex(cos(tilt), -sin(tilt)) * (center / world)
        *command, estimate = fmu.getReal(outputs)
        state, fault = fmu.getInteger(flags)
        rows.append((k * STEP, abs(center), estimate, slide, state, fault))
        if state in (10, 11):  # Centered, Fault
            break
    fmu.terminate()
    fmu.freeInstance()
    names = ("time", "eccentricity", "estimate", "slide", "state", "fault")
    return dict(zip(names, np.array(rows).T, strict=True))


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "target/fmu/fmu-centering.fmu"
    found = run(sys.argv[1] if len(sys.argv) > 1 else default)
    print(f"state {found['state'][-1]:.0f} (Centered is 10), fault {found['fault'][-1]:.0f} (None is 1), "
          f"{found['time'][-1]:.2f} s, eccentricity {1e6 * found['eccentricity'][-1]:.2f} um")  # fmt: skip
