"""Log messages of FMUs: routed to Python logging and kept for the texts of errors."""

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
"""Messages kept per instance; an FMU that warns in every step must not fill the memory."""

LONGEST = 2000
"""Characters of a message that are shown."""


class Messages:
    """Log of one FMU instance.

    What an FMU says about a failed call becomes part of the error that is raised; it is logged as debug.
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
        """Listen no longer."""
        _listeners.pop(self.handle, None)

    def add(self, status: int, category: str, text: str) -> None:
        """Take one message."""
        self.kept = [*self.kept[1 - KEPT :], (status, text)]
        level = LEVELS.get(status, logging.ERROR)
        log.log(
            level if level < logging.ERROR else logging.DEBUG, "%s [%s] %s", self.instance, category, text
        )

    def take(self) -> str:
        """Texts of the warnings and errors since the last call, worst status only, and forget them."""
        worst = max((status for status, _ in self.kept), default=0)
        texts = dict.fromkeys(text for status, text in self.kept if status == worst and status > 0)
        self.kept = []
        return "; ".join(texts)


def _receive(environment: int | None, instance: bytes, status: int, category: bytes, text: bytes) -> None:
    """Hand a message to the instance that the environment pointer stands for."""
    message = readable(text)
    listener = _listeners.get(environment or 0)
    if listener is not None:
        listener.add(status, readable(category), message)
    else:
        log.log(LEVELS.get(status, logging.ERROR), "%s", message)


def readable(text: bytes | None) -> str:
    """Text of an FMU as it may be shown: no control codes of terminals, and not without end."""
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
