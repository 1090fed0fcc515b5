"""Result of `cosim check` for one file."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, Literal

from cosim.errors import CosimError


@dataclass
class Checked:
    """Findings in one file, by its name as given: the error that prevents a run, and probable mistakes."""

    name: str
    kind: Literal["scenario", "study", "optimization"] = "scenario"
    error: CosimError | None = None
    warnings: list[str] = field(default_factory=list)
    runs: int = 1

    def to_dict(self) -> dict[str, Any]:
        """Return plain data for JSON."""
        error = self.error and {"message": self.error.message, "hint": self.error.hint}
        return {
            "file": self.name,
            "kind": self.kind,
            "status": self.error.status if self.error else "valid",
            "ok": self.error is None,
            "runs": self.runs,
            "error": error,
            "warnings": self.warnings,
        }
