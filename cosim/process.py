"""Process state that foreign code may change, with an effect on the results of later runs."""

from __future__ import annotations

import ctypes
import os
import signal
import sys
from typing import Any

MAX_SIGNALS = 64
ARITHMETIC_ROOM, ACTION_ROOM = 64, 256
"""Bytes that hold an `fenv_t` and a `struct sigaction` of any system."""
LIMITS = "resource limits"
DRAWING = b"PYOPENGL_PLATFORM="
"""Environment variable that MuJoCo sets for rendering and no other code reads."""
HANDLER = ctypes.sizeof(ctypes.c_void_p)
"""Bytes of the handler, which is first in `struct sigaction`."""
POSIX = os.name == "posix" and not os.environ.get("COSIM_PORTABLE")
"""Whether calls of POSIX are used; tests set the variable to use only what Windows has as well."""
LINUX = POSIX and sys.platform == "linux"
_c: Any = ctypes.CDLL(None) if POSIX else None
SYSTEM = (sys.platform, os.uname().machine if hasattr(_c, "fegetenv") else "")
CONTROL = {
    # control word of the x87 at 0, MXCSR without its flags at 28 and 4
    ("linux", "x86_64"): 0x0F3F | 0xFFC0 << 8 * 28,
    ("darwin", "x86_64"): 0x0F3F | 0xFFC0 << 8 * 4,
    # FPCR
    ("linux", "aarch64"): 0xFFFF_FFFF,
    ("darwin", "arm64"): 0xFFFF_FFFF << 8 * 8,
}.get(SYSTEM, 0)
"""Bits of an `fenv_t` for rounding, denormals, precision and traps; 0 if unknown."""


class Arithmetic:
    """Floating-point environment of this thread at the time of construction."""

    def __init__(self) -> None:
        self.noted = ctypes.create_string_buffer(ARITHMETIC_ROOM)
        self.control = self._look(self.noted)

    @staticmethod
    def _look(room: Any) -> int:
        if not CONTROL:
            return 0
        _c.fegetenv(room)
        return int.from_bytes(room.raw, "little") & CONTROL

    def put_back(self) -> bool:
        """Restore it; return whether it was changed. Calculates nothing, because traps may be on."""
        if self._look(ctypes.create_string_buffer(ARITHMETIC_ROOM)) == self.control:
            return False
        _c.fesetenv(self.noted)
        return True


def belongings() -> dict[str, object]:
    """Return the state of the process by name; takes about 0.1 ms."""
    import locale

    mask = os.umask(0o077)
    os.umask(mask)
    found: dict[str, object] = {"working directory": folder(), "`umask`": mask}
    found["locale"] = locale.setlocale(locale.LC_ALL)
    if not POSIX:
        return {**found, "environment variables": dict(os.environ)}
    import resource

    kinds = {getattr(resource, name) for name in dir(resource) if name.startswith("RLIMIT_")}
    limits = [resource.getrlimit(kind) for kind in sorted(kinds)]
    return {**found, "environment variables": environment(), "signal handling": signals(), LIMITS: limits}


def folder() -> str:
    """Working directory; empty if it was removed."""
    try:
        return os.getcwd()  # noqa: PTH109
    except OSError:
        return ""


def environment() -> list[bytes]:
    """Environment variables as seen by C code, whose changes Python does not see."""
    found: list[bytes] = []
    try:
        place = ctypes.POINTER(ctypes.c_char_p).in_dll(_c, "environ")
    except ValueError:  # a system that hides it
        found = [name + b"=" + value for name, value in os.environb.items()]
    else:
        while place and (text := place[len(found)]) is not None:
            found.append(text)
    return [text for text in found if not text.startswith(DRAWING)]


def signals() -> list[object]:
    """Handlers of all signals, those that are blocked, and whether a timer runs."""
    blocked = signal.pthread_sigmask(signal.SIG_BLOCK, ())
    found: list[object] = [blocked, signal.getitimer(signal.ITIMER_REAL)[0] > 0.0]
    room = ctypes.create_string_buffer(ACTION_ROOM)
    for number in range(1, MAX_SIGNALS + 1):
        _c.sigaction(number, None, room)
        found.append(room[:HANDLER])
    return found


def changed(before: dict[str, object]) -> str:
    """Name a changed state; empty if nothing changed."""
    now = belongings()
    return " and ".join(f"the {name}" for name, value in before.items() if now[name] != value)
