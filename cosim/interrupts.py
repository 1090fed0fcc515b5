"""Handling of Ctrl-C that is never lost, whatever the process does.

SIGTERM, by which schedulers, containers and `timeout` end a program, is handled as Ctrl-C.
"""

from __future__ import annotations

import contextlib
import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from typing import Any, NoReturn

SIGNALS = (signal.SIGINT, signal.SIGTERM)
INTERRUPTED = 130
"""Exit code of a process that one of these signals ended."""
SHOW_CURSOR = b"\r\x1b[2K\x1b[?25h"
"""Clears the line of a progress bar and restores the cursor."""
Handler = Callable[..., Any]


def quit_at_once(*_: object) -> NoReturn:
    """End the process without unwinding: no exception can be lost in an import or a callback of C."""
    os.write(2, (SHOW_CURSOR if os.isatty(2) else b"") + b"error: interrupted\n")
    os._exit(INTERRUPTED)


@contextlib.contextmanager
def handled_by(handler: Handler, *replaced: Any) -> Iterator[None]:
    """Let `handler` handle the signals; `replaced` as in `current`."""
    before = current(*replaced)
    for number in before:
        signal.signal(number, handler)
    try:
        yield
    finally:
        for number, earlier in before.items():
            signal.signal(number, earlier)


def current(*replaced: Any) -> dict[int, Any]:
    """Present handlers that may be changed, by signal; none outside the main thread.

    An ignored signal stays ignored. In a program of others, SIGTERM keeps its default effect: only the
    command line replaces it, by passing `SIG_DFL`.
    """
    if threading.current_thread() is not threading.main_thread():
        return {}
    found = {number: signal.getsignal(number) for number in SIGNALS}
    return {number: handler for number, handler in found.items() if callable(handler) or handler in replaced}


@contextlib.contextmanager
def raising() -> Iterator[None]:
    """Let the first Ctrl-C raise KeyboardInterrupt, to close resources; the second ends the process."""

    def handler(*arguments: object) -> None:
        for number in current():
            signal.signal(number, quit_at_once)
        raise KeyboardInterrupt

    with handled_by(handler):
        yield


@contextlib.contextmanager
def deferred() -> Iterator[Callable[[], None]]:
    """Defer Ctrl-C until the yielded `check` is called, or the block ends.

    An exception that is raised within a callback of C would be lost. A second Ctrl-C does not wait.
    """
    before = current()
    held: list[tuple[int, object]] = []

    def hold(number: int, frame: object) -> None:
        if held:
            before[number](number, frame)
        held.append((number, frame))

    def check() -> None:
        if held:
            before[held[0][0]](*held[0])

    with handled_by(hold):
        yield check
    check()


@contextlib.contextmanager
def second_ends_all() -> Iterator[None]:
    """Let the second Ctrl-C end the process even while its main thread is within code of C."""
    if not current():
        yield
        return
    receiver, sender = socket.socketpair()

    def count() -> None:
        seen = 0
        with receiver:
            while signals := receiver.recv(16):
                seen += sum(map(signals.count, SIGNALS))
                if seen > 1:
                    sys.stdout.flush()
                    quit_at_once()

    sender.setblocking(False)
    before = signal.set_wakeup_fd(sender.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=count, daemon=True).start()
    try:
        yield
    finally:
        signal.set_wakeup_fd(before)
        sender.close()
