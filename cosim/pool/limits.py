"""Limits of a run, and resources of this machine."""

from __future__ import annotations

import contextlib
import math
import os
from dataclasses import dataclass
from pathlib import Path

from cosim.errors import CosimError

MAX_MEMORY = 1e18
"""Maximum memory limit in bytes, which fits into 64 bits."""
CGROUPS = Path("/sys/fs/cgroup")
MEMBERSHIP = Path("/proc/self/cgroup")


@dataclass(frozen=True)
class Limits:
    """Limits of one run.

    Parameters
    ----------
    timeout
        Maximum wall time in s; None for no limit.
    memory
        Maximum memory of the worker process in bytes, with about 80 MB before the run; None for no limit.
    process_per_run
        Whether every run has a separate process.
    keys
        Names of timeout and memory for the user.

    Raises
    ------
    CosimError
        An invalid limit.
    """

    timeout: float | None = None
    memory: float | None = None
    process_per_run: bool = False
    keys: tuple[str, str] = ("limits.timeout", "limits.memory")

    def __post_init__(self) -> None:
        if self.timeout is not None and not 0.0 < self.timeout < math.inf:
            raise CosimError(f"`{self.keys[0]}` = `{self.timeout:g}` must be positive and finite")
        if self.memory is not None and not 0.0 < self.memory <= MAX_MEMORY:
            given = f"`{self.keys[1]}` = `{self.memory / 1e6:g}`"
            raise CosimError(f"{given} must be positive and at most {MAX_MEMORY / 1e6:g}, in MB")


def processors() -> int:
    """Available processors according to affinity and control-group quota."""
    affinity = getattr(os, "sched_getaffinity", None)
    count = len(affinity(0)) if affinity else os.cpu_count() or 1
    return max(1, math.ceil(min(count, quota())))


def quota(root: Path = CGROUPS, membership: Path = MEMBERSHIP) -> float:
    """Processors of the control-group quota; infinite without a limit."""
    groups = {Path("/")}
    with contextlib.suppress(OSError):
        for line in membership.read_text().splitlines():
            group = Path(line.split(":", 2)[-1])
            groups |= {group, *group.parents}
    quotas = [math.inf]
    for group in groups:
        # the quota of a group without a limit is `max`, which is no number
        with contextlib.suppress(OSError, ValueError):
            most, period = (root / group.relative_to("/") / "cpu.max").read_text().split()
            quotas.append(int(most) / int(period))
    return min(quotas)
