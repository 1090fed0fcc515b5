"""`cosim run --seeds`: many seeds, one table, one exit code."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest

import cosim as api
from cosim.errors import CosimError
from cosim.sweep import seeds

from .commands import cosim

Write = Callable[..., Path]
NOISY = """
[[metric]]
name = "random"
unit = "m"
value = "last(plant.random)"
[[criterion]]
id = "small"
claim = "The number is small"
metric = "random"
maximum = {}
"""


@pytest.mark.parametrize(
    ("text", "expected"),
    [("1..4", [1, 2, 3, 4]), ("7", [7]), ("3, 1,2", [3, 1, 2]), ("1..3,9", [1, 2, 3, 9]), ("0..0", [0])],
)
def test_seeds_are_ranges_and_lists(text: str, expected: list[int]) -> None:
    assert seeds.parse(text) == expected


@pytest.mark.parametrize(
    ("text", "reported"),
    [
        ("", "not a seed or range"),
        ("1...4", "`1...4` is not a seed or range\nhint: Give seeds as `1..20`"),
        ("-1..4", "not a seed or range"),
        ("4..1", "ends before it starts\nhint: Use `1..4`."),
        ("1..3,2", "names the seed 2 twice"),
        ("1..1000000000000", "more than 100000 seeds\nhint: Use a study"),
    ],
)
def test_what_is_no_seed_is_reported(text: str, reported: str) -> None:
    with pytest.raises(CosimError, match=re.escape(reported)):
        seeds.parse(text)


def test_the_runs_are_those_of_single_seeds_in_one_list(write: Write) -> None:
    scenario = api.load(write(NOISY.format(100)))
    done = cosim("run", "lag.toml", "--seeds", "1..3,8", "--json", "-")
    found = json.loads(done.stdout)
    assert done.returncode == 0
    assert [run["seed"] for run in found] == [1, 2, 3, 8]
    alone = [api.run(scenario, seed).metrics["random"].value for seed in (1, 2, 3, 8)]
    assert [run["metrics"]["random"]["value"] for run in found] == alone
    assert len(set(alone)) == 4


def test_one_seed_that_fails_is_exit_code_1_and_the_table_shows_how_many(write: Write) -> None:
    scenario = api.load(write(NOISY.format(100)))
    numbers = sorted(api.run(scenario, seed).metrics["random"].value for seed in range(1, 6))
    write(NOISY.format((numbers[3] + numbers[4]) / 2.0))
    done = cosim("run", "lag.toml", "--seeds", "1..5", "--json", "runs.json")
    assert done.returncode == 1
    assert re.search(r"small +4 of 5 +The number is small", done.stdout)
    assert "5 of 5 runs: 4 passed, 1 failed; 80 % passed (95 % confidence: 37.6 .. 96.4 %)" in done.stdout
    assert [run["passed"] for run in json.loads(Path("runs.json").read_text())].count(False) == 1


def test_runs_without_a_result_are_exit_code_2_and_are_reported(write: Write) -> None:
    write(NOISY.format(100))
    done = cosim("run", "lag.toml", "--seeds", "4..6", "--set", "plant.fail_at=3", "--json", "runs.json")
    assert done.returncode == 2
    assert re.search(r"error +3 +4 +the plant .* failed on request", done.stdout)
    assert "error: 3 of 3 runs gave no result; the first: the plant `probe_plants:Lag` failed" in done.stderr
    assert all("failed on request" in run["error"] for run in json.loads(Path("runs.json").read_text()))


@pytest.mark.parametrize("option", [("--seed", "1"), ("--trace", "a.npz"), ("--plot", "a.svg")])
def test_options_of_one_run_are_rejected(write: Write, option: tuple[str, str]) -> None:
    write()
    done = cosim("run", "lag.toml", "--seeds", "1..3", *option)
    assert done.returncode == 2
    assert done.stderr.startswith(f"error: `{option[0]}` and `--seeds` cannot be given together\nhint: ")
