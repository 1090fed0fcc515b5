"""Every scenario is bit-identical with the recording (`pytest -m recording`); a sample in every run."""

from __future__ import annotations

import functools
import os

import pytest

from . import compare, record
from .compare import Changes
from .record import Recording

NAMES = record.scenario_names()
SAMPLE = [
    "centering/probe-lost",
    "centering/ring-too-small",
    "deburr/hold",
    "deburr/paper",
    "dob",
    "dob/paper",
    "fts/hum",
    "fts/infeasible",
    "polish/no-mold",
    "polish/wrong-normals",
]
"""Short scenarios of every loop, with the default and the published control law."""


@functools.cache
def expected() -> tuple[Recording, Changes]:
    return record.read(), compare.read()


def comparable() -> None:
    """Skip the test if bits may differ, except on a build server (`CI` is set) of the recorded kind."""
    recorded, here = expected()[0].made_with, record.made_with()
    if recorded != here:
        problem = f"recorded with {recorded}, this is {here}"
        if os.environ.get("CI") and recorded["machine"] == here["machine"]:
            pytest.fail(f"{problem}\nhint: install those versions, or record again with `--write`")
        pytest.skip(problem)


def assert_recorded(name: str) -> None:
    """Assert that a scenario is bit-identical with the recording."""
    recording, changes = expected()
    found = compare.compare(name, recording.scenarios[name], record.record(name), changes)
    assert [one for one in found if one.fault] == []


def test_every_recorded_scenario_exists() -> None:
    assert set(expected()[0].scenarios) <= set(NAMES)


@pytest.mark.parametrize("name", SAMPLE)
def test_the_sample_is_bit_identical(name: str) -> None:
    comparable()
    assert_recorded(name)


@pytest.mark.recording
@pytest.mark.parametrize("name", NAMES)
def test_a_scenario_is_bit_identical(name: str) -> None:
    comparable()
    if name not in expected()[0].scenarios:
        pytest.skip("not recorded yet")
    assert_recorded(name)
