"""Values that options of a command assign to keys of a scenario."""

from __future__ import annotations

from typing import Any, NamedTuple


class Assignment(NamedTuple):
    """A value of a key, and the option that messages name as its origin."""

    option: str
    key: str
    value: Any
