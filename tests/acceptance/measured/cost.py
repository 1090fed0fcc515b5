"""Store the results of `cargo xtask bench` for the tables of cost.

`python -m tests.acceptance.measured.cost`, once the bench is done.
"""

from __future__ import annotations

import json

from .store import FOLDER, ROOT, Values, code

BENCH = ROOT / "target/bench/bench.json"
ONCE = {
    "pass-through": {
        "ratio": "Rust pass-through / C FMU with checks",
        "own": "set + doStep + get: Rust pass-through",
        "other": "set + doStep + get: C FMU with the checks of FMI 2.0",
    },
    "reference": {"ratio": "dob: simulated time / wall time"},
    "sweep": {"ratio": "2 x rate of one core alone / rate of the sweep"},
    "start": {"help": "processor time of `cosim --help`", "list": "processor time of `cosim list`"},
    "isolation": {
        "run": "`cosim run --in-process` of next to no simulated time",
        "isolated": "  the same in a process of its own",
    },
    "planning": {"time": "plan of a large study: time", "megabytes": "  memory of its process"},
    "memory": {"megabytes": "memory of all its processes", "ratio": "  / that of a fifth of the runs"},
}
"""Quantities of the bench for each value of a row."""
SAMPLE = ": one sample in its busiest state, "
STEP = {
    "engine": "one step of the native engine",
    "plant": "one step of the plant alone, same commands",
    "over_plant": "native engine / plant alone",
    "over_bare": "native engine / MuJoCo's bare steps",
}
PARTS = ("  of which the calls of the FMU: plant with them / plant alone",
         "  of which the engine: native engine / plant with the calls of the FMU")  # fmt: skip
LOOPS = ("dob", "fts", "centering", "polish", "deburr")


def rows(bench: list[dict[str, float | str]]) -> dict[str, dict[str, Values]]:
    """Make rows of both tables from those of the bench: the minimum of the runs.

    Rows that compare two quantities follow the rows of their loop.
    """
    names, minimum = [str(row["quantity"]) for row in bench], [float(row["minimum"]) for row in bench]
    found = dict(zip(names, minimum, strict=True))
    cost: dict[str, dict[str, float]] = {
        name: {value: found[quantity] for value, quantity in values.items()} for name, values in ONCE.items()
    }
    isolation = cost["isolation"]
    isolation["added"] = 1e3 * (isolation["isolated"] - isolation["run"])
    loops: dict[str, dict[str, float]] = {}
    for loop in LOOPS:
        cost[f"{loop}: a sample"] = {
            "time": next(found[one] for one in names if one.startswith(f"{loop}{SAMPLE}"))
        }
        loops[loop] = {name: found[f"{loop}: {quantity}"] for name, quantity in STEP.items()}
        below = names.index(f"{loop}: {STEP['over_plant']}")
        loops[loop] |= {
            name: minimum[names.index(part, below)]
            for name, part in zip(("calls", "rest"), PARTS, strict=True)
        }
    stamp = code()
    return {
        table: {name: {"code": stamp, **rounded(values)} for name, values in of.items()}
        for table, of in {"cost": cost, "cost-loops": loops}.items()
    }


def rounded(values: dict[str, float]) -> dict[str, float]:
    """Values with three digits; more is noise of the machine."""
    return {name: float(f"{value:.3g}") for name, value in values.items()}


if __name__ == "__main__":
    for table, kept in rows(json.loads(BENCH.read_text("utf-8"))).items():
        (FOLDER / f"{table}.json").write_text(json.dumps(kept, indent=1, sort_keys=True) + "\n", "utf-8")
