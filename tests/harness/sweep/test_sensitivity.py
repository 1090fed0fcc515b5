"""Sensitivity of a sweep: indices of functions that are known in closed form, and what a user sees."""

from __future__ import annotations

import json
import math
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.stats

from cosim.study.parameters import Vary
from cosim.sweep.designs import DESIGNS, saltelli, values_by_key
from cosim.sweep.sensitivity import rank, sensitivities, sobol

from ..conftest import END
from . import studies

Write = Callable[..., Path]

A, B = 7.0, 0.1
"""Of the function of Ishigami and Homma: sin x1 + A sin^2 x2 + B x3^4 sin x1 with x in -pi .. pi."""


def ishigami(x: Any) -> Any:
    return np.sin(x[0]) + A * np.sin(x[1]) ** 2 + B * x[2] ** 4 * np.sin(x[0])


def ishigami_indices() -> tuple[list[float], list[float]]:
    """First-order and total indices by integration."""
    one = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2
    two = A**2 / 8.0
    both = B**2 * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    variance = one + two + both
    return [one / variance, two / variance, 0.0], [(one + both) / variance, two / variance, both / variance]


def table(function: Callable[[Any], Any], varied: list[Vary], samples: int) -> Any:
    """Values of a function at the points of a design."""
    cases = saltelli(varied, samples, seed=1)
    points = np.array([list(case.values()) for case in cases]).T
    return function(points).reshape(-1, len(varied) + 2)


ANGLES = [Vary(f"x{index}", minimum=-math.pi, maximum=math.pi) for index in (1, 2, 3)]


def test_indices_of_ishigami_are_those_of_its_integrals() -> None:
    found = sobol(table(ishigami, ANGLES, 4096), seed=1)
    expected = zip(*ishigami_indices(), strict=True)
    for (first, total), (s, t) in zip(found, expected, strict=True):
        assert first.value == pytest.approx(s, abs=0.02)
        assert total.value == pytest.approx(t, abs=0.02)
        for estimate, true in ((first, s), (total, t)):
            assert estimate.low - 0.01 <= true <= estimate.high + 0.01
            assert estimate.low <= estimate.value <= estimate.high


def test_indices_are_those_of_scipy() -> None:
    values = table(ishigami, ANGLES, 64)
    found = sobol(values, seed=1)
    parts = {
        "f_A": values[None, :, 0],
        "f_B": values[None, :, 1],
        "f_AB": values[:, None, 2:].T,
    }
    theirs = scipy.stats.sobol_indices(func=parts, n=64)
    assert [total.value for _, total in found] == pytest.approx(theirs.total_order.tolist())
    # they subtract the mean from f(A), too, which changes nothing in a difference
    assert [first.value for first, _ in found] == pytest.approx(theirs.first_order.tolist())


def test_a_sum_of_independent_keys_has_the_same_first_and_total_indices() -> None:
    varied = [Vary("a", minimum=0.0, maximum=1.0), Vary("b", minimum=0.0, maximum=2.0)]
    for (first, total), share in zip(sobol(table(sum, varied, 1024), seed=1), (0.2, 0.8), strict=True):
        assert first.value == pytest.approx(share, abs=0.01)
        assert total.value == pytest.approx(share, abs=0.01)


def test_the_same_seed_gives_the_same_intervals() -> None:
    values = table(ishigami, ANGLES, 32)
    assert sobol(values, seed=5) == sobol(values, seed=5)


def test_more_samples_only_add_to_a_design() -> None:
    assert saltelli(ANGLES, 40, seed=3)[: 24 * 5] == saltelli(ANGLES, 24, seed=3)


def test_rank_correlation_is_one_where_a_metric_only_rises() -> None:
    x = np.linspace(-1.0, 1.0, 40)
    for y, value in ((np.exp(5.0 * x), 1.0), (-(x**3), -1.0)):
        found = rank(x, y)
        assert found.value == pytest.approx(value)
        assert abs(found.low) > 0.99
    with_holes = np.where(np.arange(40) % 7 == 3, np.nan, x)
    assert rank(with_holes, np.exp(x)).value == pytest.approx(1.0)


def test_the_rank_correlation_is_that_of_scipy_with_equal_numbers_too() -> None:
    random = np.random.default_rng(6)
    for _ in range(20):
        x, y = (random.integers(0, most, 30).astype(float) for most in (6, 9))
        assert rank(x, y).value == pytest.approx(scipy.stats.spearmanr(x, y).statistic, abs=1e-12)


def test_the_interval_of_a_rank_correlation_holds_the_true_one_in_95_of_100() -> None:
    random = np.random.default_rng(1)
    rho, held = 0.9, 0
    # of a normal distribution in two dimensions
    true = 6.0 / math.pi * math.asin(rho / 2.0)
    for _ in range(2000):
        x = random.normal(size=50)
        found = rank(x, rho * x + math.sqrt(1.0 - rho**2) * random.normal(size=50))
        held += found.low <= true <= found.high
    assert 0.935 < held / 2000 < 0.965


def test_noise_is_not_clear_of_zero_and_a_constant_says_nothing() -> None:
    random = np.random.default_rng(2)
    found = rank(random.normal(size=30), random.normal(size=30))
    assert found.low < 0.0 < found.high
    assert math.isnan(rank(np.ones(30), random.normal(size=30)).value)


def is_significant(kind: str, cases: int, repeats: int, seed: int) -> bool:
    """Whether a key without effect is shown as one with an effect."""
    random = np.random.default_rng(seed)
    keys = [Vary(f"plant.k{index}", minimum=0.0, maximum=1.0) for index in range(2)]
    design = DESIGNS[kind](keys, cases, seed)
    rows = [number for number in range(cases) for _ in range(repeats)]
    values = [design[number]["plant.k0"] + 0.05 * random.normal() for number in rows]
    columns: dict[str, list[Any]] = {key.key: [design[number][key.key] for number in rows] for key in keys}
    columns |= {"case": rows, "status": ["passed"] * len(rows), "metric.y": values}
    study = SimpleNamespace(design=SimpleNamespace(kind=kind), vary=keys)
    scenario = SimpleNamespace(metric=[SimpleNamespace(name="y")])
    varying = values_by_key(design)
    plan: Any = SimpleNamespace(cases=design, varying=varying, study=study, scenario=scenario)
    found = {entry.key: entry.rank for entry in sensitivities(plan, columns)}
    return found["plant.k1"].low > 0.0 or found["plant.k1"].high < 0.0


@pytest.mark.parametrize("kind", ["latin-hypercube", "monte-carlo"])
def test_repeats_of_a_case_do_not_make_a_key_significant(kind: str) -> None:
    # nominally 10 of 200; three standard deviations of that are 9.2. Rows counted one by one give over 90
    assert sum(is_significant(kind, 50, 10, seed) for seed in range(200)) <= 20


STUDY = """
scenario = "lag.toml"
vary = [
    {key = "controller.gain", minimum = 0.2, maximum = 0.9},
    {key = "wire.plant.u.noise", minimum = 0.0, maximum = 1e-9},
    {key = "plant.label", values = ["a", "b"]},
]

[design]
kind = "saltelli"
samples = 16
seeds = "repeat"
"""


def test_a_sweep_shows_what_moves_its_metrics(write: Write, folder: Path) -> None:
    write(END)
    (folder / "s.toml").write_text(STUDY)
    command = [sys.executable, "-m", "cosim", "sweep", "s.toml", "--json", "-"]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120)
    assert done.returncode in (0, 1), done.stderr
    survey = json.loads(done.stdout)
    assert survey["runs"] == 16 * 5
    first, second = survey["sensitivity"]
    assert (first["metric"], first["key"], second["key"]) == ("end", "controller.gain", "wire.plant.u.noise")
    assert first["rank"]["value"] > 0.95
    assert first["total"]["value"] == pytest.approx(1.0, abs=0.35)
    assert second["total"]["value"] < 0.01
    assert (folder / "s.sweep" / "sensitivity.svg").stat().st_size > 10_000

    # again without runs: the same words and bytes
    before = (folder / "s.sweep" / "sensitivity.svg").read_bytes()
    again = subprocess.run(command[:-2], capture_output=True, text=True, check=False, timeout=120)
    assert (folder / "s.sweep" / "sensitivity.svg").read_bytes() == before
    (line,) = [line for line in again.stdout.splitlines() if "sensitivity of" in line]
    assert line.split() == ["sensitivity", "of", "controller.gain", "wire.plant.u.noise"]


def test_indices_are_reported_of_the_samples_that_are_whole(write: Write, folder: Path) -> None:
    write(END)
    (folder / "s.toml").write_text(STUDY)
    studies.sweep("s.toml")
    file = folder / "s.sweep" / "results.jsonl"
    lines = file.read_text().splitlines(keepends=True)
    rows = [json.loads(line) for line in lines]
    # without this one the variance is unknown
    (place,) = [place for place, row in enumerate(rows) if row["case"] == 5]
    crashed = rows[place]
    lines[place] = json.dumps({**crashed, "status": "crashed", "reason": "test", "metrics": {}}) + "\n"
    file.write_text("".join(lines))
    done = studies.sweep("s.toml", "--json", "-")
    (first, _) = json.loads(done.stdout)["sensitivity"]
    assert first["total"]["value"] == pytest.approx(1.0, abs=0.4)
