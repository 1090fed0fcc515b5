"""Optimization: values of keys with the best metric, or the best agreement with a measured trace.

The package can be called: `cosim.optimize("search.toml")` is `cosim.optimize.results.optimize`.
"""

from __future__ import annotations

import sys

from cosim.callable import CallableModule

sys.modules[__name__].__class__ = CallableModule
