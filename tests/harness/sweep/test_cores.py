"""A process that is held to some cores starts as many workers."""

from __future__ import annotations

import os

import pytest

from cosim.sweep import cores


@pytest.mark.skipif(not hasattr(os, "sched_setaffinity"), reason="this system binds no process to cores")
def test_cores_are_those_that_are_left(monkeypatch: pytest.MonkeyPatch) -> None:
    whole = os.sched_getaffinity(0)
    os.sched_setaffinity(0, {min(whole)})
    try:
        assert cores.available() == 1
    finally:
        os.sched_setaffinity(0, whole)
    assert cores.available() == len(whole)
    monkeypatch.delattr(os, "sched_getaffinity")
    assert cores.available() == os.cpu_count()
