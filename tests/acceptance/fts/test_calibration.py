"""Identification and calibration of the fast tool servo in its machine.

The large samples run with `pytest -m full -rP tests/acceptance/fts/test_calibration.py`, which prints the
measured values.
"""

import json
import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import cosim

from ..measured.store import measured
from ..samples.runs import run, trace, value

pytestmark = pytest.mark.acceptance

PAGE = (Path(__file__).parents[3] / "fmu-fts/doc/path.md").read_text(encoding="utf-8")

# not used for tuning
SOME = (63_001,)
MANY = tuple(range(64_001, 64_021))
NOMINAL = "plant.torque_gain=1.0"
"""The machine of the measured response, as in `fts/identify`. With the response of another drive
feedforward leaves more: 0.54 % of the path instead of 0.26 % if the drive delivers 3 % less. Measured on
that drive it leaves 0.27 %."""

# frequency response


def test_a_measured_response_can_be_loaded_from_a_file(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    # the frequencies of the lens are enough here
    first = run(
        "fts/identify",
        "controller.expert.identify.frequencies='20, 40, 60, 120, 240'",
        "signal.plant.speed_change.times=[0.0, 1.0]",
        "signal.controller.mode.times=[0.0, 3.2]",
        "signal.plant.cutting.times=[0.0, 3.7]",
        "loop.duration=4.6",
    )
    # the example of the page writes the file
    example = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)[0]
    monkeypatch.chdir(tmp_path)
    exec(example, {"result": first})
    table = json.loads((tmp_path / "response.json").read_text(encoding="utf-8"))
    assert table["frequency_hz"] == pytest.approx([20.0, 40.0, 60.0, 120.0, 240.0])
    again = run("fts/feedforward", f"controller.response.file='{tmp_path / 'response.json'}'", NOMINAL)
    ratio = value(again, "twice") / 1748e-6
    print(f"in the same run {100 * value(first, 'error_ratio'):.2f} %, from the file {100 * ratio:.2f} %")
    assert value(first, "error_ratio") <= 0.005
    assert ratio <= 0.005
    # the response is in use from the first sample on
    rows = trace(again)
    for i, magnitude in enumerate(table["magnitude"], start=1):
        assert rows[f"controller.response.magnitude[{i}]"] == pytest.approx(magnitude)


def test_the_response_in_the_resources_of_the_fmu_is_that_of_the_nominal_machine() -> None:
    result = run("fts/feedforward", "controller.response.file='response.json'", NOMINAL)
    weaker = run("fts/feedforward", "controller.response.file='response.json'")
    ratios = [value(one, "twice") / 1748e-6 for one in (result, weaker)]
    print(" and ".join(f"{100 * ratio:.2f} %" for ratio in ratios))
    assert ratios[0] <= 0.005
    # the drive of `fts` is 3 % weaker: the response is of another drive
    assert 0.005 < ratios[1] <= 0.008
    assert trace(result)["controller.response.frequency[17]"][-1] == 0.0


def test_without_the_thrust_twice_a_turn_nothing_is_left_at_n_2() -> None:
    result = run("fts/identify", "plant.cutting_force_twice=0.0")
    print(f"{100 * value(result, 'error_ratio'):.4f} %")
    assert value(result, "error_ratio") < 2e-4


def test_the_measurement_takes_its_calculated_duration() -> None:
    with cosim.Session(cosim.load("fts/identify", set=["loop.duration=6.0"]), engine="native") as session:
        rows = trace(session.run())
        duration = session.fmu.read(session.file.variables["expert.identify.duration"])
    progress = rows["controller.identify.progress"]
    began, ended = rows["time"][progress > 0.0][0], rows["time"][progress >= 1.0][0]
    assert ended - began == pytest.approx(duration, abs=2e-4)


def test_friction_falsifies_a_response_measured_at_a_small_amplitude() -> None:
    small = run("fts/identify", "controller.identify.amplitude=5e-4")
    print(f"at 0.5 mm {100 * value(small, 'error_ratio'):.2f} %")
    assert 0.006 < value(small, "error_ratio") < 0.02


@pytest.mark.parametrize("delay", [0, 2])
@pytest.mark.full
def test_the_response_holds_with_other_delays(delay: int) -> None:
    delays = {
        0: ("loop.compute_delay=0", "controller.io_delay=0"),
        2: ("controller.io_delay=2", "wire.plant.torque.delay=1"),
    }
    result = run("fts/identify", *delays[delay])
    print(
        f"delay {delay}: {value(result, 'bandwidth'):.1f} Hz, {value(result, 'phase_margin'):.1f} deg, "
        f"Ms {value(result, 'sensitivity'):.2f}, feedforward {100 * value(result, 'error_ratio'):.2f} %"
    )
    assert value(result, "bandwidth") == pytest.approx(230.0, abs=7.0)
    loop = {name: value(result, name) for name in ("bandwidth", "phase_margin", "sensitivity")}
    row = {0: "no delay", 2: "two samples"}[delay]
    measured("fts-loop", row, **loop, error_ratio=100.0 * value(result, "error_ratio"))
    assert value(result, "error_ratio") <= 0.005
    assert value(result, "good")


@pytest.mark.parametrize(
    ("parameter", "text", "parts"),
    [
        ("response.file", '{"frequency_hz": [20, 10]}', ("missing field `magnitude`", "line 1 column")),
        (
            "response.file",
            '{"frequency_hz": [20, 10], "magnitude": [1, 1], "phase_rad": [0, 0]}',
            ("`frequency_hz[1]` is `10`", "limits `20."),
        ),
        ("path.file", '{"slide_start_m": 0,\n "depth": 1}', ("unknown field `depth`", "line 2 column")),
        (
            "path.file",
            '{"slide_start_m": 0, "slide_step_m": 1, "cosine_m": [[0], [0], [1]], "sine_m": [[0], [0], [0]]}',
            ("`slide_step_m` is `1`", "`0.000001` to `0.1`"),
        ),
    ],
)
def test_a_malformed_file_is_refused_before_anything_moves(
    parameter: str, text: str, parts: tuple[str, ...], tmp_path: Path
) -> None:
    file = tmp_path / "table.json"
    file.write_text(text, encoding="utf-8")
    kind = "File" if parameter == "path.file" else "Toric"
    with pytest.raises(cosim.CosimError) as refused:
        run(
            "fts",
            f"controller.surface.kind='{kind}'",
            f"controller.{parameter}='{file}'",
            "loop.duration=0.1",
        )
    for part in (f"parameter `{parameter}` is `{file}`", "hint: ", *parts):
        assert part in str(refused.value), refused.value


def test_a_path_from_a_file_is_followed(tmp_path: Path) -> None:
    # 1 mm twice and 0.1 mm three times per revolution, deeper towards the spindle axis
    rows = 41
    depth = np.linspace(0.0, 2e-3, rows)
    cosine = [[z, 0.0, 1e-3, 0.0] for z in depth.tolist()]
    sine = [[0.0, 0.0, 0.0, 1e-4] for _ in range(rows)]
    table = {"slide_start_m": 0.02, "slide_step_m": 1e-3, "cosine_m": cosine, "sine_m": sine}
    file = tmp_path / "path.json"
    file.write_text(json.dumps(table), encoding="utf-8")
    result = run(
        "fts", "controller.surface.kind='File'", f"controller.path.file='{file}'", "loop.duration=2.0"
    )
    rows_of = trace(result)
    theta, x = rows_of["controller.spindle_angle"], rows_of["controller.slide_position"]
    wanted = (x - 0.02) / 0.04 * 2e-3 + 1e-3 * np.cos(2 * theta) + 1e-4 * np.sin(3 * theta)
    late = rows_of["time"] > 0.5
    assert np.abs(rows_of["controller.reference.depth"] - wanted)[late].max() < 1e-9
    assert value(result, "rms") <= 0.5e-6


# calibration


@dataclass(frozen=True)
class Machine:
    """Geometry of a machine, which differs from the configured values."""

    arm_length: float
    center_offset: float
    arm_zero: float

    def changes(self) -> tuple[str, ...]:
        return (
            f"plant.arm_length={self.arm_length!r}",
            f"plant.center_offset={self.center_offset!r}",
            f"plant.arm_zero={self.arm_zero!r}",
        )


@dataclass(frozen=True)
class Calibrated:
    """Errors of a calibration, each with its reported standard deviation."""

    length: float
    length_std: float
    offset: float
    offset_std: float
    zero: float
    zero_std: float


def draw(seed: int) -> Machine:
    """Sample a machine with geometry errors of up to 0.1 mm and 1 mrad."""
    random = np.random.default_rng(seed)
    return Machine(
        arm_length=0.08 + random.uniform(-1e-4, 1e-4),
        center_offset=0.15 + random.uniform(-1e-4, 1e-4),
        arm_zero=0.0523 + random.uniform(-1e-3, 1e-3),
    )


def calibrate(seed: int, flats: str = "fts/calibrate-flats") -> Calibrated:
    """Calibrate with a toroid, then with flats and the arm length and standard deviation of the toroid."""
    machine = draw(seed)
    rows = trace(run("fts/calibrate-toroid", *machine.changes(), seed=seed))
    toroid = {
        name: float(rows[f"controller.calibration.{name}"][-1])
        for name in ("arm_length", "arm_length_std", "center_offset", "center_offset_std")
    }
    result = run(
        flats,
        *machine.changes(),
        f"controller.tool.arm_length=[{toroid['arm_length']!r}, 0.08]",
        f"controller.expert.tool.arm_length_std=[{toroid['arm_length_std']!r}, 1e-6]",
        seed=seed,
    )
    assert value(result, "solved")
    rows = trace(result)
    zero = float(rows["controller.calibration.arm_zero"][-1])
    return Calibrated(
        toroid["arm_length"] - machine.arm_length,
        toroid["arm_length_std"],
        toroid["center_offset"] - machine.center_offset,
        toroid["center_offset_std"],
        zero - machine.arm_zero,
        float(rows["controller.calibration.arm_zero_std"][-1]),
    )


def calibrations(seeds: tuple[int, ...]) -> dict[str, dict[str, float]]:
    """Calibrate a machine for each seed; return the errors of each length and angle in um and mrad."""
    all_of = [calibrate(seed) for seed in seeds]
    errors = np.array([(one.length, one.offset, one.zero) for one in all_of])
    sigmas = np.array([(one.length_std, one.offset_std, one.zero_std) for one in all_of])
    largest, rms = np.abs(errors).max(axis=0), np.sqrt(np.mean(errors**2, axis=0))
    ratio = np.sqrt(np.mean((errors / sigmas) ** 2, axis=0))
    found = {}
    for i, (name, unit, scale) in enumerate(
        (("arm length", "um", 1e6), ("cross-slide offset", "um", 1e6), ("arm zero", "mrad", 1e3))
    ):
        print(
            f"{len(seeds)} machines: {name} rms {scale * rms[i]:.4f}, max {scale * largest[i]:.4f} {unit}, "
            f"reported {scale * np.median(sigmas[:, i]):.4f}, rms over it {ratio[i]:.2f}"
        )
        errors_of = {"rms": rms[i], "most": largest[i], "claimed": np.median(sigmas[:, i])}
        found[name] = {"machines": len(seeds), **{key: scale * float(one) for key, one in errors_of.items()}}
    assert largest[0] <= 1.5e-6
    assert largest[1] <= 1.5e-6
    assert largest[2] <= 0.02e-3
    assert rms[2] <= 0.01e-3
    # the standard deviations are realistic: neither far too small nor far too large
    assert np.all(np.abs(errors) < 4.0 * sigmas)
    if len(seeds) >= 20:
        assert np.all(ratio < 1.4)
        assert np.all(sigmas < [0.6e-6, 0.6e-6, 0.01e-3])
    return found


def test_calibration_of_a_drawn_machine() -> None:
    calibrations(SOME)


@pytest.mark.full
def test_calibration_of_20_machines() -> None:
    for name, values in calibrations(MANY).items():
        measured("fts-calibration", name, **values)


@pytest.mark.full
def test_the_standard_deviation_of_the_zero_is_large_square_to_the_spindle() -> None:
    errors = []
    for seed in MANY[:5]:
        one = calibrate(seed, "fts/calibrate-flats-square")
        print(f"error {1e3 * one.zero:.4f} mrad, reported {1e3 * one.zero_std:.4f} mrad")
        assert one.zero_std > 0.03e-3
        assert abs(one.zero) < 4.0 * one.zero_std
        errors.append(one.zero / one.zero_std)
    assert np.sqrt(np.mean(np.square(errors))) < 2.0


@pytest.mark.full
def test_without_the_bend_of_the_arm_the_zero_is_off_by_what_2_newton_do() -> None:
    # the controller assumes a rigid arm
    result = run("fts/calibrate-flats", "controller.tip.frequency=0.0")
    print(f"error {1e3 * value(result, 'zero_error'):.4f} mrad")
    assert value(result, "zero_error") == pytest.approx(-11e-6, abs=5e-6)
