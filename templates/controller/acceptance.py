"""Claims of the slide in closed loop with its plant; the scenario has the criteria."""

import numpy as np
import pytest

import cosim

pytestmark = pytest.mark.acceptance

# nothing was tuned on these seeds
SEEDS = tuple(range(57_001, 57_007))


def test_the_integral_removes_the_error_that_friction_leaves_in_the_published_variant() -> None:
    default = cosim.run_many(cosim.load("__name__"), SEEDS)
    paper = cosim.run_many(cosim.load("__name__", set=["controller.law=Paper"]), SEEDS)
    held, left = ([run.metrics["hold"].value for run in runs] for runs in (default, paper))
    assert max(held) < 0.1 * min(left)


def test_a_blocked_slide_raises_a_following_error() -> None:
    blocked = cosim.load("__name__", set=["signal.plant.load.values=[-80.0, -80.0]"])
    trace = cosim.run(blocked, SEEDS[0]).trace
    assert trace is not None
    assert trace["controller.fault"][-1] == 2
    # the first sample beyond the limit raises the fault and sets the force to zero
    beyond = np.flatnonzero(np.abs(trace["controller.following_error"]) > 1e-3)[0]
    assert trace["controller.state"][beyond] == 4
    assert np.all(trace["controller.force"][beyond:] == 0.0)
