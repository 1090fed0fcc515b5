"""MuJoCo where its choice of what draws cannot be had: it is made on import, which fails as a whole then."""

from __future__ import annotations

import contextlib
import importlib
import os

CHOICE = "MUJOCO_GL"
"""Variable of the environment with which MuJoCo lets choose what draws."""


def ready() -> None:
    """Import MuJoCo, without what draws if it has to be; what is drawn then tells why it cannot be."""
    chosen = os.environ.get(CHOICE)
    if not chosen:
        return
    try:
        importlib.import_module("mujoco")
    except Exception:  # whatever the libraries of the system lack
        os.environ[CHOICE] = "disable"
        try:
            # without MuJoCo itself the plant tells
            with contextlib.suppress(ImportError):
                importlib.import_module("mujoco")
        finally:
            os.environ[CHOICE] = chosen
