"""Numbers of the pages from one run of a scenario with its own seed."""

import functools

import pytest

import cosim

from .store import measured

PATH_TWICE = 1748e-6
"""Amplitude of the 0x4 lens twice per revolution, m."""
PERCENT = {"twice": 100.0 / PATH_TWICE}
MICROMETRES = {"rms": 1e6, "tip": 1e6}
FORCE = dict.fromkeys(("force_mean", "force_std", "force_least", "overshoot", "gain"), 1.0)
MILLIMETRES = {"error_1": 1e3, "error_3": 1e3}
ROWS = {
    "fts": {
        "fts/feedback": {"rms": 1e6},
        "fts/feedforward": PERCENT,
        "fts/paper": {"rms": 1e6, "twelfth": 1.0},
        "fts/500hz": MICROMETRES,
    },
    "fts-loop": {
        "fts/identify": {"bandwidth": 1.0, "phase_margin": 1.0, "sensitivity": 1.0, "error_ratio": 100.0},
    },
    "deburr": {
        "deburr/bare": MILLIMETRES,
        "deburr/paper": MILLIMETRES,
        "deburr/six-axis": {"tip": 1e3},
        "deburr/round-trip": {"ratio_11": 1.0, "best": 1.0},
    },
    "polish-surfaces": {
        **dict.fromkeys(
            ("polish", "polish/sphere", "polish/saddle", "polish/freeform", "polish/steep"), FORCE
        ),
        **dict.fromkeys(
            ("polish/20-mm-s", "polish/impedance", "polish/no-stick-slip", "polish/500-hz"), FORCE
        ),
        "polish/paper": FORCE,
    },
    "polish": {
        "polish": {"force_mean": 1.0, "force_std": 1.0, "gain": 1.0},
        "polish/impedance": {"force_mean": 1.0, "force_std": 1.0},
        "polish/no-stick-slip": {"force_mean": 1.0, "force_std": 1.0, "gain": 1.0},
        "polish/500-hz": {"gain": 1.0},
    },
}
"""Metrics of a row, named as its scenario, with the factor to the unit of the table."""


@functools.cache
def run(name: str) -> cosim.Result:
    """Run a scenario with its own seed, once for all tables that have it."""
    return cosim.run(cosim.load(name), engine="native")


@pytest.mark.acceptance
@pytest.mark.parametrize(("table", "row"), [(table, row) for table, rows in ROWS.items() for row in rows])
def test_a_row_shows_the_result_of_its_scenario(table: str, row: str) -> None:
    found = run(row).metrics
    measured(table, row, **{name: factor * found[name].value for name, factor in ROWS[table][row].items()})
