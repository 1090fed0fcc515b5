"""Results of a sweep on disk: one line of JSON for each run, written at its end, identified by its hash."""

from __future__ import annotations

import contextlib
import errno
import json
import logging
import math
import os
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal, NoReturn

from cosim import paths
from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.formatting.strict import plain
from cosim.formatting.verdicts import STATUSES
from cosim.loop.result import Result
from cosim.metrics.criteria import Measured, Verdict, evaluate
from cosim.pool.job import Outcome
from cosim.scenario.model import Criterion
from cosim.scenario.tables import parse
from cosim.study.run import Run
from cosim.units import beyond_si, restored
from cosim.writing import naming, write

log = logging.getLogger("cosim")
FILE = "results.jsonl"
ORIGIN = "study.txt"
"""File with the path of the study, relative to the folder of its results."""
Row = dict[str, Any]
"""One line: run, case, seed, status, reason, settings, metrics, criteria, times, hash."""
DONE = tuple(STATUSES.values())
"""Statuses of runs that gave a result."""
TROUBLES = ("error", "crashed", "timeout", "memory")
"""Statuses of runs without result."""
Number = float | Literal["NaN", "Infinity", "-Infinity"]


@dataclass(frozen=True)
class RowSchema:
    """Fields of a row; `metrics` and all following fields belong to runs with a result."""

    run: int
    case: int
    seed: int
    set: dict[str, Any]
    hash: str
    status: Literal["passed", "failed", "done", "error", "crashed", "timeout", "memory"]
    reason: str
    hint: str = ""
    metrics: dict[str, Number] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    definitions: dict[str, Any] = field(default_factory=dict)
    criteria: dict[str, bool] = field(default_factory=dict)
    engine: str = ""
    simulated_s: float | None = None
    wall_s: float | None = None


class Store(Closing):
    """The locked file `results.jsonl` of a folder; only the positions of its rows are in memory."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.shown = paths.shown(folder / FILE)
        self.positions: dict[str, tuple[int, str]] = {}
        if paths.is_there(folder / FILE) and not paths.is_file(folder / FILE):
            raise CosimError(f"cannot write results: `{self.shown}` is not a file", "Choose another `--out`.")
        try:
            folder.mkdir(parents=True, exist_ok=True)
            # without a buffer: what could not be written is not tried again
            self.file = (folder / FILE).open("ab", buffering=0)
            self.reader = (folder / FILE).open("rb")
        except OSError as error:
            shown = paths.shown(folder)
            raise CosimError(f"cannot write results to `{shown}`: {error.strerror or error}") from None
        try:
            self.lock()
            self.scan()
        except CosimError:
            self.close()
            raise

    def lock(self) -> None:
        """Lock the file for this process, if its file system has locks."""
        try:
            import fcntl

            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except ImportError:  # this system has no such locks
            pass
        except OSError as error:
            shown = paths.shown(self.folder)
            if error.errno not in (errno.EWOULDBLOCK, errno.EAGAIN):
                text = "cannot lock `%s` (%s): start no other sweep in it until this one ends"
                log.warning(text, shown, error.strerror or error)
                return
            problem = f"another sweep writes to `{shown}`"
            raise CosimError(problem, "Wait for it, or choose another `--out`.") from None

    def scan(self) -> None:
        """Index the existing rows; nothing is removed, and an incomplete last line is terminated."""
        position, line = 0, b"\n"
        for number, line in enumerate(self.reader, 1):
            try:
                row = read(line)
                self.positions[row["hash"]] = (position, row["status"])
            except (ValueError, RecursionError) as error:
                text = (
                    "`%s`, line %d is not a row (%s): it is kept, and a run without another row is repeated"
                )
                log.warning(text, self.shown, number, error)
            position += len(line)
        if not line.endswith(b"\n"):
            self.write(b"\n")

    def append(self, row: Row) -> None:
        """Write one row; it is in the file when this returns."""
        line = strict.line(row).encode() + b"\n"
        self.positions[row["hash"]] = (self.write(line), row["status"])

    def write(self, line: bytes) -> int:
        """Append to the file, all or nothing; return the position."""
        with naming(self.shown, "Run the same command again to continue; existing rows are kept."):
            position = self.file.seek(0, os.SEEK_END)
            try:
                if self.file.write(line) != len(line):
                    raise OSError(errno.ENOSPC, "no space left for a complete row")
            except OSError:
                with contextlib.suppress(OSError):
                    self.file.truncate(position)
                raise
        return position

    def status(self, name: str) -> str:
        """Status of the run with a hash; empty without a row."""
        return self.positions.get(name, (0, ""))[1]

    def stored(self, name: str) -> Row | None:
        """Row with a hash as it was written."""
        if name not in self.positions:
            return None
        self.reader.seek(self.positions[name][0])
        return json.loads(self.reader.readline())  # type: ignore[no-any-return]

    def row(self, run: Run, criteria: Sequence[Criterion]) -> Row | None:
        """Row of a run, with the number and the values it has in this study, evaluated by some criteria."""
        stored = self.stored(run.hash)
        return stored and evaluated({**stored, **described(run)}, criteria)

    def refresh(self, run: Run, criteria: Sequence[Criterion]) -> None:
        """Write the row of a run again if other criteria change its verdicts."""
        stored, row = self.stored(run.hash), self.row(run, criteria)
        if stored and row and stored.get("criteria") != row.get("criteria"):
            self.append(row)

    def close(self) -> None:
        """Close the file."""
        self.reader.close()
        with contextlib.suppress(OSError):
            self.file.close()


def opened(study: Path, out: str | Path | None, otherwise: str) -> Store:
    """Store of a study in the requested folder, or in the default one, which is that of one study."""
    # an empty name would be the working directory
    if out == "":
        raise CosimError("`--out` is empty", "Use `--out .` for the working directory.")
    folder = Path(otherwise if out is None else out)
    other = study_of(folder)
    if out is None and other is not None and other.is_file() and not other.samefile(study):
        problem = f"`{paths.shown(folder)}` holds the results of `{paths.shown(other)}`"
        raise CosimError(f"{problem}, not of `{paths.shown(study)}`", "Choose another folder with `--out`.")
    store, path = Store(folder), paths.resolved(study)
    # valid when both are moved, except on different drives
    with contextlib.suppress(ValueError):
        path = Path(os.path.relpath(path, paths.resolved(folder)))
    write(f"{path.as_posix()}\n", folder / ORIGIN)
    return store


def existing(folder: Path) -> Store:
    """Store of a folder that holds a sweep."""
    if not paths.is_file(folder / FILE):
        problem = f"`{paths.shown(folder)}` is not the folder of a sweep: it has no `{FILE}`"
        raise CosimError(problem, "Name the folders of `cosim sweep --part`.")
    return Store(folder)


def study_of(folder: Path) -> Path | None:
    """Study of a folder of results; None if it is not known."""
    with contextlib.suppress(OSError, ValueError):
        return folder / (folder / ORIGIN).read_text(encoding="utf-8").strip()
    return None


def read(line: bytes) -> Row:
    """Row of a line; a `ValueError` if it is none, or contradicts itself."""
    row: Any = json.loads(line)

    def fail(key: str, problem: str, hint: str) -> NoReturn:
        raise ValueError(f"`{key}` {problem}")

    if not isinstance(row, dict):
        raise ValueError("it is not an object")
    shape = parse(RowSchema, row, "", fail)
    if shape.status in TROUBLES:
        return row
    if shape.status != status_of(shape.criteria.values()):
        raise ValueError(f"`status` is `{shape.status}`, which contradicts its `criteria`")
    if shape.units.keys() != shape.metrics.keys() or shape.simulated_s is None or shape.wall_s is None:
        raise ValueError("`units` of its `metrics`, `simulated_s` or `wall_s` are missing")
    return row


def status_of(held: Collection[bool]) -> str:
    """Status of a run with a result, from its criteria."""
    return STATUSES[all(held) if held else None]


def described(run: Run) -> Row:
    """Part of a row that is known before the run."""
    changes = {key: plain(value) for key, value in run.changes.items()}
    return {"run": run.number, "case": run.case, "seed": run.seed, "set": changes, "hash": run.hash}


def row_of(run: Run, outcome: Outcome, criteria: Sequence[Criterion] = ()) -> Row:
    """Row of a run and its outcome, evaluated by some criteria."""
    row = described(run)
    if not isinstance(outcome, Result):
        return {**row, "status": outcome.status, "reason": outcome.message, "hint": outcome.hint}
    metrics = outcome.metrics.values()
    row |= {"status": "done", "reason": ""}
    row["metrics"] = {metric.name: plain(metric.value) for metric in metrics}
    row["units"] = {metric.name: metric.unit for metric in metrics}
    row["criteria"] = {}
    row |= {name: getattr(outcome, name) for name in ("engine", "simulated_s", "wall_s")}
    return evaluated(row | beyond_si(metric.unit for metric in metrics), criteria)


def evaluated(row: Row, criteria: Sequence[Criterion]) -> Row:
    """Row with status, reason and verdicts by some criteria; unchanged without a result."""
    if row["status"] in TROUBLES:
        return row
    held = {verdict.criterion.id: verdict.passed for verdict in verdicts(row, criteria)}
    reason = ", ".join(name for name, passed in held.items() if not passed)
    return {**row, "status": status_of(held.values()), "reason": reason, "criteria": held}


def verdicts(row: Row, criteria: Sequence[Criterion]) -> list[Verdict]:
    """Verdicts of a row with a result; a metric that it lacks is NaN."""
    units = restored(row["units"], row.get("definitions", {}))
    measured = {
        name: Measured(name, float(row["metrics"].get(name, math.nan)), units.get(name, ""))
        for name in {criterion.metric for criterion in criteria}
    }
    return evaluate(tuple(criteria), measured)
