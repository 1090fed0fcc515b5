"""Every scenario gives the bits that were recorded (`pytest -m recording`)."""

from __future__ import annotations

import functools

import pytest

from . import compare, record
from .compare import Changes
from .record import Recording

pytestmark = pytest.mark.recording
NAMES = record.scenario_names()


@functools.cache
def expected() -> tuple[Recording, Changes]:
    return record.read(), compare.read()


def test_every_recorded_scenario_is_there() -> None:
    assert set(expected()[0].scenarios) <= set(NAMES)


@pytest.mark.parametrize("name", NAMES)
def test_the_bits_are_those_recorded(name: str) -> None:
    recording, changes = expected()
    if recording.made_with != record.made_with():
        pytest.skip(f"recorded with {recording.made_with}, this is {record.made_with()}")
    if name not in recording.scenarios:
        pytest.skip("not recorded yet")
    found = compare.compare(name, recording.scenarios[name], record.record(name), changes)
    assert [one for one in found if one.fault] == []
