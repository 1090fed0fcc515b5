"""Detect contact in a closed loop: `fmu-dob` with a stage of 10 kg and a surface at 100 um.

    .venv/bin/python fmu-dob/doc/quick_start.py [FMU [PLOT.svg]]

The stage is a mass with a thrust constant of 20 N/A; the surface is a spring. Prints the contact position.
"""

import sys
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, SURFACE = 1e-4, 1e-4  # s, m
DONE, FAULT = 7, 8  # numbers of the items of `State`, see variables.md


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


def plot(found: dict[str, np.ndarray], file: str) -> None:
    """Draw position, contact force and state over time."""
    import matplotlib

    matplotlib.use("svg")
    import matplotlib.pyplot as plt

    plt.rcParams.update({"svg.hashsalt": "fmu-dob", "font.size": 9.0})
    touched, entered = np.flatnonzero(found["force"] > 0.0), 1 + np.flatnonzero(np.diff(found["state"]))
    keep = np.unique(np.r_[0 : len(found["time"]) : 25, touched, entered, len(found["time"]) - 1])
    figure, axes = plt.subplots(3, 1, figsize=(7.0, 4.8), sharex=True, layout="constrained")
    for panel, name, scale, label in (
        (axes[0], "position", 1e6, "position in um"),
        (axes[1], "force", 1e3, "contact force in mN"),
        (axes[2], "state", 1.0, "state"),
    ):
        style = "steps-post" if name == "state" else "default"
        panel.plot(found["time"][keep], scale * found[name][keep], linewidth=0.9, drawstyle=style)
        panel.set_ylabel(label)
        panel.grid(alpha=0.3)
    axes[0].axhline(1e6 * SURFACE, color="gray", linestyle=":", label="surface")
    axes[0].legend(loc="center left")
    axes[2].set_yticks(range(1, 8), ["Idle", "Approach", "Learn", "Detect", "Contact", "Retract", "Done"])
    axes[2].set_xlabel("time in s")
    figure.savefig(file, metadata={"Date": None})


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "target" / "fmu" / "fmu-dob.fmu"
    result = run(sys.argv[1] if len(sys.argv) > 1 else default)
    outcome = "Done" if result["state"][-1] == DONE else "not done"
    print(f"{outcome} after {result['time'][-1]:.3f} s")
    print(f"contact at {1e6 * result['contact_position'][-1]:.3f} um, surface at {1e6 * SURFACE:.0f} um")
    print(f"maximum force {1e3 * result['force'].max():.0f} mN")
    if len(sys.argv) > 2:
        plot(result, sys.argv[2])
