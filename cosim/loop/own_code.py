"""User code that a scenario names as `module:name`: next to the scenario or installed."""

from __future__ import annotations

import importlib
import importlib.util
import sys
import threading
from pathlib import Path
from typing import Any

_importing = threading.Lock()
"""Locked during the import of a module, so that other threads do not see a partial import."""


def module(name: str, folder: Path) -> Any:
    """Import a module for a scenario in `folder`, where it has priority; errors are those of the module."""
    for directory in (str(folder), str(Path.cwd())):
        if directory not in sys.path:
            sys.path.append(directory)
    with _importing:
        file = beside(name, folder)
        if not file.is_file() or is_imported(name, folder):
            return importlib.import_module(name)
        spec = importlib.util.spec_from_file_location(name, file)
        assert spec is not None
        assert spec.loader is not None
        sys.modules[name] = fresh = importlib.util.module_from_spec(spec)
        try:
            spec.loader.exec_module(fresh)
        except BaseException:
            del sys.modules[name]
            raise
        return fresh


def where(folder: Path) -> str:
    """Hint where a module must be."""
    return f"Put the module into `{folder}` or the working directory, or install it."


def is_imported(name: str, folder: Path) -> bool:
    """Whether a module was imported before."""
    known, file = sys.modules.get(name), beside(name, folder)
    return known is not None and (not file.is_file() or getattr(known, "__file__", None) == str(file))


def beside(name: str, folder: Path) -> Path:
    """File of a module next to the scenario."""
    return folder.joinpath(*name.split(".")).with_suffix(".py").resolve()
