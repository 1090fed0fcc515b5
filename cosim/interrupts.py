"""Handling of Ctrl-C that is never lost, whatever the process does."""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

INTERRUPTED = 130
"""Exit code of a process that Ctrl-C ended."""
SHOW_CURSOR = b"\r\x1b[2K\x1b[?25h"
"""Clears the line of a progress bar and restores the cursor."""
Handler = Callable[..., Any]


def quit_at_once(*_: object) -> NoReturn:
    """End the process without unwinding: no exception can be lost in an import or a callback of C."""
    os.write(2, (SHOW_CURSOR if os.isatty(2) else b"") + b"error: interrupted\n")
    os._exit(INTERRUPTED)


@contextlib.contextmanager
def handled_by(handler: Handler) -> Iterator[None]:
    """Let `handler` handle Ctrl-C, unless it is ignored or this is not the main thread."""
    before = current()
    if before is None:
        yield
        return
    signal.signal(signal.SIGINT, handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def current() -> Handler | None:
    """Present handler of Ctrl-C; None if it must not be changed."""
    handler = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or not callable(handler):
        return None
    return handler


@contextlib.contextmanager
def raising() -> Iterator[None]:
    """Let the first Ctrl-C raise KeyboardInterrupt, to close resources; the second ends the process."""

    def handler(*arguments: object) -> None:
        signal.signal(signal.SIGINT, quit_at_once)
        raise KeyboardInterrupt

    with handled_by(handler):
        yield


@contextlib.contextmanager
def deferred() -> Iterator[Callable[[], None]]:
    """Defer Ctrl-C until the yielded `check` is called, or the block ends.

    An exception that is raised within a callback of C would be lost. A second Ctrl-C does not wait.
    """
    before = current()
    if before is None:
        yield lambda: None
        return
    held: list[tuple[object, ...]] = []

    def hold(*arguments: object) -> None:
        if held:
            before(*arguments)
        held.append(arguments)

    def check() -> None:
        if held:
            before(*held[0])

    with handled_by(hold):
        yield check
    check()


@contextlib.contextmanager
def second_ends_all() -> Iterator[None]:
    """Let the second Ctrl-C end the process even while its main thread is within code of C."""
    if current() is None:
        yield
        return
    receiver, sender = socket.socketpair()
    sender.setblocking(False)
    before = signal.set_wakeup_fd(sender.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=count, args=(receiver,), daemon=True).start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)
        sender.close()


def count(receiver: socket.socket) -> None:
    """Count the signals that arrive until the other side is closed."""
    seen = 0
    with receiver:
        while signals := receiver.recv(16):
            seen += signals.count(signal.SIGINT)
            if seen > 1:
                sys.stdout.flush()
                quit_at_once()
