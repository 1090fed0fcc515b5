"""Packages that only some commands need."""

from __future__ import annotations

import importlib
from typing import Any

from cosim.errors import CosimError


def needed(module: str, problem: str, hint: str) -> Any:
    """Import a module of another package.

    Raises
    ------
    CosimError
        The package is not installed: the problem and the hint.
    """
    try:
        return importlib.import_module(module)
    except ImportError:
        raise CosimError(problem, hint) from None


def hint(extra: str) -> str:
    """Hint how to install an extra of this project."""
    return f"Install the extra: `pip install machining-fmus[{extra}]`."
