"""The slide against its claims, in closed loop with its plant; the criteria are those of the scenario."""

import numpy as np
import pytest

import cosim

pytestmark = pytest.mark.acceptance

# nothing was tuned on these seeds
SEEDS = tuple(range(57_001, 57_007))


def test_the_integral_takes_up_what_friction_leaves_to_the_law_of_the_paper() -> None:
    default = cosim.run_many(cosim.load("__name__"), SEEDS)
    paper = cosim.run_many(cosim.load("__name__", set=["controller.law=Paper"]), SEEDS)
    held, left = ([run.metrics["hold"].value for run in runs] for runs in (default, paper))
    assert max(held) < 0.1 * min(left)


def test_a_slide_that_is_blocked_is_a_fault_with_its_name() -> None:
    blocked = cosim.load("__name__", set=["signal.plant.load.values=[-80.0, -80.0]"])
    trace = cosim.run(blocked, SEEDS[0]).trace
    assert trace is not None
    assert trace["controller.fault"][-1] == 2
    # the fault comes in the first sample beyond the limit, and ends the force
    beyond = np.flatnonzero(np.abs(trace["controller.following_error"]) > 1e-3)[0]
    assert trace["controller.state"][beyond] == 4
    assert np.all(trace["controller.force"][beyond:] == 0.0)
