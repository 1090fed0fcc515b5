"""How many processes this one may keep busy."""

from __future__ import annotations

import os


def available() -> int:
    """Count the cores that this process may use; a batch system may leave it fewer than there are."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1
