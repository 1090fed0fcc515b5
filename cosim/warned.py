"""Warnings that are logged once in a command or a call, for any number of runs in it."""

from __future__ import annotations

import contextlib
import logging
import threading
from collections.abc import Iterator

log = logging.getLogger("cosim")
seen: set[str] = set()
"""Warnings that were logged since the first of the open blocks began."""
blocks: list[None] = []
lock = threading.Lock()


@contextlib.contextmanager
def once() -> Iterator[None]:
    """Log each warning of `warn_once` once in this block, or in the block around it."""
    with lock:
        blocks.append(None)
    try:
        yield
    finally:
        with lock:
            blocks.pop()
            if not blocks:
                seen.clear()


def warn_once(text: str) -> None:
    """Log a warning, unless it was logged in the same block; outside of all blocks, log it always."""
    with lock:
        if blocks:
            if text in seen:
                return
            seen.add(text)
    log.warning("%s", text)
