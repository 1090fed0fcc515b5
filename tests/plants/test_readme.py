"""The plant in the README of the plants is one."""

import importlib
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

README = (Path(__file__).resolve().parents[2] / "plants/README.md").read_text(encoding="utf-8")


def oscillator(folder: Path, monkeypatch: pytest.MonkeyPatch) -> Any:
    section = README[README.index("## A new plant") :]
    for language, suffix in (("xml", "xml"), ("python", "py")):
        (text,) = re.findall(rf"```{language}\n(.*?)```", section, re.DOTALL)
        (folder / f"oscillator.{suffix}").write_text(text)
    monkeypatch.syspath_prepend(folder)
    return importlib.import_module("oscillator")


def test_the_mass_settles_where_spring_and_force_are_equal(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = oscillator(tmp_path, monkeypatch)
    plant = module.Oscillator(module.OscillatorParameters(mass=0.5))
    assert plant.model.body("mass").mass == 0.5
    plant.reset(seed=1, duration=4.0)
    for _ in range(4000):
        plant.sense()
        plant.command(np.array([20.0]))
        plant.advance(10)
    assert plant.sense() == pytest.approx([2e-3], abs=1e-9)
    assert plant.truth() == pytest.approx([0.0], abs=1e-8)
