"""Columns as a pandas data frame, where pandas is installed."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

from cosim.errors import CosimError


def dataframe(columns: Mapping[str, Any], units: Mapping[str, str]) -> Any:
    """Make a `pandas.DataFrame` whose `attrs["units"]` holds the units.

    Raises
    ------
    CosimError
        pandas is not installed.
    """
    try:
        pandas: Any = importlib.import_module("pandas")
    except ImportError:
        raise CosimError(
            "a data frame needs pandas, which is not installed", "`pip install pandas`"
        ) from None
    frame = pandas.DataFrame(dict(columns))
    frame.attrs["units"] = dict(units)
    return frame
