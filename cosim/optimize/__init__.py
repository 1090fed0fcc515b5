"""Optimization: the values of some keys at which a loop is best, or most like what was measured.

The package can be called: `cosim.optimize("search.toml")` is `cosim.optimize.results.optimize`.
"""

from __future__ import annotations

import sys

from cosim.callable import CallableModule

sys.modules[__name__].__class__ = CallableModule
