"""Results of a sweep on disk: one line of JSON for each run, written as it ends, found again by its hash."""

from __future__ import annotations

import contextlib
import json
import logging
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.loop.result import Result, plain
from cosim.metrics.criteria import Verdict
from cosim.pool.job import Outcome
from cosim.sweep.plan import Run

log = logging.getLogger("cosim")
FILE = "results.jsonl"
Row = dict[str, Any]
"""One line: run, case, seed, status, reason, what was set, metrics, criteria, times, hash."""
DONE = ("passed", "failed")
"""Statuses of runs that gave a result; the others are `error`, `crashed`, `timeout`, `memory` and `lost`."""


class Store(Closing):
    """The file `results.jsonl` of a folder, open for more rows; only their places are held in memory.

    Raises
    ------
    CosimError
        The folder cannot be written, or another sweep writes to it.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.places: dict[str, tuple[int, str]] = {}
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self.file = (folder / FILE).open("a+b")
        except OSError as error:
            shown = paths.shown(folder)
            raise CosimError(f"cannot write results to `{shown}`: {error.strerror or error}") from None
        try:
            self.lock()
            self.scan()
        except CosimError:
            self.file.close()
            raise

    def lock(self) -> None:
        """Take the file for this process; the lock ends with it."""
        try:
            import fcntl
        except ImportError:  # this system has no such locks
            return
        try:
            fcntl.flock(self.file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            shown = paths.shown(self.folder)
            raise CosimError(
                f"another sweep writes to `{shown}`", "wait for it, or choose another `--out`"
            ) from None

    def scan(self) -> None:
        """Find the rows that are there; a last line that was cut off is removed."""
        self.file.seek(0)
        place = 0
        for line in self.file:
            if not line.endswith(b"\n"):
                log.warning("`%s` ended in the middle of a row, that run is done again", FILE)
                self.file.truncate(place)
                break
            self.note(line, place)
            place += len(line)
        self.end = place

    def note(self, line: bytes, place: int) -> None:
        """Remember the place of a row; what is no row is passed over."""
        try:
            row = json.loads(line)
            self.places[str(row["hash"])] = (place, str(row["status"]))
        except (ValueError, KeyError, TypeError):
            log.warning("`%s` has a line that is no row, that run is done again", FILE)

    def append(self, row: Row) -> None:
        """Write one row; it is in the file when this returns."""
        line = json.dumps(row, allow_nan=False).encode() + b"\n"
        try:
            self.file.write(line)
            self.file.flush()
        except OSError as error:
            raise CosimError(f"cannot write `{self.folder / FILE}`: {error.strerror or error}") from None
        self.places[row["hash"]] = (self.end, row["status"])
        self.end += len(line)

    def status(self, run: Run) -> str:
        """Status of a run; empty if it has no row."""
        return self.places.get(run.hash, (0, ""))[1]

    def row(self, run: Run) -> Row | None:
        """Row of a run, with the number it has in this study."""
        if run.hash not in self.places:
            return None
        self.file.seek(self.places[run.hash][0])
        row: Row = json.loads(self.file.readline())
        return {**row, "run": run.number, "case": run.case}

    def close(self) -> None:
        """Close the file."""
        with contextlib.suppress(OSError):
            self.file.close()


def row_of(run: Run, outcome: Outcome) -> Row:
    """Row of a run and its outcome."""
    row: Row = {"run": run.number, "case": run.case, "seed": run.seed, "set": run.changes, "hash": run.hash}
    if isinstance(outcome, Result):
        return {
            **row,
            "status": "passed" if outcome.passed else "failed",
            "reason": failed(outcome.criteria),
            "metrics": {metric.name: plain(metric.value) for metric in outcome.metrics.values()},
            "units": {metric.name: metric.unit for metric in outcome.metrics.values()},
            "criteria": {verdict.criterion.id: verdict.passed for verdict in outcome.criteria},
            "engine": outcome.engine,
            "simulated_s": outcome.simulated_s,
            "wall_s": outcome.wall_s,
        }
    return {
        **row,
        "status": getattr(outcome, "status", "error"),
        "reason": outcome.message,
        "hint": outcome.hint,
    }


def failed(verdicts: list[Verdict]) -> str:
    """Criteria that do not hold, as text."""
    return ", ".join(verdict.criterion.id for verdict in verdicts if not verdict.passed)
