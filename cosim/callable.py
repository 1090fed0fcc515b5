"""Packages that can be called: `cosim.sweep("study.toml")` is `cosim.sweep.results.sweep`."""

from __future__ import annotations

from importlib import import_module
from types import ModuleType
from typing import Any


class CallableModule(ModuleType):
    """A package that has the name of its main function, defined in its module `results`."""

    def __call__(self, *arguments: Any, **options: Any) -> Any:
        """Call the main function; import its dependencies now."""
        name = self.__name__.rpartition(".")[2]
        return getattr(import_module(f"{self.__name__}.results"), name)(*arguments, **options)
