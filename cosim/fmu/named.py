"""Names of FMUs in messages."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class NamedFmu:
    """An FMU with its name, as in `<name>.<variable>`, and its file, as the user wrote them.

    An FMU that is `alone` needs no name in sentences.
    """

    name: str
    fmu: str
    alone: bool = field(default=False, metadata={"key": ""})

    @property
    def who(self) -> str:
        """Name of the FMU in messages."""
        return "the FMU" if self.alone else f"the FMU `{self.name}`"

    @property
    def label(self) -> str:
        """Name that distinguishes it from the other FMUs of the run."""
        return self.fmu if self.alone else self.name


ALONE = NamedFmu("controller", "", alone=True)
"""The only FMU of a run."""
