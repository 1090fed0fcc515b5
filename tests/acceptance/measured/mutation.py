"""Store the results of `cargo mutants` for the table of mutants.

`python -m tests.acceptance.measured.mutation target/mutants/*` takes the folders of `cargo mutants --output`,
each named after a controller; `NAME-fresh` is a sample for which no test was written.
"""

from __future__ import annotations

import json
import sys
import tomllib
from collections.abc import Iterable
from pathlib import Path

from .store import FOLDER, HERE, Values, code, load

EQUIVALENT: dict[str, str] = tomllib.loads((HERE / "equivalent.toml").read_text("utf-8"))
"""Mutants that no test can distinguish from the controller, with the reason."""
CAUGHT = ("CaughtMutant", "Timeout")
"""An endless controller is caught, too."""


def outcomes(folder: Path) -> dict[str, str]:
    """Outcome of each mutant of a folder that compiles."""
    every = json.loads((folder / "mutants.out/outcomes.json").read_text("utf-8"))["outcomes"]
    mutants = (one for one in every if one["scenario"] != "Baseline" and one["summary"] != "Unviable")
    return {one["scenario"]["Mutant"]["name"]: one["summary"] for one in mutants}


def counted(found: dict[str, str], equivalent: Iterable[str] = EQUIVALENT) -> dict[str, float]:
    """Count the mutants and those caught; the score is the percentage caught of those not equivalent."""
    same = [name for name, outcome in found.items() if outcome not in CAUGHT and name in equivalent]
    caught = [outcome for outcome in found.values() if outcome in CAUGHT]
    return {
        "tried": len(found),
        "caught": len(caught),
        "endless": caught.count("Timeout"),
        "equivalent": len(same),
        "score": round(100 * len(caught) / (len(found) - len(same)), 1),
    }


def row(folder: Path) -> Values:
    """Row of a controller, with its fresh sample."""
    fresh = counted(outcomes(folder.with_name(f"{folder.name}-fresh")))
    second = {f"fresh_{name}": value for name, value in fresh.items()}
    return {"code": code(), **counted(outcomes(folder)), **second}


def keep(folders: list[Path]) -> None:
    """Store the rows of these folders."""
    file = FOLDER / "mutation.json"
    rows = load("mutation") if file.is_file() else {}
    rows |= {folder.name: row(folder) for folder in folders if not folder.name.endswith("-fresh")}
    file.write_text(json.dumps(rows, indent=1, sort_keys=True) + "\n", "utf-8")


if __name__ == "__main__":
    keep([Path(word) for word in sys.argv[1:]])
