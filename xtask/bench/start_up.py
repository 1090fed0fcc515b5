"""Processor time of `cosim --help` and `cosim list` over that of a Python that does nothing; JSON."""

from __future__ import annotations

import json
import resource
import subprocess
import sys

COMMANDS = {"nothing": ["-c", "pass"], "help": ["-m", "cosim", "--help"], "list": ["-m", "cosim", "list"]}


def spent(arguments: list[str]) -> float:
    """Processor time of a Python process with its children, s."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *arguments], stdout=subprocess.DEVNULL, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main(repeats: int) -> None:
    """Run the commands in turns and print what each took, every time."""
    rounds = [{name: spent(arguments) for name, arguments in COMMANDS.items()} for _ in range(repeats)]
    json.dump({name: [found[name] for found in rounds] for name in COMMANDS}, sys.stdout)


if __name__ == "__main__":
    main(int(sys.argv[1]))
