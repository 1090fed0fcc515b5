"""Common parts of the studies of the commissioning runs."""

from __future__ import annotations

from ..samples import studies


class Machine(studies.Machine):
    """A machine of a study with a commissioning run."""

    @property
    def applied(self) -> bool:
        """Whether it uses the measured values."""
        return bool(self.changes["controller.commission.apply"])
