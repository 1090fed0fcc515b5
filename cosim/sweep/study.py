"""A study as data: one scenario, what is varied, and what a run may take."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, NoReturn

from cosim import paths
from cosim.errors import ScenarioError
from cosim.scenario.ranges import COUNT, FINITE, NOT_NAN, NOT_NEGATIVE_COUNT, POSITIVE, limited
from cosim.scenario.schema import schema_of
from cosim.scenario.tables import parse
from cosim.scenario.toml import flatten, parse_file, toml_value

MOST_RUNS = 1_000_000
"""More runs than any sweep has time for."""


@dataclass(frozen=True)
class Vary:
    """One key and the values it takes: `values`, or a range with its distribution.

    Parameters
    ----------
    key
        Key of the scenario, as for `--set`.
    values
        Values; drawn with equal probability where the design is no grid.
    minimum, maximum
        Ends of the range; of `normal` where it is cut off.
    points
        Number of values of the range in a grid, both ends included.
    distribution
        Between the ends; in a grid `log-uniform` is a geometric series.
    mean, deviation
        Of the distribution `normal`, before it is cut off.
    integer
        Whether only integers are taken.
    """

    key: str
    values: tuple[Any, ...] = ()
    minimum: float | None = limited(NOT_NAN, None)
    maximum: float | None = limited(NOT_NAN, None)
    points: int | None = None
    distribution: Literal["uniform", "log-uniform", "normal"] = "uniform"
    mean: float | None = limited(FINITE, None)
    deviation: float | None = limited(POSITIVE, None)
    integer: bool = False

    @property
    def range(self) -> tuple[float, float]:
        """Both ends, infinite where not given."""
        low = -math.inf if self.minimum is None else self.minimum
        return low, math.inf if self.maximum is None else self.maximum


@dataclass(frozen=True)
class Design:
    """How the cases are made.

    Parameters
    ----------
    kind
        `list` takes the tables `[[case]]` or a CSV file, the others vary the keys of `[[vary]]`.
    samples
        Number of cases of `latin-hypercube`, `sobol` and `monte-carlo`; of `saltelli`, whose cases give Sobol
        indices, the number of points, each of which makes 2 cases and 1 for each key.
    file
        CSV file of a `list`, beside the study; its first line holds the keys.
    repeats
        Runs of each case.
    seeds
        `run`: each run has its own seed; `repeat`: the cases share the seeds of their repeats, so that they
        meet the same noise.
    """

    kind: Literal["grid", "list", "latin-hypercube", "sobol", "monte-carlo", "saltelli"]
    samples: int | None = None
    file: str = ""
    repeats: int = limited(COUNT, 1)
    seeds: Literal["run", "repeat"] = "run"


@dataclass(frozen=True)
class RunLimits:
    """What one run may take: wall time in s, memory of its process in MB; and whether that is its own."""

    timeout: float = limited(POSITIVE, 600.0)
    memory: float | None = limited(POSITIVE, None)
    process_per_run: bool = False


@dataclass(frozen=True)
class Traces:
    """Which traces are kept: of runs that failed criteria (at most so many), and of the worst.

    Parameters
    ----------
    failed
        Most traces of runs that do not hold their criteria.
    worst
        Number of worst runs by `metric`.
    metric
        Name of a metric of the scenario.
    direction
        Which values of it are bad.
    """

    failed: int = limited(NOT_NEGATIVE_COUNT, 10)
    worst: int = limited(NOT_NEGATIVE_COUNT, 0)
    metric: str = ""
    direction: Literal["large", "small"] = "large"


@dataclass(frozen=True)
class Study:
    """A study; load it with `load`."""

    scenario: str
    design: Design
    title: str = ""
    description: str = ""
    seed: int = limited(NOT_NEGATIVE_COUNT, 1)
    set: dict[str, Any] = field(default_factory=dict)
    vary: tuple[Vary, ...] = ()
    case: tuple[dict[str, Any], ...] = ()
    limits: RunLimits = RunLimits()
    traces: Traces = Traces()
    file: Path = field(default=Path(), metadata={"key": ""})

    @property
    def name(self) -> str:
        """Stem of the file."""
        return self.file.stem


def load(file: Path) -> Study:
    """Load and check a study.

    Raises
    ------
    ScenarioError
        Missing or broken file, unknown key, wrong type, contradictory values; names file and key.
    """
    origin = f"`{paths.shown(file)}`"
    table = parse_file(file)

    def fail(key: str, problem: str, hint: str = "") -> NoReturn:
        raise ScenarioError(f"{origin}: `{key}` {problem}", hint)

    study = parse(Study, table, "", fail)
    study = replace(study, set=flatten(study.set), file=file)
    if study.design.file:
        study = replace(study, case=(*study.case, *read_cases(file.parent / study.design.file, fail)))
    else:
        study = replace(study, case=tuple(flatten(case) for case in study.case))
    check(study, fail)
    return study


def study_schema() -> dict[str, Any]:
    """JSON schema of a study file."""
    return schema_of(Study, "Study of cosim")


def read_cases(file: Path, fail: Any) -> Sequence[dict[str, Any]]:
    """Cases of a CSV file; values are TOML, what is not TOML is a text, an empty cell is not set."""
    try:
        with file.open(newline="", encoding="utf-8-sig") as lines:
            header, *rows = list(csv.reader(lines)) or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        fail("design.file", f"is `{file}`, which cannot be read: {getattr(error, 'strerror', None) or error}")
    header = [name.strip() for name in header]
    if not all(header) or len(set(header)) != len(header):
        fail("design.file", f"is `{file}`, whose first line must hold the keys, each once")
    cases = []
    for number, row in enumerate(rows, start=2):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != len(header):
            fail("design.file", f"is `{file}`, whose line {number} has {len(row)} cells, not {len(header)}")
        pairs = zip(header, (cell.strip() for cell in row), strict=True)
        try:
            cases.append({key: toml_value(cell, key) for key, cell in pairs if cell})
        except ScenarioError as error:
            fail("design.file", f"is `{file}`, in whose line {number} {error.message}", error.hint)
    return cases


def check(study: Study, fail: Any) -> None:
    """Check what types cannot say."""
    design = study.design
    if study.traces.worst and not study.traces.metric:
        fail("traces.metric", "is missing", "it tells which runs are the worst")
    check_cases(study, fail) if design.kind == "list" else check_varied(study, fail)
    runs = count(study) * design.repeats
    if runs > MOST_RUNS:
        fail("design", f"makes {runs} runs, more than {MOST_RUNS}", "several studies may share a folder")


def count(study: Study) -> int:
    """Count the cases."""
    match study.design.kind:
        case "list":
            return len(study.case)
        case "grid":
            return math.prod(len(vary.values) or vary.points or 0 for vary in study.vary)
        case "saltelli":
            return (study.design.samples or 0) * (len(study.vary) + 2)
    return study.design.samples or 0


def check_cases(study: Study, fail: Any) -> None:
    """Check a list."""
    if study.vary or study.design.samples is not None:
        fail("vary" if study.vary else "design.samples", "does not go with `design.kind` = `list`")
    if not study.case:
        fail("case", "is empty: the study has no cases", "give it tables `[[case]]` or `design.file`")
    for index, case in enumerate(study.case):
        for key in case:
            if key in study.set:
                fail(f"case[{index}].{key}", "is in `[set]`, too", "a key has one place")


def check_varied(study: Study, fail: Any) -> None:
    """Check ranges, and that the design has what it needs."""
    design = study.design
    if study.case:
        fail("case", f"does not go with `design.kind` = `{design.kind}`", "that is a `list`")
    if not study.vary:
        fail("vary", f"is empty: `design.kind` = `{design.kind}` needs tables `[[vary]]`")
    if design.kind == "grid" and design.samples is not None:
        fail("design.samples", "does not go with a `grid`", "use `points` or `values` of each `[[vary]]`")
    if design.kind != "grid" and (design.samples is None or design.samples < 1):
        fail("design.samples", f"is `{design.samples}`, `{design.kind}` needs at least 1")
    seen = set(study.set)
    for index, vary in enumerate(study.vary):
        key = f"vary[{index}]"
        if vary.key in seen:
            fail(f"{key}.key", f"= `{vary.key}` is there twice", "a key has one place")
        seen.add(vary.key)
        if vary.values or any(getattr(vary, name) is not None for name in ("minimum", "maximum", "mean")):
            check_values(vary, key, design.kind, fail)
        else:
            fail(f"{key}.values", f"is empty: `{vary.key}` has neither `values` nor a range")


def check_values(vary: Vary, key: str, kind: str, fail: Any) -> None:
    """Check that values, range and distribution of one key agree."""
    given = [
        name
        for name in ("minimum", "maximum", "points", "mean", "deviation")
        if getattr(vary, name) is not None
    ]
    if vary.values:
        if given or vary.distribution != "uniform" or vary.integer:
            also = (given or ["distribution" if vary.distribution != "uniform" else "integer"])[0]
            fail(f"{key}.{also}", "does not go with `values`", "values or a range, not both")
        return
    low, high = vary.range
    if not low < high:
        fail(f"{key}.maximum", f"is `{high}`, it must be above `minimum` = `{low}`")
    normal = vary.distribution == "normal"
    if normal != (vary.mean is not None and vary.deviation is not None):
        fail(
            f"{key}.distribution",
            f"is `{vary.distribution}`; `mean` and `deviation` belong to `normal`, both of them",
        )
    if not normal and not (math.isfinite(low) and math.isfinite(high)):
        fail(f"{key}", f"needs `minimum` and `maximum` of `{vary.key}`, both finite")
    if vary.distribution == "log-uniform" and low <= 0.0:
        fail(f"{key}.minimum", f"is `{low}`, a logarithmic range starts above 0")
    if vary.integer and any(math.isfinite(end) and not end.is_integer() for end in (low, high)):
        fail(f"{key}.integer", f"is true, but `{low}` .. `{high}` does not end at integers")
    if (kind == "grid") != (vary.points is not None):
        fail(f"{key}.points", "belongs to a range in a `grid`, and only there")
    if vary.points is not None and (vary.points < 2 or normal):
        fail(f"{key}.points", f"is `{vary.points}`, a grid takes at least 2 points of an even range")
