"""Runs the bundled path without and with patterns: `fmu-deburr` in a closed loop with six integrating axes.

    python quick_start.py [fmu-deburr.fmu]

Each axis integrates its velocity command with a lag of 3.7 ms, one sample after the command.
Nothing is cut.
"""

import sys
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, LAG, FINE = 0.01, 2 * 0.52 / 280, 50  # s, s (nominal drive), steps of the plant in a sample
DRY_RUN, PLAYBACK, DONE, FAULT = 2, 4, 7, 8


def run(path: str | Path) -> dict[str, np.ndarray]:
    """Run until the second `Done`.

    Time (s), mode, state, fault, feed (m/s), control errors of axes 1 to 3 (rad, m, m).
    """
    description = read_model_description(str(path))
    vr = {variable.name: variable.valueReference for variable in description.modelVariables}
    fmu = FMU2Slave(guid=description.guid, unzipDirectory=extract(str(path)), instanceName="deburring",
                    modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    fmu.instantiate()
    fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.setString([vr["bank.import"]], ["bank.bin"])
    fmu.exitInitializationMode()
    pulses = np.array(fmu.getReal([vr[f"axis{n}.pulse"] for n in range(1, 7)]))
    positions = [vr[f"axis{n}.position"] for n in range(1, 7)]
    outputs = (
        [vr[f"axis{n}.velocity"] for n in range(1, 7)]
        + [vr["path.speed"]]
        + [vr[f"axis{n}.error"] for n in (1, 2, 3)]
    )
    place, speed, command, rows = np.array([-0.1, 0.02, 0.7, 0.0, 0.0, 0.0]), np.zeros(6), np.zeros(6), []
    mode = DRY_RUN
    for k in range(3000):
        fmu.setReal(positions, list(np.floor(place / pulses) * pulses))  # encoders count whole pulses
        fmu.setBoolean([vr["enable"]], [True])
        fmu.setInteger([vr["mode"]], [mode])
        fmu.doStep(currentCommunicationPoint=k * STEP, communicationStepSize=STEP)
        for _ in range(FINE):
            speed += STEP / FINE / LAG * (command - speed)  # the command of the step before: `io_delay` is 1
            place = place + STEP / FINE * speed
        found = fmu.getReal(outputs)
        command = np.array(found[:6])
        state, fault = fmu.getInteger([vr["state"], vr["fault"]])
        rows.append((k * STEP, mode, state, fault, *found[6:]))
        if state == FAULT or (state == DONE and mode == PLAYBACK):
            break
        if state == DONE:
            mode = PLAYBACK  # a task starts when the mode changes
    fmu.terminate()
    fmu.freeInstance()
    names = ("time", "mode", "state", "fault", "feed", "error1", "error2", "error3")
    return dict(zip(names, np.array(rows).T, strict=True))


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "target/fmu/fmu-deburr.fmu"
    found = run(sys.argv[1] if len(sys.argv) > 1 else default)
    runs = {mode: (found["mode"] == mode) & (found["state"] == 5) for mode in (DRY_RUN, PLAYBACK)}
    largest = [1e3 * np.abs(found["error3"][rows]).max() for rows in runs.values()]
    print(f"state {found['state'][-1]:.0f} (Done is 7), fault {found['fault'][-1]:.0f} (None is 1)")
    print(f"error of axis 3: {largest[0]:.3f} mm without patterns, {largest[1]:.3f} mm with patterns")
