"""Import of MuJoCo on systems without its rendering backend, which it selects on import."""

from __future__ import annotations

import contextlib
import importlib
import os
import sys
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path

CHOICE = "MUJOCO_GL"
"""Environment variable that selects MuJoCo's rendering backend."""
LIBRARY = "PYGLFW_LIBRARY"
"""Environment variable with the library of GLFW, which otherwise starts a process to find versions."""


def ready() -> None:
    """Import MuJoCo, without a rendering backend if necessary; rendering then raises the reason."""
    if "mujoco" in sys.modules:
        return
    with assigned(LIBRARY, os.environ.get(LIBRARY) or packaged()):
        try:
            importlib.import_module("mujoco")
        except Exception:  # system libraries may be missing, or MuJoCo, which a plant reports
            with assigned(CHOICE, "disable"), contextlib.suppress(ImportError):
                importlib.import_module("mujoco")


def packaged() -> str:
    """Return the X11 library in the package `glfw`; empty if there is none, or another one is preferred."""
    wayland = os.environ.get("XDG_SESSION_TYPE") == "wayland" or os.environ.get(f"{LIBRARY}_VARIANT")
    found = None if wayland else find_spec("glfw")
    file = Path(found.origin or "").with_name("x11") / "libglfw.so" if found else Path()
    return str(file) if file.is_file() else ""


@contextlib.contextmanager
def assigned(name: str, value: str) -> Iterator[None]:
    """Value of an environment variable within the block."""
    before = os.environ.get(name)
    os.environ[name] = value
    try:
        yield
    finally:
        if before is None:
            del os.environ[name]
        else:
            os.environ[name] = before
