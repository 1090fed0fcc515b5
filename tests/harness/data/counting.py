"""The lag that notes the process of each run."""

import os
import pathlib

import numpy as np
import probe_plants


class Counting(probe_plants.Lag):
    def reset(self, seed: np.random.SeedSequence, duration: float) -> None:
        super().reset(seed, duration)
        with pathlib.Path(__file__).with_name("processes").open("a") as file:
            file.write(f"{os.getpid()}\n")
