"""Polish in a closed loop: `fmu-polish` with three integrating axes and a mold that is a spring.

    python quick_start.py [fmu-polish.fmu]

The axes move as commanded. The mold is a plane through the path with 178 N/mm and a friction of 0.2.
Prints force and sliding speed.
"""

import sys
from pathlib import Path

import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave

STEP, STIFFNESS, FRICTION = 1e-3, 178e3, 0.2  # s, N/m, 1
IDEAL = {
    "drive.feedforward": 1.0,
    "expert.drive.feedforward_bandwidth": 1e5,
    "drive.velocity_bandwidth": 1e5,
    "sensor.bandwidth": 1e6,
}
FOLLOW, DONE, FAULT = 4, 7, 8  # numbers of the items of `State`


def run(fmu: str | Path) -> dict[str, np.ndarray]:
    """Run one cycle until `Done`.

    Time (s), contact force (N), distance from the path (m), sliding speed (m/s), state.
    """
    description = read_model_description(str(fmu))
    vr = {variable.name: variable.valueReference for variable in description.modelVariables}
    controller = FMU2Slave(guid=description.guid, unzipDirectory=extract(str(fmu)), instanceName="polish",
                           modelIdentifier=description.coSimulation.modelIdentifier)  # fmt: skip
    controller.instantiate()
    controller.setupExperiment(startTime=0.0)
    controller.enterInitializationMode()
    controller.setReal([vr[name] for name in IDEAL], list(IDEAL.values()))  # axes and sensor have no lag
    controller.setReal([vr["feed.velocity"]], [4e-3])
    controller.exitInitializationMode()

    def vector(name: str, set_to: np.ndarray | None = None) -> np.ndarray:
        references = [vr[f"{name}.{axis}"] for axis in "xyz"]
        if set_to is not None:
            controller.setReal(references, set_to.tolist())
        return np.array(controller.getReal(references))

    noise, rows = np.random.default_rng(1), []
    position, velocity, force = np.zeros(3), np.zeros(3), np.zeros(3)
    for k in range(30_000):
        vector("position", 1e-6 * np.round(position / 1e-6))  # encoders of 1 um
        vector("force", force + 0.05 * noise.standard_normal(3))
        controller.setBoolean([vr["enable"]], [k > 10])  # a rising edge starts the cycle
        controller.doStep(k * STEP, STEP)
        path, normal = vector("desired"), vector("normal")
        if k == 0:
            position = path + 0.2e-3 * normal  # the tool starts 0.2 mm above the path
        position = position + STEP * velocity  # the command of the step before: `io_delay` is 1
        velocity = vector("velocity")
        sliding = velocity - normal * (normal @ velocity)
        press = STIFFNESS * max(0.0, normal @ (path - position))
        force = press * (normal - FRICTION * sliding / max(1e-6, float(np.linalg.norm(sliding))))
        across = np.cross(normal, vector("tangent")) @ (position - path)
        [speed], [state] = controller.getReal([vr["sliding.speed"]]), controller.getInteger([vr["state"]])
        rows.append((k * STEP, press, across, speed, state))
        if state in (DONE, FAULT):
            break
    controller.terminate()
    controller.freeInstance()
    return dict(zip(("time", "force", "across", "sliding", "state"), np.array(rows).T, strict=True))


if __name__ == "__main__":
    default = Path(__file__).parents[2] / "target" / "fmu" / "fmu-polish.fmu"
    result = run(sys.argv[1] if len(sys.argv) > 1 else default)
    outcome = "Done" if result["state"][-1] == DONE else "not done"
    force = result["force"][result["state"] == FOLLOW]
    print(f"{outcome} after {result['time'][-1]:.2f} s, force {force.mean():.2f} N +- {force.std():.2f} N, "
          f"sliding speed {1e3 * result['sliding'].max():.1f} mm/s")  # fmt: skip
