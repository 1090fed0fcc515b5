"""Every scenario gives the bits that were recorded (`pytest -m recording`); a sample of them in every run."""

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
    """Skip the test where bits may differ; a build server (`CI` is set) of the recorded kind must not."""
    recorded, here = expected()[0].made_with, record.made_with()
    if recorded != here:
        told = f"recorded with {recorded}, this is {here}"
        if os.environ.get("CI") and recorded["machine"] == here["machine"]:
            pytest.fail(f"{told}\nhint: install those versions, or record again with `--write`")
        pytest.skip(told)


def assert_recorded(name: str) -> None:
    """Assert that a scenario gives the bits that were recorded."""
    recording, changes = expected()
    found = compare.compare(name, recording.scenarios[name], record.record(name), changes)
    assert [one for one in found if one.fault] == []


def test_every_recorded_scenario_is_there() -> None:
    assert set(expected()[0].scenarios) <= set(NAMES)


@pytest.mark.parametrize("name", SAMPLE)
def test_the_bits_of_the_sample_are_those_recorded(name: str) -> None:
    comparable()
    assert_recorded(name)


@pytest.mark.recording
@pytest.mark.parametrize("name", NAMES)
def test_the_bits_are_those_recorded(name: str) -> None:
    comparable()
    if name not in expected()[0].scenarios:
        pytest.skip("not recorded yet")
    assert_recorded(name)
