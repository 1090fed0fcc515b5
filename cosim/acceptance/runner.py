"""Run scenarios on all cores; an error in one does not stop the others."""

from __future__ import annotations

import contextlib
import glob
import itertools
import re
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.acceptance.job import RecordedJob
from cosim.errors import CosimError
from cosim.fmu import stale
from cosim.loop.engines import Engine
from cosim.loop.result import Result
from cosim.pool import executor
from cosim.pool.job import Job, Outcome
from cosim.pool.limits import Limits, processors
from cosim.scenario.load import load
from cosim.show import display
from cosim.show.bar import bar
from cosim.writing import check_text, naming

Outcomes = Mapping[str, Outcome]
"""Outcome of each scenario by name, in the requested order."""
DRAWN = re.compile(rb"\s*<\?xml.*<dc:creator>\s*<cc:Agent>\s*<dc:title>cosim</dc:title>", re.DOTALL)
KINDS = {
    ".json": ("the result of a run", re.compile(rb'\{\s*"loop":')),
    ".svg": ("the plot of a run", DRAWN),
}
"""Files written for each scenario, and the start of such files."""

Change = Callable[[str, RecordedJob], RecordedJob]
"""Replaces the task of a scenario, given by name."""


class StoppedError(KeyboardInterrupt):
    """Ctrl-C, with the outcomes until then."""

    def __init__(self, outcomes: Outcomes) -> None:
        super().__init__()
        self.outcomes = outcomes


@dataclass(frozen=True)
class RunOptions:
    """How scenarios are run."""

    folder: Path | None = None
    """Folder of `NAME.json` and `NAME.svg`; None writes nothing."""
    plots: bool = True
    workers: int | None = None
    """Number of worker processes; None is one for each available processor."""
    engine: Engine = "native"
    limits: Limits | None = None
    quiet: bool = False


def run(scenarios: Sequence[str], options: RunOptions, change: Change | None = None) -> Outcomes:
    """Run scenarios given by name or file, each once with its own seed; `change` replaces their tasks.

    Raises CosimError if two files have one name, the folder cannot be written or holds a file of another
    kind, or no worker can be started; StoppedError after Ctrl-C.
    """
    names: dict[str, str] = {}
    for given in scenarios:
        name = paths.scenario_name(Path(given)) if given.endswith(".toml") else given
        if name in names:
            problem = f"`{given}` and another file both define the scenario `{name}`"
            raise CosimError(problem, "Test them in separate commands.")
        names[name] = given
    files = {name: places(options.folder, name) for name in names}
    for file in itertools.chain.from_iterable(files.values()):
        with naming(file):
            file.unlink(missing_ok=True)  # what an earlier run left there
    jobs: dict[str, RecordedJob] = {}
    found: dict[str, Outcome] = dict.fromkeys(names, CosimError("interrupted before its end"))
    for name, given in names.items():
        try:
            made = job(given, files[name], options)
            jobs[name] = change(name, made) if change else made
        except CosimError as error:
            found[name] = error
    with progress(len(names), options.quiet) as report:
        for name in found:
            if name not in jobs:
                report(name, found[name])
        try:
            for name, outcome in outcomes(jobs, options):
                found[name] = outcome
                report(name, outcome)
        except KeyboardInterrupt:
            # the worker processes were killed, possibly while they wrote
            for file in itertools.chain.from_iterable(files.values()):
                for part in file.parent.glob(f".{glob.escape(file.stem)}.*.partial{file.suffix}"):
                    part.unlink(missing_ok=True)
            raise StoppedError(found) from None
    return found


def outcomes(jobs: Mapping[str, Job], options: RunOptions) -> Iterator[tuple[str, Outcome]]:
    """Outcomes by name, in order of completion."""
    names = list(jobs)
    workers = min(options.workers or processors(), len(jobs))
    pool = executor.outcomes(enumerate(jobs.values()), workers, options.limits or Limits())
    with contextlib.closing(pool):
        for number, outcome in pool:
            yield names[number], outcome


def job(given: str, files: tuple[Path, ...], options: RunOptions) -> RecordedJob:
    """Job of a scenario."""
    scenario = load(given)
    stale.warn_of(scenario.fmus, scenario.folder)
    json, plot = files or (None, None)
    plot = plot if options.plots else None
    keep_trace = plot is not None
    return RecordedJob(scenario, scenario.loop.seed, options.engine, keep_trace, json=json, plot=plot)


def places(folder: Path | None, name: str) -> tuple[Path, ...]:
    """Files of a scenario's results. Makes their folder; rejects existing files of another kind."""
    if folder is None:
        return ()
    files = tuple(folder / f"{name}{ending}" for ending in KINDS)
    for file in files:
        with naming(file):
            file.parent.mkdir(parents=True, exist_ok=True)
        check_text("--out", file, *KINDS[file.suffix])
    return files


def plain(outcomes: Outcomes) -> list[dict[str, Any]]:
    """Results as plain data for JSON, in their order; an error message for each failed run."""
    return [
        ({} if isinstance(outcome, Result) else {"scenario": name, "passed": False}) | outcome.to_dict()
        for name, outcome in outcomes.items()
    ]


@contextlib.contextmanager
def progress(count: int, quiet: bool) -> Iterator[Callable[[str, Outcome], None]]:
    """Report each completed scenario in a line on stderr, above a progress bar on a terminal."""
    from rich.progress import MofNCompleteColumn

    with bar(quiet, MofNCompleteColumn()) as shown:
        task: Any = None if shown is None else shown.add_task("scenarios", total=count)

        def report(name: str, outcome: Outcome) -> None:
            words = display.summary(outcome).plain if isinstance(outcome, Result) else "could not run"
            if shown is not None:
                shown.console.print(f"{name}: {words}")
                shown.advance(task)
            elif not quiet:
                print(f"{name}: {words}", file=sys.stderr, flush=True)

        yield report
