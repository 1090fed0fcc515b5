"""Columns as a pandas data frame, if pandas is installed."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cosim import extras


def dataframe(columns: Mapping[str, Any], units: Mapping[str, str]) -> Any:
    """Make a `pandas.DataFrame` whose `attrs["units"]` holds the units."""
    problem = "a data frame needs pandas, which is not installed"
    pandas = extras.needed("pandas", problem, extras.hint("frames"))
    frame = pandas.DataFrame(dict(columns))
    frame.attrs["units"] = dict(units)
    return frame
