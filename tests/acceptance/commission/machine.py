"""What the studies of the five commissions have in common."""

from __future__ import annotations

from ..samples import studies


class Machine(studies.Machine):
    """A machine of a study with a commissioning run."""

    @property
    def applied(self) -> bool:
        """Whether it uses what was measured."""
        return bool(self.changes["controller.commission.apply"])
