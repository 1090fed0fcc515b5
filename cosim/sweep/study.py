"""A study as data: scenario, varied keys and limits of a run."""

from __future__ import annotations

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, Literal

from cosim import paths
from cosim.errors import ScenarioError
from cosim.scenario.kinds import check_kind
from cosim.scenario.model import Chart
from cosim.scenario.ranges import COUNT, NOT_NEGATIVE_COUNT, limited
from cosim.scenario.tables import Fail, parse
from cosim.scenario.toml import flatten, parse_file, toml_value
from cosim.study.parameters import VariedScenario, check_ranges, failing

MAX_RUNS = 1_000_000


@dataclass(frozen=True)
class Design:
    """Design of the cases.

    Parameters
    ----------
    kind
        `list` uses the tables `[[case]]` or a CSV file, the others vary the keys of `[[vary]]`.
    samples
        Number of cases of `latin-hypercube`, `sobol` and `monte-carlo`; for `saltelli`, which gives Sobol
        indices, the number of points, each with 2 cases and 1 more for each key.
    file
        CSV file of a `list`, relative to the study; its first line holds the keys.
    repeats
        Runs of each case.
    seeds
        `run`: each run has its own seed; `repeat`: the cases share the seeds of their repeats and so
        have the same noise.
    """

    kind: Literal["grid", "list", "latin-hypercube", "sobol", "monte-carlo", "saltelli"]
    samples: int | None = None
    file: str = ""
    repeats: int = limited(COUNT, 1)
    seeds: Literal["run", "repeat"] = "run"


@dataclass(frozen=True)
class Traces:
    """Stored traces: of failed runs and of the worst runs.

    Parameters
    ----------
    failed
        Maximum number of traces of failed runs.
    worst
        Number of worst runs by `metric`.
    metric
        Name of a metric of the scenario.
    direction
        Direction of the worst values.
    """

    failed: int = limited(NOT_NEGATIVE_COUNT, 10)
    worst: int = limited(NOT_NEGATIVE_COUNT, 0)
    metric: str = ""
    direction: Literal["large", "small"] = "large"


@dataclass(frozen=True, kw_only=True)
class Study(VariedScenario):
    """A study; load it with `load`.

    Parameters
    ----------
    design
        Design of the cases.
    case
        Cases of a `list`.
    traces
        Stored traces.
    charts
        Charts for `cosim report` over the runs with a result. Their columns are the keys of the cases
        and the metrics, `metric.NAME`.
    """

    design: Design
    case: tuple[dict[str, Any], ...] = ()
    traces: Traces = Traces()
    charts: tuple[Chart, ...] = ()


def load(file: Path) -> Study:
    """Load and check a study; errors name file and key."""
    fail, table = failing(file), parse_file(file)
    check_kind(table, file, "study")
    study = parse(Study, table, "", fail)
    more = read_cases(file.parent / study.design.file, fail) if study.design.file else ()
    study = replace(study, set=flatten(study.set), file=file, case=(*map(flatten, study.case), *more))
    check(study, fail)
    return study


def read_cases(file: Path, fail: Fail) -> Sequence[dict[str, Any]]:
    """Cases of a CSV file; values are TOML or texts, an empty cell is not set."""
    key, name = "design.file", f"is `{file}`"
    if not paths.is_file(file):
        fail(key, f"{name}, which {'is not a file' if paths.is_there(file) else 'does not exist'}")
    try:
        with file.open(newline="", encoding="utf-8-sig") as lines:
            header, *rows = [[cell.strip() for cell in row] for row in csv.reader(lines)] or [[]]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        fail(key, f"{name}, which cannot be read: {getattr(error, 'strerror', None) or error}")
    if not all(header) or len(set(header)) != len(header):
        fail(key, f"{name}, whose first line must hold the keys, each once")
    cases = []
    for number, row in enumerate(rows, start=2):
        if any(row) and len(row) != len(header):
            fail(key, f"{name}, whose line {number} has {len(row)} cells, not {len(header)}")
        try:
            case = {
                column: toml_value(cell, column) for column, cell in zip(header, row, strict=False) if cell
            }
        except ScenarioError as error:
            fail(key, f"{name}, in whose line {number} {error.message}", error.hint)
        if case:
            cases.append(case)
    return cases


def check(study: Study, fail: Fail) -> None:
    """Check rules beyond types."""
    design = study.design
    if study.traces.worst and not study.traces.metric:
        fail("traces.metric", "is missing", "Name the metric that selects the worst runs.")
    check_cases(study, fail) if design.kind == "list" else check_varied(study, fail)
    cases = {
        "list": len(study.case),
        "grid": math.prod(len(vary.values) or vary.points or 0 for vary in study.vary),
        "saltelli": (design.samples or 0) * (len(study.vary) + 2),
    }
    runs = cases.get(design.kind, design.samples or 0) * design.repeats
    if runs > MAX_RUNS:
        hint = "Use several studies, which can share a folder."
        fail("design", f"makes {runs} runs, more than {MAX_RUNS}", hint)


def check_cases(study: Study, fail: Fail) -> None:
    """Check a list."""
    if study.vary or study.design.samples is not None:
        fail("vary" if study.vary else "design.samples", "cannot be used with `design.kind` = `list`")
    if not study.case:
        fail("case", "is empty", "Add tables `[[case]]` or `design.file`.")
    for index, case in enumerate(study.case):
        for key in filter(study.set.__contains__, case):
            fail(f"case[{index}].{key}", "is also in `[set]`", "Set each key once.")


def check_varied(study: Study, fail: Fail) -> None:
    """Check ranges, and that the design has what it needs."""
    design = study.design
    if study.case:
        fail("case", f"cannot be used with `design.kind` = `{design.kind}`", "Use `design.kind` = `list`.")
    if not study.vary:
        fail("vary", f"is empty: `design.kind` = `{design.kind}` needs tables `[[vary]]`")
    if design.kind == "grid" and design.samples is not None:
        fail("design.samples", "cannot be used with a `grid`", "Use `points` or `values` of each `[[vary]]`.")
    if design.kind != "grid" and (design.samples is None or design.samples < 1):
        fail("design.samples", f"is `{design.samples}`, `{design.kind}` needs at least 1")
    for index, vary in enumerate(study.vary):
        if not vary.values and vary.minimum is vary.maximum is vary.mean is None:
            fail(f"vary[{index}].values", f"is empty: `{vary.key}` has neither `values` nor a range")
    check_ranges(study, design.kind, fail)
