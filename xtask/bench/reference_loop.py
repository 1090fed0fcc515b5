"""Where one step of the reference loop spends its time; prints JSON for `cargo xtask bench`."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Callable
from typing import Any

import cosim

FMU_CALLS = ("set", "step", "get")
PLANT_CALLS = ("sense", "command", "advance", "truth")


class Stopwatch:
    """Sum of the time spent in some methods of an object, s."""

    def __init__(self, target: Any, names: tuple[str, ...]) -> None:
        self.elapsed = 0.0
        for name in names:
            setattr(target, name, self.timed(getattr(target, name)))

    def timed(self, method: Callable[..., Any]) -> Callable[..., Any]:
        """Return the method with its time taken."""

        def call(*arguments: Any) -> Any:
            begin = time.perf_counter()
            result = method(*arguments)
            self.elapsed += time.perf_counter() - begin
            return result

        return call


def main(scenario: str, repeats: int) -> None:
    """Run a scenario plainly and under stopwatches, `repeats` times each."""
    loaded = cosim.load(scenario)
    with cosim.Session(loaded) as session:
        plain = [session.run() for _ in range(repeats)]
        watches = Stopwatch(session.fmu, FMU_CALLS), Stopwatch(session.plant, PLANT_CALLS)
        parts = []
        for _ in range(repeats):
            for watch in watches:
                watch.elapsed = 0.0
            session.run()
            parts.append([watch.elapsed for watch in watches])

    steps = round(plain[0].simulated_s / loaded.loop.step)
    measured = {
        "real_time_factor": [run.simulated_s / run.wall_s for run in plain],
        "step": [1e6 * run.wall_s / steps for run in plain],
        "fmu": [1e6 * fmu / steps for fmu, _ in parts],
        "plant": [1e6 * plant / steps for _, plant in parts],
    }
    json.dump(measured, sys.stdout)


if __name__ == "__main__":
    main(sys.argv[1], int(sys.argv[2]))
