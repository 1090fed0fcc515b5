"""Result of a run: trace, metrics, verdicts, and its JSON form."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from cosim.errors import CosimError
from cosim.extras import PROJECT, version
from cosim.fmu.description import DisplayUnit
from cosim.formatting import html, strict
from cosim.formatting.frame import dataframe
from cosim.formatting.strict import plain
from cosim.formatting.verdicts import STATUSES, counted
from cosim.metrics.criteria import Measured, Verdict
from cosim.trace import files
from cosim.trace.columns import Columns, Held
from cosim.trace.stored import LABELS
from cosim.units import beyond_si
from cosim.writing import write


@dataclass(frozen=True, repr=False)
class Result:
    """Result of one run.

    Parameters
    ----------
    scenario
        Name of the scenario, for example `dob/paper`.
    trace
        Structured array, one row per communication step; fields `time`, `controller.<name>`, `plant.<truth>`.
        None if it was not kept (`run_many`) or was written to a file.
    file
        Parquet file to which the run wrote the trace.
    units
        Unit of every column of the trace.
    items
        Names and numbers of the columns that are enumerations.
    descriptions
        Descriptions of the columns; empty if there is none.
    displays
        Display units of the columns that have one; the trace is in `units`.
    metrics
        Value and unit of every metric, by name.
    criteria
        Verdicts in the order of the scenario.
    simulated_s, wall_s
        Simulated time and time taken by the loop, s.
    fmus
        GUIDs of the FMUs by their names.
    injected
        Start time of each injection of the scenario, s; None if it did not start.
    """

    scenario: str
    title: str
    seed: int
    engine: str
    metrics: dict[str, Measured] = field(default_factory=dict)
    criteria: list[Verdict] = field(default_factory=list)
    simulated_s: float = 0.0
    wall_s: float = 0.0
    trace: NDArray[Any] | None = None
    file: Path | None = None
    units: dict[str, str] = field(default_factory=dict)
    items: dict[str, dict[str, int]] = field(default_factory=dict)
    descriptions: dict[str, str] = field(default_factory=dict)
    displays: dict[str, DisplayUnit] = field(default_factory=dict)
    fmus: dict[str, str] = field(default_factory=dict)
    injected: tuple[float | None, ...] = ()

    @property
    def loop(self) -> str:
        """Name of the closed loop, without the variant."""
        return self.scenario.partition("/")[0]

    @property
    def passed(self) -> bool | None:
        """Whether all criteria passed; None if there are no criteria."""
        if not self.criteria:
            return None
        return all(verdict.passed for verdict in self.criteria)

    def __repr__(self) -> str:
        """One line: scenario, verdict, seed, size of the trace or its file."""
        rows = "no trace" if self.trace is None else f"{len(self.trace)} x {len(self.units)} trace"
        rows = f"trace in `{self.file}`" if self.file else rows
        return f"<Result of {self.scenario}: {counted(self.criteria)}, seed {self.seed}, {rows}>"

    def _repr_html_(self) -> str:
        """Tables for a notebook."""
        line = f"{counted(self.criteria)}; seed {self.seed}, {self.simulated_s:g} s simulated"
        return html.run(f"{self.scenario}: {self.title}", line, self.metrics, self.criteria)

    def to_dataframe(self) -> Any:
        """Return the trace as a `pandas.DataFrame`, with the units in `attrs["units"]`.

        Raises
        ------
        CosimError
            pandas is not installed, or the result holds no trace.
        """
        return dataframe(self.columns, self.units)

    @property
    def columns(self) -> Columns:
        """Columns of the trace by name; columns in a file are read on access.

        Raises
        ------
        CosimError
            The trace was not kept.
        """
        if self.trace is not None:
            return Held(self.trace)
        if self.file is not None:
            return files.open_trace(self.file).data
        raise CosimError("this result holds no trace", "Use `run`, or `run_many` with `keep_trace=True`.")

    def to_dict(self) -> dict[str, Any]:
        """Return the result without the trace, in the order and names of the JSON file."""
        return {
            "loop": self.loop,
            "scenario": self.scenario,
            "seed": self.seed,
            "engine": self.engine,
            "metrics": {m.name: {"value": plain(m.value), "unit": m.unit} for m in self.metrics.values()},
            "criteria": [criterion(verdict) for verdict in self.criteria],
            "status": STATUSES[self.passed],
            "passed": self.passed,
            "simulated_s": self.simulated_s,
            "wall_s": self.wall_s,
        }

    def to_json(self) -> str:
        """Return the result as strict JSON."""
        return strict.text(self.to_dict())

    def save_json(self, path: str | Path) -> None:
        """Write the JSON file."""
        write(self.to_json(), Path(path))

    def save_trace(self, path: str | Path) -> None:
        """Write the trace in the format of the ending: `.npz`, `.csv`, `.parquet` or `.mat`."""
        files.save(self.columns, Path(path), self.about())

    def about(self) -> dict[str, Any]:
        """Return the metadata of a saved trace; equal runs give identical bytes."""
        run = ("scenario", "title", "seed", "engine", "fmus", "simulated_s")
        facts = {name: getattr(self, name) for name in (*run, *LABELS)}
        return {"cosim": version(PROJECT), **facts, **beyond_si(self.units.values())}


def criterion(verdict: Verdict) -> dict[str, Any]:
    """One criterion as in the JSON file; `limit` is text such as `<= 4.5e-07` or `= true`."""
    limits = [(relation, bool(limit) if verdict.logical else limit) for relation, limit in verdict.limits]
    return {
        "id": verdict.criterion.id,
        "claim": verdict.criterion.claim,
        "paper": verdict.criterion.paper,
        "value": bool(verdict.value) if verdict.logical else plain(verdict.value),
        "limit": " and ".join(f"{relation} {json.dumps(limit)}" for relation, limit in limits),
        "unit": verdict.unit,
        "passed": verdict.passed,
    }
