"""A sweep: the runs of a study that are not done yet, on many processes, row by row into a folder."""

from __future__ import annotations

import contextlib
import logging
import math
from collections.abc import Callable, Generator, Iterable, Iterator

from cosim.loop.result import Result
from cosim.pool.job import Finished, Numbered, Outcome
from cosim.show import plot
from cosim.sweep.overview import can_plot
from cosim.sweep.plan import Plan, Run
from cosim.sweep.store import DONE, Row, Store, row_of

log = logging.getLogger("cosim")
Pool = Callable[[Iterable[Numbered]], Generator[Finished]]
"""Runs jobs and yields their outcomes as they come: on this machine or on a cluster."""
MOST_PLOTS = 3
"""Plots of the worst runs: a plot takes longer than a run."""
Observer = Callable[[Row], None]
"""Told every new row."""


def sweep(plan: Plan, store: Store, pool: Pool, observe: Observer, again: bool = False) -> None:
    """Do the runs that have no row yet.

    Whatever stops it, Ctrl-C included, the rows written stay, and the next call goes on from there.

    Parameters
    ----------
    plan, store
        Runs, and where their rows are.
    pool
        Where they run.
    observe
        Told every new row.
    again
        Whether runs without a result (`error`, `crashed`, `timeout`, `memory`, `lost`) are done again.
    """
    for run, outcome in outcomes(plan, pending(plan, store, again), pool, keep_trace=False):
        row = row_of(run, outcome)
        store.append(row)
        observe(row)


def pending(plan: Plan, store: Store, again: bool) -> list[Run]:
    """List the runs to be done, each hash once."""
    done = DONE if again else (*DONE, "error", "crashed", "timeout", "memory", "lost")
    return list({run.hash: run for run in plan.runs if store.status(run) not in done}.values())


def outcomes(plan: Plan, runs: list[Run], pool: Pool, keep_trace: bool) -> Iterator[tuple[Run, Outcome]]:
    """Yield runs with their outcomes as they come; scenarios are built as workers ask for them."""
    by_number = {run.number: run for run in runs}
    jobs = ((run.number, plan.job(run, keep_trace)) for run in runs)
    with contextlib.closing(pool(jobs)) as done:
        for number, outcome in done:
            yield by_number[number], outcome


def save_traces(plan: Plan, store: Store, pool: Pool, plots: bool) -> None:
    """Run the failed and the worst runs again, save their traces and plot the worst; what is there stays."""
    folder = store.folder / "traces"
    drawn = worst(plan, store, plan.study.traces.worst)[:MOST_PLOTS] if plots and can_plot() else []
    chosen = {run: folder / f"{run.number:06d}-{run.hash[:8]}.npz" for run in worth_a_trace(plan, store)}
    missing = [run for run, file in chosen.items() if not file.exists()]
    if missing:
        folder.mkdir(exist_ok=True)
    for run, outcome in outcomes(plan, missing, pool, keep_trace=True):
        before = store.row(run)
        if not isinstance(outcome, Result) or before is None:
            log.warning("run %d could not be repeated for its trace: %s", run.number, outcome)
            continue
        if row_of(run, outcome)["metrics"] != before["metrics"]:
            log.warning(
                "run %d gives other numbers when it is repeated: something in it is random", run.number
            )
        # a file that is there is whole
        partial = folder / f".{chosen[run].name}"
        outcome.save_trace(partial)
        partial.replace(chosen[run])
        if run in drawn:
            plot.save(plan.job(run).scenario, outcome, chosen[run].with_suffix(".svg"))


def worth_a_trace(plan: Plan, store: Store) -> list[Run]:
    """First runs that failed, and the worst."""
    failed = [run for run in plan.runs if store.status(run) == "failed"]
    return list(
        dict.fromkeys([*failed[: plan.study.traces.failed], *worst(plan, store, plan.study.traces.worst)])
    )


def worst(plan: Plan, store: Store, count: int) -> list[Run]:
    """Worst runs by the metric of `traces`, the worst first; NaN is worse than anything."""
    traces = plan.study.traces
    if not traces.metric or not count:
        return []
    sign = 1.0 if traces.direction == "large" else -1.0
    badness = {}
    for run in plan.runs:
        row = store.row(run)
        if row is not None and row["status"] in DONE:
            value = sign * float(row["metrics"][traces.metric])
            badness[run.number] = math.inf if math.isnan(value) else value
    ranked = sorted(badness, key=lambda number: -badness[number])
    return [plan.runs[number] for number in ranked[:count]]
