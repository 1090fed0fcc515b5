"""Both engines on one scenario, and what a run of them leaves."""

from __future__ import annotations

import functools
from typing import Any

import mujoco
import numpy as np
import pytest

import cosim
from cosim.loop import native

CHUNKS = (1, 7, 1000)
RUN = native.run


def both(scenario: cosim.Scenario) -> tuple[cosim.Session, cosim.Session]:
    """Open a session of each engine."""
    return cosim.Session(scenario), cosim.Session(scenario, engine="native")


def outcome(session: cosim.Session, seed: int | None = None) -> tuple[bytes, bytes, float]:
    """Bytes of the trace and of MuJoCo's state, and the simulated time."""
    result = session.run(seed)
    plant: Any = session.plant
    state = np.zeros(mujoco.mj_stateSize(plant.model, mujoco.mjtState.mjSTATE_INTEGRATION))
    mujoco.mj_getState(plant.model, plant.data, state, mujoco.mjtState.mjSTATE_INTEGRATION)
    assert result.trace is not None
    assert result.engine == session.engine
    return result.trace.tobytes(), state.tobytes(), result.simulated_s


def chunked(monkeypatch: pytest.MonkeyPatch, chunk: int) -> None:
    monkeypatch.setattr(native, "run", functools.partial(RUN, chunk=chunk))
