"""Log messages of FMUs: passed to Python logging and kept for error texts."""

from __future__ import annotations

import itertools
import logging
from ctypes import byref
from typing import Any

from fmpy import fmi2
from fmpy.logging import addLoggerProxy

from cosim import errors

log = logging.getLogger("cosim.fmu")

LEVELS = {0: logging.INFO, 1: logging.WARNING, 2: logging.WARNING, 3: logging.ERROR, 4: logging.ERROR}
KEPT = 20
"""Maximum number of messages per instance, because an FMU may warn in every step."""

LONGEST = 2000
"""Maximum length of a shown message."""


class Messages:
    """Log of one FMU instance.

    The message about a failed call becomes part of the raised error and is logged as debug.
    """

    def __init__(self, instance: str) -> None:
        self.instance = instance
        self.kept: list[tuple[int, str]] = []
        self.handle = next(_handles)
        self.callbacks = fmi2.fmi2CallbackFunctions()
        self.callbacks.logger = _proxy.logger
        self.callbacks.allocateMemory = _proxy.allocateMemory
        self.callbacks.freeMemory = _proxy.freeMemory
        self.callbacks.componentEnvironment = self.handle
        _listeners[self.handle] = self

    def close(self) -> None:
        """Stop receiving messages."""
        _listeners.pop(self.handle, None)

    def receive(self, status: int, category: bytes | None, text: bytes | None) -> None:
        """Receive one message."""
        message, level = readable(text), LEVELS.get(status, logging.ERROR)
        self.kept = [*self.kept[1 - KEPT :], (status, message)]
        level = level if level < logging.ERROR else logging.DEBUG
        log.log(level, "%s [%s] %s", self.instance, readable(category), message)

    def take(self) -> str:
        """Return and discard the messages since the last call, of the worst status only."""
        worst = max((status for status, _ in self.kept), default=0)
        texts = dict.fromkeys(text for status, text in self.kept if status == worst and status > 0)
        self.kept = []
        return "; ".join(texts)


def _receive(environment: int | None, instance: bytes, status: int, category: bytes, text: bytes) -> None:
    """Pass a message of FMI 2.0 to the instance of the environment pointer."""
    listener = _listeners.get(environment or 0)
    if listener is not None:
        listener.receive(status, category, text)
    else:
        log.log(LEVELS.get(status, logging.ERROR), "%s", readable(text))


def readable(text: bytes | None) -> str:
    """Text of an FMU for display: no terminal control codes, limited length."""
    clean = errors.readable((text or b"")[: LONGEST + 1].decode("utf-8", "replace").strip())
    return clean if len(clean) <= LONGEST else f"{clean[:LONGEST]}..."


def _make_proxy() -> Any:
    """One set of callbacks with FMPy's proxy, which expands printf formats; it can serve only one logger."""
    callbacks = fmi2.fmi2CallbackFunctions()
    callbacks.logger = fmi2.fmi2CallbackLoggerTYPE(_receive)
    callbacks.allocateMemory = fmi2.defaultCallbacks.allocateMemory
    callbacks.freeMemory = fmi2.defaultCallbacks.freeMemory
    addLoggerProxy(byref(callbacks))
    return callbacks


_handles = itertools.count(1)
_listeners: dict[int, Messages] = {}
_proxy = _make_proxy()
