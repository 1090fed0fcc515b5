"""Runs whose result would depend on what earlier runs left in their process.

The reset of an FMU may do nothing; a library, an interpreter or the module of a plant may hold static state.
Before the second run of an FMU and plant in a process, their first run is repeated: the bytes of both traces
must be equal.
"""

from __future__ import annotations

import contextlib
import logging
import operator
import threading
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple

from cosim import warned
from cosim.errors import FmuError

if TYPE_CHECKING:
    from cosim.fmu.description import FmuFile
    from cosim.loop.engines import Engine
    from cosim.scenario.model import Scenario

Key = tuple[str, ...]
"""Hashes of the FMU files, and the plant."""
Used = tuple[bool, bool]
"""Whether the instances of the FMUs, and the plant, have run before; otherwise they are new."""
Verdicts = dict[tuple[Key, Used], bool]
SEPARATE = "Use `cosim.run_many`, or `cosim.run` with `isolated=True`."


class FirstRun(NamedTuple):
    """The first run of an FMU and plant in this process, and what it gave: checksums or an error."""

    scenario: Scenario
    engine: Engine
    seed: int
    outcome: object


class NewProcessError(FmuError):
    """A run needs a new process, because an earlier run in this one would change its result."""

    state = False
    """Whether FMU or plant kept state; otherwise they only cannot share a process with another FMU."""

    @property
    def warning(self) -> str:
        """Warning of a caller with many runs, for whom only kept state costs time; empty without it."""
        return f"{self.message}; every run gets a new process" if self.state else ""


first_runs: dict[Key, FirstRun] = {}
verdicts: Verdicts = {}
"""Whether a repeated run had the same outcome. The verdicts of a worker process are sent to its supervisor,
and with the next tasks to the other workers."""


def key(scenario: Scenario, files: Mapping[str, FmuFile]) -> Key:
    """FMU files and plant of a scenario; plants of users may have equal names in different folders."""
    name = scenario.plant.name
    folder = str(scenario.folder) if {":", "."} & set(name) else ""
    return *(file.folder.name for file in files.values()), name, folder


def verdict(key: Key, used: Used) -> bool | None:
    """Whether runs are repeatable; None if unknown. What holds for used instances holds for new ones."""
    proofs = [mode for (proven, mode), equal in verdicts.copy().items() if equal and proven == key]
    if any(all(map(operator.ge, mode, used)) for mode in proofs):
        return True
    return verdicts.get((key, used))


def spoilt() -> bool:
    """Whether a run in this process would change later ones."""
    return any(key in first_runs and not equal for (key, _), equal in verdicts.copy().items())


@contextlib.contextmanager
def muted() -> Iterator[None]:
    """Hide what this thread logs: a repetition logs what was logged before."""
    own = threading.get_ident()

    def is_foreign(record: logging.LogRecord) -> bool:
        return record.thread != own

    loggers, seen = [logging.getLogger(name) for name in ("cosim", "cosim.fmu")], set(warned.seen)
    for one in loggers:
        one.addFilter(is_foreign)
    try:
        yield
    finally:
        for one in loggers:
            one.removeFilter(is_foreign)
        # the run that follows logs its own warnings
        with warned.lock:
            warned.seen.intersection_update(seen)
