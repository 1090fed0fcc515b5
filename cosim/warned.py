"""Warnings that are logged once in a process, for any number of runs and workers."""

from __future__ import annotations

import functools
import logging

log = logging.getLogger("cosim")


@functools.cache
def warn_once(text: str) -> None:
    """Log a warning, unless it was logged before."""
    log.warning("%s", text)
