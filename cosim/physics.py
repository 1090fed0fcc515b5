"""Import of MuJoCo on systems without its rendering backend, which it selects on import."""

from __future__ import annotations

import contextlib
import importlib
import os

CHOICE = "MUJOCO_GL"
"""Environment variable that selects MuJoCo's rendering backend."""


def ready() -> None:
    """Import MuJoCo, without a rendering backend if necessary; rendering then raises the reason."""
    chosen = os.environ.get(CHOICE)
    if not chosen:
        return
    try:
        importlib.import_module("mujoco")
    except Exception:  # system libraries may be missing
        os.environ[CHOICE] = "disable"
        try:
            # without MuJoCo the plant raises the error
            with contextlib.suppress(ImportError):
                importlib.import_module("mujoco")
        finally:
            os.environ[CHOICE] = chosen
