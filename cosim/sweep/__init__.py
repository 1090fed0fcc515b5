"""Sweeps: the cases of a study, on worker processes or a cluster, and their results.

The package can be called: `cosim.sweep("study.toml")` is `cosim.sweep.results.sweep`.
"""

from __future__ import annotations

import sys

from cosim.callable import CallableModule

sys.modules[__name__].__class__ = CallableModule
