"""Time series of signals: read from CSV and Parquet files and sampled at the steps."""

from __future__ import annotations

import csv
import functools
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cosim import extras, paths
from cosim.errors import CosimError, ScenarioError, closest
from cosim.scenario.checks import MAX_STEPS
from cosim.scenario.model import Scenario
from cosim.trace import csv_file
from cosim.trace.endings import PARQUET

TIME = "time"
"""Column of the time, s; otherwise the first column is the time."""
LOGICAL = {"true": 1.0, "false": 0.0}
Interpolation = Literal["hold", "linear"]


@dataclass(frozen=True)
class TimeSeries:
    """Values over time in s, which does not decrease; of values at one time the last is the right limit.

    `rows` are their lines, or rows of a Parquet file, for messages.
    """

    times: NDArray[np.float64]
    values: NDArray[np.float64]
    rows: NDArray[np.int64]
    file: Path

    def location(self, index: int) -> str:
        """Location of a value in its file."""
        what = "row" if self.file.suffix in PARQUET else "line"
        return f"`{paths.shown(self.file)}`, {what} {self.rows[index]}"


def sample(
    times: ArrayLike, values: ArrayLike, step: float, steps: int, interpolation: Interpolation = "hold"
) -> NDArray[np.float64]:
    """Value of a time series at each `k * step`, shape (steps,); the last value is held to the end.

    The times in s do not decrease, and the first is not after 0.
    """
    grid, t, known = np.arange(steps), np.asarray(times, np.float64), np.asarray(values, np.float64)
    # the first step that is not before the time, as in `first_step`
    first = np.ceil(np.clip(t / step - 1e-6, 0.0, MAX_STEPS))
    if interpolation == "hold":
        return known.take(np.searchsorted(first, grid, side="right") - 1)
    # a jump has its right limit in its own step, whatever the rounding of both times
    jumps = np.isin(t, t[1:][np.diff(t) == 0.0]) & (np.abs(t / step - first) < 1e-6)
    joined: NDArray[np.float64] = np.interp(grid * step, np.where(jumps, first * step, t), known)
    return joined


def find(name: str, folder: Path) -> Path:
    """File of a signal, relative to the folder of the scenario or to the working directory."""
    places = [base / paths.expanded(name) for base in (folder, paths.working_folder())]
    for file in places:
        if paths.is_file(file):
            return file
    problem = "is not a file" if any(map(paths.is_there, places)) else "does not exist"
    raise ScenarioError(f"the file `{paths.brief(name)}` {problem}", paths.looked_in(folder))


def files(scenario: Scenario) -> dict[str, Path]:
    """Files of the signals by their targets."""
    return {signal.to: find(signal.file, scenario.folder) for signal in scenario.signal if signal.file}


def check_apart(scenario: Scenario, option: str, file: Path) -> None:
    """Check that a run does not overwrite the file of a signal."""
    for target, read_from in files(scenario).items():
        if paths.resolved(read_from) == paths.resolved(file):
            problem = f"`{option}` `{file}` would overwrite the file of `signal.{target}`"
            raise CosimError(problem, "Choose another name.")


def read(file: Path, column: str) -> TimeSeries:
    """Read one column of a file over its time; an error names the line."""
    try:
        stat = file.stat()
        return cached(file, column, stat.st_mtime_ns, stat.st_size)
    except OSError as error:
        raise ScenarioError(f"cannot read `{paths.shown(file)}`: {error.strerror or error}") from None


@functools.lru_cache(8)
def cached(file: Path, column: str, changed: int, size: int) -> TimeSeries:
    """Read and check one column; each file is read once in a process."""
    series = read_parquet(file, column) if file.suffix in PARQUET else read_csv(file, column)
    times = series.times
    if not times.size:
        raise ScenarioError(f"`{paths.shown(file)}` has no values, only a header")
    infinite = ~(np.isfinite(times) & np.isfinite(series.values))
    falls = np.diff(times, prepend=times[0]) < 0.0
    if infinite.any():
        index, problem = int(infinite.argmax()), "time and value must be finite numbers"
    elif times[0] > 0.0:
        index, problem = 0, f"the time starts at `{times[0]:g}` s, after 0"
    elif falls.any():
        index = int(falls.argmax())
        problem = f"the time `{times[index]:g}` s is before `{times[index - 1]:g}` s, the time above it"
    else:
        return series
    raise ScenarioError(f"{series.location(index)}: {problem}")


def columns_of(names: Sequence[str], column: str, file: Path) -> tuple[int, int]:
    """Return indices of the time and of the requested column; of two columns the one that is not the time."""
    if twice := next((name for name in names if name and names.count(name) > 1), ""):
        problem = f"`{paths.shown(file)}` has two columns `{twice}`"
        raise ScenarioError(problem, "Give each column its own name.")
    time = names.index(TIME) if TIME in names else 0
    others = [name for index, name in enumerate(names) if index != time]
    if not column and len(others) == 1:
        column = others[0]
    if column not in others:
        problem = f"`{paths.shown(file)}` has no column `{column}`"
        if not column:
            columns = f"`{paths.shown(file)}` has {len(others)} columns"
            problem = f"`column` is missing; {columns} in addition to the time"
        hint = "Put the names of the columns into the first line, separated by `,`, `;` or tabs."
        raise ScenarioError(problem, closest(column, others) or hint)
    return time, names.index(column)


def read_csv(file: Path, column: str) -> TimeSeries:
    """Read a CSV file: names in the first line, numbers, `true` and `false` below."""
    numbers: list[tuple[float, float, int]] = []
    try:
        text, separator = csv_file.lines(file)
        lines = csv.reader(text, delimiter=separator)
        names = [name.strip() for name in next(lines, [])]
        places = columns_of(names, column, file)
        for cells in lines:
            if any(cell.strip() for cell in cells):
                at = f"`{paths.shown(file)}`, line {lines.line_num}"
                if len(cells) != len(names):
                    raise ScenarioError(f"{at} has {len(cells)} cells, but the first line has {len(names)}")
                time, value = (number(cells[place], at) for place in places)
                numbers.append((time, value, lines.line_num))
    except (UnicodeDecodeError, csv.Error) as error:
        raise ScenarioError(f"`{paths.shown(file)}` is not a CSV file in UTF-8: {error}") from None
    table = np.array(numbers, np.float64).reshape(-1, 3)
    return TimeSeries(table[:, 0], table[:, 1], table[:, 2].astype(np.int64), file)


def number(cell: str, at: str) -> float:
    """Read the number of a cell."""
    text = cell.strip()
    try:
        return LOGICAL[text.lower()] if text.lower() in LOGICAL else float(text)
    except ValueError:
        raise ScenarioError(f"{at}: `{text[:40]}` is not a number") from None


def read_parquet(file: Path, column: str) -> TimeSeries:
    """Read a Parquet file."""
    problem = f"`{paths.shown(file)}` needs pyarrow, which is not installed"
    parquet = extras.needed("pyarrow.parquet", problem, extras.hint("parquet"))
    try:
        opened = parquet.ParquetFile(file)
        names = list(opened.schema_arrow.names)
        time, wanted = (names[index] for index in columns_of(names, column, file))
        table = opened.read(columns=[time, wanted])
        times, values = (table[name].cast("float64", safe=False).to_numpy() for name in (time, wanted))
    except CosimError:
        raise
    except Exception as error:  # pyarrow has many
        raise ScenarioError(f"cannot read numbers from `{paths.shown(file)}`: {error}") from None
    return TimeSeries(times, values, np.arange(len(times)), file)
