"""The reference loop against closed forms, and what it does when something fails."""

from __future__ import annotations

import logging
from collections.abc import Callable, Generator, Iterable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError, FmuError, PlantError
from cosim.pool.executor import outcomes
from cosim.pool.job import Finished, Numbered
from cosim.pool.limits import Limits

from .conftest import SCENARIO

Write = Callable[..., Path]


def run(file: Path, *overrides: str, seed: int | None = None) -> cosim.Result:
    return cosim.run(cosim.load(file, set=overrides), seed)


def column(result: cosim.Result, name: str) -> np.ndarray:
    assert result.trace is not None
    return np.array(result.trace[name])


@pytest.mark.parametrize("gain", [0.5, -0.8])
def test_without_delay_the_command_acts_in_the_same_step(write: Write, gain: float) -> None:
    # x[k+1] = a x[k] + (1 - a) g x[k]
    result = run(write(), "loop.compute_delay=0", f"controller.gain={gain}")
    root = 0.5 + 0.5 * gain
    assert column(result, "plant.x") == pytest.approx(root ** np.arange(50), rel=1e-12, abs=1e-300)


@pytest.mark.parametrize("gain", [0.5, -0.8])
def test_with_delay_the_command_acts_one_step_later(write: Write, gain: float) -> None:
    # x[k+1] = a x[k] + (1 - a) g x[k-1], the FMU is initialized with x[0]: x[0] = 1, x[1] = a + (1 - a) g
    result = run(write(), "loop.compute_delay=1", f"controller.gain={gain}")
    first, second = np.roots([1.0, -0.5, -0.5 * gain]).astype(complex)
    share = (0.5 + 0.5 * gain - second) / (first - second)
    k = np.arange(50)
    expected = (share * first**k + (1.0 - share) * second**k).real
    assert column(result, "plant.x") == pytest.approx(expected, rel=1e-9, abs=1e-12)


def test_a_delay_of_the_command_wire_is_a_compute_delay(write: Write) -> None:
    by_loop = run(write(), "loop.compute_delay=1")
    by_wire = run(write(), "loop.compute_delay=0", "wire.plant.u.delay=1")
    assert column(by_loop, "plant.x").tobytes() == column(by_wire, "plant.x").tobytes()
    both = run(write(), "loop.compute_delay=1", "wire.plant.u.delay=1")
    x = column(both, "plant.x")
    assert column(both, "plant.u")[:4].tolist() == [x[0], x[0], x[0], x[1]]


def test_the_controller_sees_the_plant_at_the_same_time(write: Write) -> None:
    result = run(write())
    assert column(result, "controller.in").tobytes() == column(result, "plant.x").tobytes()


def test_a_delayed_reading_is_older(write: Write) -> None:
    result = run(write(), "wire.controller.in.delay=3")
    assert column(result, "controller.in")[3:].tolist() == column(result, "plant.x")[:-3].tolist()
    assert column(result, "controller.in")[:3].tolist() == [1.0, 1.0, 1.0]


def test_time_is_k_times_step_and_never_accumulated(write: Write) -> None:
    result = run(write(), "loop.duration=3.0")
    expected = np.arange(3000) * 0.001
    assert column(result, "time").tobytes() == expected.tobytes()
    assert column(result, "controller.clock.time").tobytes() == expected.tobytes()
    assert result.simulated_s == 3.0


def test_substeps_move_the_plant_that_often(write: Write) -> None:
    added = '[[wire]]\nfrom = "plant.count"\nto = "controller.count"\n'
    result = run(write(added), "loop.step=0.005", "loop.substeps=5")
    assert column(result, "controller.count").tolist() == [5.0 * k for k in range(10)]


def test_booleans_integers_and_enumerations_travel_as_numbers(write: Write) -> None:
    added = """
[[wire]]
from = "plant.flag"
to = "controller.flag"
[[wire]]
from = "plant.count"
to = "controller.count"
[[wire]]
from = "controller.flag_out"
to = "plant.extra"
"""
    mode = '{to = "controller.mode", times = [0.0, 0.01], values = ["Slow", 4]}'
    result = run(write(added, text=f"signal = [{mode}]\n{SCENARIO}"), "loop.compute_delay=0")
    flags = np.arange(50) % 2
    assert column(result, "controller.flag").tolist() == flags.tolist()
    assert column(result, "plant.extra").tolist() == (1 - flags).tolist()
    assert column(result, "controller.count_out").tolist() == [k + 1 for k in range(50)]
    assert column(result, "controller.mode_out").tolist() == [2.0] * 10 + [4.0] * 40
    assert result.items["controller.mode"] == {"Off": 1, "Slow": 2, "Fast": 4}


def test_a_signal_reaches_tunable_parameters_and_commands(write: Write) -> None:
    gain = '{to = "controller.gain", times = [0.0, 0.02], values = [1.0, 3.0]}'
    extra = '{to = "plant.extra", times = [0.0, 0.03], values = [0.0, 1.5]}'
    result = run(write(text=f"signal = [{gain}, {extra}]\n{SCENARIO}"))
    ratio = column(result, "controller.out") / column(result, "controller.in")
    assert ratio == pytest.approx([1.0] * 20 + [3.0] * 30)
    assert column(result, "plant.extra").tolist() == [0.0] * 30 + [1.5] * 20


def test_an_injection_replaces_and_then_gives_back(write: Write) -> None:
    added = """
[[inject]]
to = "controller.in"
from_time = 0.01
to_time = 0.012
value = 9.0
[[inject]]
to = "controller.flag"
from_time = 0.02
to_time = 0.021
value = 1
"""
    result = run(write(added))
    seen, true = column(result, "controller.in"), column(result, "plant.x")
    assert seen[10:12].tolist() == [9.0, 9.0]
    assert np.delete(seen, [10, 11]).tolist() == np.delete(true, [10, 11]).tolist()
    assert np.flatnonzero(column(result, "controller.flag")).tolist() == [20]


def test_start_values_return_after_an_injection_in_every_run(write: Write) -> None:
    pulse = '[[inject]]\nto = "controller.{0}"\nfrom_time = 0.01\nto_time = {2}\nvalue = {1}\n'
    added = pulse.format("gain", 3.0, 0.02) + pulse.format("mode", 4, 1.0)
    with cosim.Session(cosim.load(write(added), set=["controller.gain=0.5"])) as session:
        for _ in range(2):
            result = session.run()
            ratio = column(result, "controller.out") / column(result, "controller.in")
            assert ratio == pytest.approx([0.5] * 10 + [3.0] * 10 + [0.5] * 30)
            assert column(result, "controller.mode_out").tolist() == [1.0] * 10 + [4.0] * 40


def test_commands_can_be_injected(write: Write) -> None:
    added = "".join(
        f'[[inject]]\nto = "plant.{name}"\nfrom_time = 0.01\nto_time = 0.012\nvalue = 9.0\n'
        for name in ("u", "extra")
    )
    result, plain = run(write(added)), run(write(name="plain.toml"))
    assert column(result, "plant.u")[10:12].tolist() == [9.0, 9.0]
    assert column(result, "plant.u")[:10].tolist() == column(plain, "plant.u")[:10].tolist()
    assert np.flatnonzero(column(result, "plant.extra")).tolist() == [10, 11]
    assert column(result, "plant.u")[12] == column(result, "controller.out")[11]


def test_nan_can_be_injected(write: Write) -> None:
    added = '[[inject]]\nto = "controller.in"\nfrom_time = 0.01\nto_time = 0.011\nvalue = nan\n'
    with pytest.raises(
        CosimError, match=r"`controller.out` is `nan`, it must be finite at t = 0.01 s \(step 10\)"
    ):
        run(write(added))


def test_stop_when_ends_the_run_with_the_row_that_holds(write: Write) -> None:
    result = run(write(), "loop.stop_when=controller.calls >= 7")
    assert column(result, "controller.calls").tolist() == [1, 2, 3, 4, 5, 6, 7]
    assert result.simulated_s == pytest.approx(0.007)


def test_inputs_that_nothing_drives_are_recorded_with_their_start_value(write: Write) -> None:
    result = run(write(), "controller.count=5", "controller.mode=Fast")
    assert set(column(result, "controller.count")) == {5.0}
    assert set(column(result, "controller.count_out")) == {6.0}
    assert set(column(result, "controller.mode_out")) == {4.0}


def test_the_same_seed_gives_the_same_bytes(write: Write) -> None:
    file = write()
    noisy = "wire.controller.in.noise=0.1"
    one, two, other = run(file, noisy, seed=3), run(file, noisy, seed=3), run(file, noisy, seed=4)
    assert one.trace is not None
    assert two.trace is not None
    assert other.trace is not None
    assert one.trace.tobytes() == two.trace.tobytes()
    assert one.trace.tobytes() != other.trace.tobytes()
    assert column(one, "plant.random")[0] != column(other, "plant.random")[0]


def test_a_reset_instance_is_as_good_as_a_fresh_one(write: Write) -> None:
    overrides = ["wire.controller.in.noise=0.1", "controller.gain=0.7", "controller.bias=[0.1, 0.2]"]
    scenario = cosim.load(write(), set=overrides)
    with cosim.Session(scenario) as session:
        session.run(1)
        again = session.run(2)
    fresh = cosim.run(scenario, 2)
    assert again.trace is not None
    assert fresh.trace is not None
    assert again.trace.tobytes() == fresh.trace.tobytes()


def test_many_runs_on_processes_equal_single_runs(write: Write) -> None:
    added = '[[metric]]\nname = "end"\nvalue = "last(plant.x) + last(plant.random)"\n'
    scenario = cosim.load(write(added), set=["wire.controller.in.noise=0.1"])
    seeds = [11, 12, 13, 14, 15]
    single = [cosim.run(scenario, seed).metrics["end"].value for seed in seeds]
    for workers in (1, 2):
        many = cosim.run_many(scenario, seeds, workers=workers)
        assert [result.seed for result in many] == seeds
        assert [result.metrics["end"].value for result in many] == single
        assert all(result.trace is None for result in many)


def test_each_of_many_scenarios_runs_with_its_own_seed_and_parameters(write: Write) -> None:
    added = '[[metric]]\nname = "end"\nvalue = "last(plant.x) + last(plant.random)"\n'
    file = write(added)
    changes = [
        ["controller.gain=0.2", "loop.seed=3"],
        ["plant.pole=0.1"],
        ["controller.gain=0.2", "loop.seed=4"],
    ]
    scenarios = [cosim.load(file, set=change) for change in changes]
    single = [cosim.run(scenario).metrics["end"].value for scenario in scenarios]
    assert len(set(single)) == 3
    for workers in (1, 2):
        each = [done for done in cosim.run_each(scenarios, workers) if isinstance(done, cosim.Result)]
        assert [result.seed for result in each] == [3, 1, 4]
        assert [result.metrics["end"].value for result in each] == single
    assert cosim.run_each([]) == []
    named = cosim.run_each([file, scenarios[0]], 1)
    assert [type(done) for done in named] == [cosim.Result, cosim.Result]


@pytest.mark.parametrize("workers", [1, 2])
def test_a_run_that_cannot_be_done_stops_no_other_scenario(write: Write, workers: int) -> None:
    file = write()
    changes = ["controller.fatal_at=5", "plant.fail_at=7", "plant.pole=9", "plant.pole=0.1"]
    scenarios = [cosim.load(file, set=[change]) for change in changes]
    fatal, failed, refused, good = cosim.run_each(scenarios, workers, keep_trace=True)
    assert isinstance(fatal, FmuError)
    assert isinstance(failed, PlantError)
    assert "failed at t = 0.007 s (step 7)" in failed.message
    assert isinstance(refused, CosimError)
    assert isinstance(good, cosim.Result)
    assert good.trace is not None
    assert len(good.trace) == 50


def test_the_first_error_of_many_seeds_ends_them(write: Write, monkeypatch: pytest.MonkeyPatch) -> None:
    begun = []

    def counted(jobs: Iterable[Numbered], workers: int, limits: Limits) -> Generator[Finished]:
        def taken() -> Generator[Numbered]:
            for job in jobs:
                begun.append(job[0])
                yield job

        return outcomes(taken(), workers, limits)

    monkeypatch.setattr("cosim.pool.executor.outcomes", counted)
    scenario = cosim.load(write(), set=["plant.fail_at=5"])
    with pytest.raises(PlantError):
        cosim.run_many(scenario, range(20_000), workers=2)
    assert 1 <= len(begun) < 1000


def test_an_error_in_a_worker_process_keeps_its_message(write: Write) -> None:
    scenario = cosim.load(write(), set=["controller.fail_at=5"])
    with pytest.raises(FmuError, match=r"failed on request at 0.005 s"):
        cosim.run_many(scenario, [1, 2], workers=2)


def test_an_error_of_the_fmu_names_step_time_and_its_words(write: Write) -> None:
    with pytest.raises(
        FmuError, match=r"failed at t = 0.02 s \(step 20\): failed on request at 0.02 s \(fmi2DoStep"
    ):
        run(write(), "controller.fail_at=20")


def test_nothing_is_called_after_a_fatal_error(write: Write) -> None:
    with pytest.raises(FmuError, match="fmi2Fatal"):
        run(write(), "controller.fatal_at=0")
    with cosim.Session(cosim.load(write(), set=["controller.fatal_at=0"])) as session:
        with pytest.raises(FmuError, match="fmi2Fatal"):
            session.run()
        with pytest.raises(FmuError, match="a new run needs a new instance"):
            session.run()


def test_a_session_continues_after_an_error(write: Write) -> None:
    with cosim.Session(cosim.load(write(), set=["plant.fail_at=5"])) as session:
        for _ in range(2):
            with pytest.raises(PlantError, match=r"step 5"):
                session.run()


def test_an_output_that_is_not_finite_names_the_variable(write: Write) -> None:
    with pytest.raises(
        CosimError, match=r"`controller.out` is `nan`, it must be finite at t = 0.02 s \(step 20\)"
    ):
        run(write(), "controller.nan_at=20", "wire.plant.u.maximum=1")


def test_a_reading_that_is_not_finite_names_the_channel(write: Write) -> None:
    with pytest.raises(CosimError, match=r"`plant.x` is `nan`, it must be finite at t = 0.003 s \(step 3\)"):
        run(write(), "plant.nan_at=3")


def test_an_exception_of_the_plant_names_plant_and_step(write: Write) -> None:
    with pytest.raises(
        PlantError, match=r"`probe_plants:Lag` failed at t = 0.003 s \(step 3\): RuntimeError"
    ):
        run(write(), "plant.fail_at=3")


def test_messages_of_the_fmu_reach_the_log(write: Write, caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.DEBUG, "cosim"), pytest.raises(FmuError):
        run(write(), "controller.fail_at=20")
    assert "Probe [logStatusError] failed on request at 0.02 s" in caplog.text


def test_progress_is_reported(write: Write) -> None:
    reported: list[tuple[int, int]] = []
    cosim.run(cosim.load(write(), set=["loop.duration=1.2"]), progress=lambda k, n: reported.append((k, n)))
    assert reported == [(0, 1200), (500, 1200), (1000, 1200)]


def test_a_plant_is_measured_once_in_a_step(write: Write, folder: Path) -> None:
    (folder / "sensing.py").write_text(
        "import probe_plants\nclass Sensing(probe_plants.Lag):\n    count = 0\n"
        "    def sense(self):\n        self.count += 1\n        return super().sense()\n"
    )
    with cosim.Session(cosim.load(write(), set=["plant.name=sensing:Sensing"])) as session:
        session.run()
        plant: Any = session.plant
    assert plant.count == 50
