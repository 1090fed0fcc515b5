"""The environment of Gymnasium steps as `cosim.run` does."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import cosim
from cosim.errors import CosimError
from cosim.fmu.instance import Instance
from cosim.gym import Environment

from ..bad_inputs import fmus
from ..conftest import entry

Write = Callable[..., Path]
COLUMNS = ["controller.in", "controller.out", "plant.x", "plant.u"]
BOUNDS = {"plant.u": (-1.0, 1.0)}


@pytest.fixture
def lag(write: Write) -> cosim.Scenario:
    """Scenario whose only measurement has noise."""
    return cosim.load(write(), set=["wire.controller.in.noise=0.1"])


@pytest.fixture
def environment(lag: cosim.Scenario) -> Iterator[Environment]:
    """Environment that sets the command of the plant."""
    with Environment(lag, BOUNDS, COLUMNS, "-plant.x ** 2") as made:
        yield made


def episode(environment: Environment, seed: int, count: int | None = None) -> list[Any]:
    """Observations, rewards and ends of an episode with random actions."""
    environment.action_space.seed(seed)
    rows: list[Any] = [(environment.reset(seed=seed)[0].tolist(), 0.0, False, False)]
    while not (rows[-1][2] or rows[-1][3] or len(rows) == count):
        observation, *rest, _ = environment.step(environment.action_space.sample())
        rows.append((observation.tolist(), *rest))
    return rows


def test_it_passes_the_check_of_gymnasium(environment: Environment) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # infinite observations, no `spec` and no rendering are meant
        for known in ("infinity", "render", "spec", "registered"):
            warnings.filterwarnings("ignore", f".*{known}.*")
        check_env(environment)


def test_equal_seeds_give_equal_episodes(environment: Environment) -> None:
    assert episode(environment, 7) == episode(environment, 7)
    assert episode(environment, 7) != episode(environment, 8)
    # an episode that ended early leaves nothing
    episode(environment, 8, count=5)
    first = environment.reset(seed=7)[0]
    second, facts = environment.reset()
    assert first.tolist() != second.tolist()
    assert environment.reset(seed=facts["seed"])[0].tolist() == second.tolist()


@pytest.mark.parametrize("engine", ["reference", "native"])
@pytest.mark.parametrize("target", ["plant.u", "controller.in"])
def test_actions_are_a_signal_of_the_run(lag: cosim.Scenario, write: Write, engine: Any, target: str) -> None:
    values = [0.0, *np.random.default_rng(3).uniform(-1.0, 1.0, 49).tolist()]
    with Environment(lag, {target: (-1.0, 1.0)}, COLUMNS, "plant.x") as environment:
        rows = [environment.reset(seed=5)[0]]
        for k, value in enumerate(values[1:], 1):
            observation, reward, terminated, truncated, facts = environment.step(np.array([value]))
            rows.append(observation)
            assert (reward, terminated, truncated) == (observation[2], False, k == 49)
            assert facts["time"] == k * 0.001
    times = [k * 0.001 for k in range(50)]
    played = entry("signal", to=target, times=times, values=values)
    file = write(f'extends = "lag.toml"\ndrop = ["wire.{target}"]\n{played}', "played.toml", text="")
    noise = [] if target == "controller.in" else ["wire.controller.in.noise=0.1"]
    result = cosim.run(cosim.load(file, set=noise), seed=5, engine=engine)
    assert result.trace is not None
    expected = np.column_stack([result.trace[name] for name in COLUMNS])
    assert np.array(rows).tobytes() == expected.tobytes()


@pytest.mark.parametrize(
    ("stop", "length", "ends"), [("time > 0.025", 4, (True, False)), ("", 5, (False, True))]
)
def test_a_row_of_several_steps_is_a_step_of_the_agent(
    write: Write, stop: str, length: int, ends: tuple[bool, bool]
) -> None:
    scenario = cosim.load(write(), set=["loop.record_every=10", f'loop.stop_when="{stop}"'])
    with Environment(scenario, BOUNDS, ["time", "plant.u"], "1") as environment:
        rows = episode(environment, 1)
        assert [row[0][0] for row in rows] == [k * 0.001 for k in range(0, 10 * length, 10)]
        assert rows[-1][2:] == ends
        with pytest.raises(cosim.CosimError, match="ended") as raised:
            environment.step(np.zeros(1))
        assert raised.value.hint == "Call `reset`."


@pytest.mark.parametrize(
    ("actions", "observations", "reward", "said"),
    [
        ({"plant.uu": (0, 1)}, ["plant.x"], "1", "`plant.uu`"),
        ({"controller.nothing": (0, 1)}, ["plant.x"], "1", "`nothing`"),
        ({"controller.flag": (0, 1)}, ["plant.x"], "1", "`controller.flag` is not a Real input"),
        ({"other.u": (0, 1)}, ["plant.x"], "1", "`other.u`"),
        ({"plant.u": (1, 1)}, ["plant.x"], "1", r"`\[1.0, 1.0\]`"),
        ({"plant.u": (-np.inf, 1)}, ["plant.x"], "1", "`plant.u`"),
        (BOUNDS, ["plant.y"], "1", "`plant.y` is not a column"),
        (BOUNDS, ["plant.x"], "plant.y", "`plant.y`"),
        (BOUNDS, ["plant.x"], "mean(plant.x)", "`mean`"),
    ],
)
def test_a_wrong_name_or_bound_is_an_error(
    lag: cosim.Scenario, actions: Any, observations: list[str], reward: str, said: str
) -> None:
    with pytest.raises(cosim.CosimError, match=said):
        Environment(lag, actions, observations, reward)


def test_a_failed_run_is_an_error_with_its_time(write: Write) -> None:
    scenario = cosim.load(write(), set=["plant.fail_at=3"])
    with Environment(scenario, BOUNDS, COLUMNS, "1") as environment:
        with pytest.raises(cosim.CosimError, match=r"0\.003 s .*failed on request"):
            episode(environment, 1)
        environment.reset(seed=1)


@pytest.mark.parametrize(
    ("last", "times"), [(0, [0.0, 0.0]), (17, [0.0, 0.01, 0.01]), (20, [0.0, 0.01, 0.02])]
)
def test_an_fmu_that_ends_the_run_ends_the_episode(
    write: Write, monkeypatch: pytest.MonkeyPatch, last: int, times: list[float]
) -> None:
    def compute(fmu: Instance, time: float, step: float) -> bool:
        fmu.ended = time if time >= (last - 0.5) * step else None
        return original(fmu, time, step) or fmu.ended is not None

    original = Instance.compute
    monkeypatch.setattr(Instance, "compute", compute)
    scenario = cosim.load(write(), set=["loop.record_every=10"])
    with Environment(scenario, BOUNDS, ["time"], "1") as environment:
        rows = episode(environment, 1)
    assert [row[0][0] for row in rows] == times
    assert rows[-1][2:] == (True, False)


def test_an_fmu_whose_reset_does_nothing_has_one_episode(
    write: Write, folder: Path, broken_library: bytes
) -> None:
    fmus.defect("reset_nothing")(folder / "keeping.fmu", broken_library)
    scenario = cosim.load(write(), set=["controller.fmu=keeping.fmu"])
    with Environment(scenario, BOUNDS, COLUMNS, "0") as environment:
        episode(environment, 7, count=5)
        with pytest.raises(CosimError, match=r"keeps state: a repeated episode gives other rows\nhint: Run"):
            environment.reset(seed=8)
