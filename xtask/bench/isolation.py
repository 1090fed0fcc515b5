"""Wall time of `cosim run` in a supervised process and without one, for next to no simulated time; JSON."""

from __future__ import annotations

import json
import subprocess
import sys
import time

RUN = ["-m", "cosim", "run", "dob", "--set", "loop.duration=0.001"]
COMMANDS = {"isolated": RUN, "in_process": [*RUN, "--in-process"]}


def took(arguments: list[str]) -> float:
    """Wall time of a run that ends before its criteria can hold, s."""
    begin = time.perf_counter()
    done = subprocess.run([sys.executable, *arguments], capture_output=True, text=True)
    assert done.returncode == 1, done.stderr
    return time.perf_counter() - begin


def main(repeats: int) -> None:
    """Run both in turns and print what each took, every time."""
    rounds = [{name: took(arguments) for name, arguments in COMMANDS.items()} for _ in range(repeats)]
    json.dump({name: [found[name] for found in rounds] for name in COMMANDS}, sys.stdout)


if __name__ == "__main__":
    main(int(sys.argv[1]))
