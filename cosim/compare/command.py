"""Comparison of two files or folders given by name."""

from __future__ import annotations

from pathlib import Path

from cosim.compare import results, sweeps, traces
from cosim.compare.comparison import Comparison
from cosim.compare.tolerance import Tolerances
from cosim.errors import CosimError
from cosim.trace import endings, files

RESULT = ".json"
HINT = f"Give traces ({endings.listed(endings.READ)}), results (`{RESULT}`) or folders of sweeps."


def compare(reference: str, other: str, allowed: Tolerances) -> Comparison:
    """Compare two files or folders of the same kind."""
    kinds = kind_of(reference), kind_of(other)
    if kinds[0] != kinds[1]:
        raise CosimError(
            f"`{reference}` is a {kinds[0]} and `{other}` a {kinds[1]}", "Give two files of the same kind."
        )
    if allowed.dt and kinds[0] != "trace":
        raise CosimError(f"`--dt` cannot be used with a {kinds[0]}", "Use `--dt` with traces only.")
    first, second, names = Path(reference), Path(other), (reference, other)
    match kinds[0]:
        case "trace":
            return traces.compare(files.read(first), files.read(second), allowed, names)
        case "result":
            return results.compare(results.read(first), results.read(second), allowed, names)
    return sweeps.compare(sweeps.read(first), sweeps.read(second), allowed, names)


def kind_of(name: str) -> str:
    """Kind of a file or folder."""
    path = Path(name)
    if path.is_dir():
        return "sweep"
    if path.suffix in (*endings.READ, RESULT):
        if not path.is_file():
            problem = "is not a regular file" if path.exists() else "does not exist"
            raise CosimError(f"the file `{name}` {problem}", HINT)
        return "result" if path.suffix == RESULT else "trace"
    raise CosimError(f"`{name}` cannot be compared" if path.exists() else f"`{name}` does not exist", HINT)
