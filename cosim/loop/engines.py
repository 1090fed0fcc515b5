"""Names of the engines that can run a loop."""

from __future__ import annotations

from typing import Literal, get_args

from cosim.errors import CosimError, closest

Engine = Literal["reference", "native"]
ENGINES: tuple[Engine, ...] = get_args(Engine)


def checked(name: str) -> Engine:
    """Engine by its name."""
    if engine := next((engine for engine in ENGINES if engine == name), None):
        return engine
    raise CosimError(f"there is no engine `{name}`", closest(name, ENGINES))
