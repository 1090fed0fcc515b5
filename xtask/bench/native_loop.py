"""Cost of a step of the native engine, part by part; JSON for `cargo xtask bench`.

The plant alone makes the same steps with the same elements and gets the commands of the closed loop, so that
it goes through the same states. With the FMU's own calls, which get the inputs of the closed loop, it is
the minimum for any engine. MuJoCo's bare steps use the same model, without elements and measurements,
from the states and forces of the closed loop: a ball that presses costs more than one in the air. Times are
CPU time of the thread, the kinds of run take turns.
"""

from __future__ import annotations

import json
import sys
import time
from typing import Any

import mujoco
import numpy as np
from mujoco import rollout
from numpy.typing import NDArray
from part import part

import cosim
from cosim.loop import condition, native, reference
from cosim.loop.plant import starts
from cosim.loop.recorder import Recorder
from cosim.loop.wires.connections import Connections, Inputs, Slot, Stimulus
from cosim.loop.wires.transform import child
from machining_native import Stepper

KINDS = int(mujoco.mjtState.mjSTATE_FULLPHYSICS), int(mujoco.mjtState.mjSTATE_USER)
"""Position with velocity, and what is applied; MuJoCo continues from them and the start of its solver."""
PLACINGS = 5
"""Repeats of the time that it takes to place states."""


class Bench:
    """One scenario, run natively in closed loop and with the plant alone."""

    def __init__(self, session: cosim.Session) -> None:
        self.session, self.scenario = session, session.scenario
        self.fmu, self.plant = session.fmu, session.plant
        self.commands = starts(self.plant.commands)
        self.steps = self.scenario.loop.steps
        banks = self.fmu.inputs
        self.inputs = [Slot(bank.values, i, bank.base) for bank in banks for i in range(bank.values.size)]
        self.states: list[list[NDArray[np.float64]]] = []
        self.samples, self.given = self.record()
        self.placing = self.cost_of_placing()

    def reset(self) -> Any:
        """Reset the plant and return what steps it."""
        reference.reset_plant(self.plant, self.scenario, child(self.scenario.loop.seed, "plant"))
        plant: Any = self.plant
        plant.sense()
        return plant.machine()

    def initialise(self) -> tuple[Connections, Any]:
        """Initialize FMU and plant for a run; return its connections and what steps the plant."""
        plant: Any = self.plant
        links = reference.initialise(
            self.scenario, [self.fmu], self.plant, self.scenario.loop.seed, self.session.position
        )
        self.commands = links.commands
        return links, plant.machine()

    def stepper(self, machine: Any, controller: Any, links: Connections, log: Any) -> Stepper:
        """Tie a stepper to a plant that was reset."""
        loop = self.scenario.loop
        return Stepper(machine, controller, native.links(links), log, loop.step, loop.substeps)

    def closed(self) -> Stepper:
        """Tie the closed loop and its trace together, as the engine does."""
        links, machine = self.initialise()
        log = Recorder([self.fmu], self.plant, self.steps)
        if stop := self.session.stop:
            log.stop = condition.program(stop, log.table.shape[1])
        return self.stepper(machine, native.controller(self.fmu), links, log)

    def alone(self) -> Stepper:
        """Tie the plant to the commands of the closed loop; no controller, no wires, no trace."""
        return self.driven(None, [])

    def served(self) -> Stepper:
        """Tie plant and FMU to commands and inputs of the closed loop; no wires, no trace."""
        self.initialise()
        stimuli = [Stimulus(samples, slot) for samples, slot in zip(self.given, self.inputs, strict=True)]
        return self.driven(native.controller(self.fmu), stimuli)

    def driven(self, controller: Any, inputs: list[Stimulus]) -> Stepper:
        """Tie the plant to the commands of the closed loop."""
        machine = self.reset()
        stimuli = [Stimulus(samples, Slot(self.commands, i)) for i, samples in enumerate(self.samples)]
        links = Connections(
            np.zeros(len(self.plant.readings)),
            self.commands,
            [Inputs(stimuli=inputs)],
            Inputs(stimuli=stimuli),
        )
        return self.stepper(machine, controller, links, None)

    def record(self) -> tuple[list[NDArray[np.float64]], list[NDArray[np.float64]]]:
        """Commands and inputs of the closed loop, step by step; the run may end early."""
        stepper = self.closed()
        commands, inputs = [], []
        while stepper.k < self.steps:
            self.states.append(self.state())
            stop = stepper.run(stepper.k + 1)
            commands.append(self.commands.copy())
            inputs.append(np.concatenate([bank.values for bank in self.fmu.inputs]).astype(np.float64))
            if stop is not None:
                break
        self.steps = stepper.k
        return columns(commands), columns(inputs)

    def cost(self, stepper: Stepper) -> float:
        """CPU time of a step, us."""
        begin = time.thread_time()
        stepper.run(self.steps)
        return 1e6 * (time.thread_time() - begin) / stepper.k

    def state(self) -> list[NDArray[np.float64]]:
        """State of the plant, what is applied to it, and where its solver starts."""
        plant: Any = self.plant
        vectors = [np.empty(mujoco.mj_stateSize(plant.model, kind)) for kind in KINDS]
        for vector, kind in zip(vectors, KINDS, strict=True):
            mujoco.mj_getState(plant.model, plant.data, vector, kind)
        return [*vectors, plant.data.qacc_warmstart.copy()]

    def bare(self) -> float:
        """CPU time of MuJoCo's steps in one communication step, from the states of the closed loop, us."""
        return self.stepped(self.states) - self.placing

    def stepped(self, states: list[list[NDArray[np.float64]]]) -> float:
        """CPU time of MuJoCo's steps from each state and of placing and fetching it, us."""
        self.reset()
        plant: Any = self.plant
        placed, applied, start = (np.array(column) for column in zip(*states, strict=True))
        shape = len(states), self.scenario.loop.substeps
        room = np.empty((*shape, placed.shape[1])), np.empty((*shape, plant.model.nsensordata))
        begin = time.thread_time()
        rollout.rollout(
            plant.model,
            plant.data,
            placed,
            applied[:, None],
            control_spec=KINDS[1],
            nstep=shape[1],
            initial_warmstart=start,
            state=room[0],
            sensordata=room[1],
        )
        return 1e6 * (time.thread_time() - begin) / len(states)

    def cost_of_placing(self) -> float:
        """CPU time of setting and reading a state, us: its addition to the step of the plant."""
        plant: Any = self.plant
        self.reset()
        way, free = [], []
        for _ in range(self.steps):
            way.append(self.state())
            mujoco.mj_step(plant.model, plant.data, self.scenario.loop.substeps)
        for _ in range(PLACINGS):
            self.reset()
            begin = time.thread_time()
            mujoco.mj_step(plant.model, plant.data, self.steps * self.scenario.loop.substeps)
            free.append(1e6 * (time.thread_time() - begin) / self.steps)
        return min(self.stepped(way) for _ in range(PLACINGS)) - min(free)

    def once(self) -> dict[str, float]:
        """Cost of a step of each kind; those with the same commands must end in the same state."""
        plant: Any = self.plant
        costs, ends = {}, set()
        for kind, tied in (("native", self.closed), ("served", self.served), ("plant", self.alone)):
            costs[kind] = self.cost(tied())
            ends.add(plant.data.qpos.tobytes())
        assert len(ends) == 1
        return {**costs, "bare": self.bare()}


def columns(rows: list[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Numbers of each column, one after the other."""
    return [np.ascontiguousarray(column) for column in np.transpose(rows)]


def main(scenario: str, repeats: int, longest: int) -> None:
    """Run a scenario of at most `steps` steps, `repeats` times in each form."""
    with cosim.Session(part(scenario, longest), engine="native") as session:
        bench = Bench(session)
        costs = [bench.once() for _ in range(repeats)]
        runs = [session.run() for _ in range(repeats)]
    measured = {kind: [cost[kind] for cost in costs] for kind in costs[0]}
    measured["real_time_factor"] = [run.simulated_s / run.wall_s for run in runs]
    json.dump(measured, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
