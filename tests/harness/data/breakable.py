"""The slide of the project, in which MuJoCo fails on demand."""

import dataclasses
import pathlib

import numpy as np

from plants import slide
from plants.base.parameters import parameter
from plants.slide_parameters import SlideParameters


@dataclasses.dataclass(frozen=True)
class BreakableParameters(SlideParameters):
    broken: float = parameter(0.0, "1", "1: MuJoCo fails", 0.0, 1.0, "test")


class Breakable(slide.Slide):
    Parameters = BreakableParameters

    def __init__(self, parameters: BreakableParameters) -> None:
        super().__init__(parameters)
        self.sound = int(self.model.jnt_type[0])

    @classmethod
    def _mjcf(cls) -> pathlib.Path:
        return pathlib.Path(slide.__file__).with_suffix(".xml")

    def reset(self, seed: int | np.random.SeedSequence, duration: float) -> None:
        self.model.jnt_type[0] = self.sound
        super().reset(seed, duration)
        if self.parameters.broken:
            self.model.jnt_type[0] = 99
