"""Where a step of the reference loop spends its time; JSON for `cargo xtask bench`."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import Any

from part import part

import cosim

FMU_CALLS = ("compute",)
PLANT_CALLS = ("sense", "command", "advance", "truth")


class Stopwatch:
    """Sum of the time spent in some methods of an object, s, while it is worn."""

    def __init__(self, target: Any, names: tuple[str, ...]) -> None:
        self.target, self.names = target, names
        self.elapsed = 0.0

    def __enter__(self) -> Stopwatch:
        self.elapsed = 0.0
        for name in self.names:
            setattr(self.target, name, self.timed(getattr(self.target, name)))
        return self

    def __exit__(self, *_: object) -> None:
        # the methods of the class are restored
        for name in self.names:
            delattr(self.target, name)

    def timed(self, method: Callable[..., Any]) -> Callable[..., Any]:
        """Return the method with its time taken."""

        def call(*arguments: Any) -> Any:
            begin = time.perf_counter()
            result = method(*arguments)
            self.elapsed += time.perf_counter() - begin
            return result

        return call


def turn(session: cosim.Session) -> dict[str, float]:
    """Run once plainly, for the real-time factor, and once under stopwatches; times in us per step."""
    plain = session.run()
    with Stopwatch(session.fmu, FMU_CALLS) as fmu, Stopwatch(session.plant, PLANT_CALLS) as plant:
        watched = session.run()
    step = 1e6 * session.scenario.loop.step / watched.simulated_s
    return {
        "real_time_factor": plain.simulated_s / plain.wall_s,
        "step": step * watched.wall_s,
        "fmu": step * fmu.elapsed,
        "plant": step * plant.elapsed,
        "rest": step * (watched.wall_s - fmu.elapsed - plant.elapsed),
    }


def main(scenario: str, repeats: int, longest: int) -> None:
    """Run a scenario of at most `steps` steps, `repeats` times in each form."""
    with cosim.Session(part(scenario, longest), engine="reference") as session:
        # the second run in a process first repeats the first run; keep that out of the measurement
        session.run()
        turns = [turn(session) for _ in range(repeats)]
    json.dump({name: [turn[name] for turn in turns] for name in turns[0]}, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3]))
