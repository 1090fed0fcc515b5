"""What a step of the native engine costs against its plant alone; JSON for `cargo xtask bench`.

The plant alone makes the same steps with the same elements and gets the commands of the closed loop, so that
it goes through the same states. Times are CPU time of the thread, the two kinds of run take turns.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import numpy as np
from numpy.typing import NDArray
from part import part

import cosim
from cosim.loop import condition, native, reference
from cosim.loop.connect import Connector, Drive, Links, Slot
from cosim.loop.trace import Recorder
from cosim.loop.wiring import child
from machining_native import Stepper


class Bench:
    """One scenario, run natively in closed loop and with the plant alone."""

    def __init__(self, session: cosim.Session) -> None:
        self.session, self.scenario = session, session.scenario
        self.fmu, self.plant = session.fmu, session.plant
        self.commands = np.zeros(len(self.plant.commands))
        self.steps = self.scenario.loop.steps
        self.courses = self.record()

    def reset(self) -> Any:
        """Reset the plant and return what steps it."""
        reference.reset_plant(self.plant, self.scenario, child(self.scenario.loop.seed, "plant"))
        plant: Any = self.plant
        return plant.machine()

    def stepper(self, machine: Any, controller: Any, links: Links, log: Any) -> Stepper:
        """Tie a stepper to a plant that was reset."""
        return Stepper(machine, controller, links, log, self.scenario.loop.step, self.scenario.loop.substeps)

    def closed(self) -> Stepper:
        """Tie the closed loop and its trace together, as the engine does."""
        self.fmu.initialise(self.scenario.controller.parameters)
        machine = self.reset()
        links = Connector(self.scenario, self.fmu, self.plant, self.commands, self.scenario.loop.seed).links()
        log = Recorder(self.fmu, self.plant, self.steps)
        if stop := self.session.stop:
            log.stop = condition.program(stop, log.table.shape[1])
        return self.stepper(machine, native.controller(self.fmu), links, log)

    def alone(self) -> Stepper:
        """Tie the plant to the commands of the closed loop; no controller, no wires, no trace."""
        machine = self.reset()
        drives = [Drive(course, Slot(self.commands, i)) for i, course in enumerate(self.courses)]
        links = Links(np.zeros(len(self.plant.readings)), self.commands, [], drives, [], [], [])
        return self.stepper(machine, None, links, None)

    def record(self) -> list[NDArray[np.float64]]:
        """Commands of the closed loop, step by step; the run may end early."""
        stepper = self.closed()
        rows = []
        while stepper.k < self.steps:
            stop = stepper.run(stepper.k + 1)
            rows.append(self.commands.copy())
            if stop is not None:
                break
        self.steps = stepper.k
        return [np.ascontiguousarray(course) for course in np.transpose(rows)]

    def cost(self, stepper: Stepper) -> float:
        """CPU time of a step, us."""
        begin = time.thread_time()
        stepper.run(self.steps)
        return 1e6 * (time.thread_time() - begin) / stepper.k

    def pair(self) -> tuple[float, float]:
        """Costs of a step in closed loop and of the plant alone, which must end in the same state."""
        plant: Any = self.plant
        closed = self.cost(self.closed())
        end = plant.data.qpos.copy()
        alone = self.cost(self.alone())
        assert plant.data.qpos.tobytes() == end.tobytes()
        return closed, alone


def main(scenario: str, repeats: int, longest: int) -> None:
    """Run a scenario of at most so many steps, `repeats` times each way."""
    with cosim.Session(part(scenario, longest), engine="native") as session:
        bench = Bench(session)
        pairs = [bench.pair() for _ in range(repeats)]
        runs = [session.run() for _ in range(repeats)]
    measured = {
        "native": [closed for closed, _ in pairs],
        "plant": [alone for _, alone in pairs],
        "real_time_factor": [run.simulated_s / run.wall_s for run in runs],
    }
    json.dump(measured, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
