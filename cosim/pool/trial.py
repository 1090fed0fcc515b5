"""Trial import of a user module in a separate process."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from cosim.errors import CosimError
from cosim.loop import plant
from cosim.loop.place import Stage
from cosim.pool.job import Bench
from cosim.pool.limits import Limits
from cosim.pool.once import place


@dataclass(frozen=True)
class Import:
    """The import of a plant's class."""

    name: str
    folder: Path

    def run(self, bench: Bench) -> None:
        """Import it."""
        bench.place.begin("", self.name, 0, 0.0)
        bench.place.at(Stage.BUILD_PLANT)
        try:
            plant.plant_class(self.name, self.folder)
        except SystemExit as error:
            raise plant.exited(self.name, error) from error
        bench.place.at(Stage.NONE)


def import_plant(name: str, folder: Path) -> None:
    """Check in a separate process whether a plant's module can be imported without ending the process.

    Raises
    ------
    CosimError
        The import failed or ended the process.
    """
    with place(Limits()) as do:
        outcome = do(Import(name, folder))
    if isinstance(outcome, CosimError):
        raise outcome
