"""Many runs: the cases of a study, on worker processes or a cluster, and what came of them.

The package can be called: `cosim.sweep("study.toml")` is `cosim.sweep.results.sweep`.
"""

from __future__ import annotations

import sys
from types import ModuleType
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cosim.sweep.results import SweepResult


class CallableModule(ModuleType):
    """A package that has the name of its main function."""

    def __call__(self, *arguments: Any, **options: Any) -> SweepResult:
        """Run a study, see `cosim.sweep.results.sweep`."""
        from cosim.sweep.results import sweep

        return sweep(*arguments, **options)


sys.modules[__name__].__class__ = CallableModule
