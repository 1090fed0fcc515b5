"""Comparing hashes: errors, reported changes, and changes that the map allows."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from . import compare, record
from .compare import Changes, Controller, Difference, Intended, Renamed
from .record import Recorded, Recording

BEFORE = Recorded("05", {"time": "01", "controller.force": "02", "controller.state": "03:Idle,Run"})


def now(state: str = "05", **columns: str | None) -> Recorded:
    """Return the new run, in another order, with some columns changed (`__` is a dot) or removed."""
    changed = {
        **dict(reversed(BEFORE.columns.items())),
        **{k.replace("__", "."): v for k, v in columns.items()},
    }
    return Recorded(state, {name: value for name, value in changed.items() if value is not None})


def found(
    run: Recorded, changes: Changes | None = None, scenario: str = "dob/paper"
) -> list[tuple[str, str]]:
    differences = compare.compare(scenario, BEFORE, run, changes or Changes())
    assert all(one.scenario == scenario for one in differences)
    return [(one.column, one.kind) for one in differences]


def renaming(**columns: Renamed) -> Changes:
    return Changes({"dob": {name.replace("__", "."): new for name, new in columns.items()}})


def test_the_same_values_in_another_order_are_the_same() -> None:
    assert found(now()) == []


def test_a_changed_value_is_an_error() -> None:
    assert found(now(controller__force="12")) == [("controller.force", "changed")]


def test_a_changed_end_state_is_an_error() -> None:
    assert found(now(state="15")) == [("end state", "changed")]


def test_a_missing_column_is_an_error_and_a_new_one_is_reported() -> None:
    run = now(controller__force=None, controller__load="02", controller__other="07")
    differences = compare.compare("dob/paper", BEFORE, run, Changes())
    assert differences == [
        Difference("dob/paper", "controller.force", "missing", "`controller.load` has its values"),
        Difference("dob/paper", "controller.load", "new"),
        Difference("dob/paper", "controller.other", "new"),
    ]
    assert [one.fault for one in differences] == [True, False, False]


def test_a_renamed_column_keeps_its_values() -> None:
    changes = renaming(controller__force=Renamed("controller.load"))
    assert found(now(controller__force=None, controller__load="02"), changes) == []
    run = now(controller__force=None, controller__load="12")
    assert found(run, changes) == [("controller.load", "changed")]
    # a name that another column uses now
    assert found(now(), changes) == [("controller.load", "missing"), ("controller.force", "new")]
    assert found(now(), changes, "fts/paper") == []


def test_renamed_items_keep_their_order() -> None:
    run = now(controller__state="03:Idle,Cut")
    assert found(run) == [("controller.state", "changed")]
    changes = renaming(controller__state=Renamed("controller.state", {"Run": "Cut"}))
    assert found(run, changes) == []
    assert found(now(controller__state="13:Idle,Cut"), changes) == [("controller.state", "changed")]


def test_names_of_a_controller_are_those_of_its_map() -> None:
    names = Controller({"controller.force": "controller.load"}, {"Run": "Cut"})
    changes = Changes(controllers={"dob": names})
    run = now(controller__force=None, controller__load="02", controller__state="03:Idle,Cut")
    assert found(run, changes) == []
    assert found(run, changes, "fts/paper") != []
    removed = Changes(controllers={"dob": Controller({"controller.force": ""})})
    assert found(now(controller__force=None), removed) == []


def test_an_exception_covers_its_columns_and_no_more() -> None:
    changes = Changes(exceptions=[Intended("dob/pa*", ["controller.f*", "end state"], "other order of sums")])
    run = now(state="15", controller__force="12", time="11")
    expected = [("time", "changed"), ("controller.force", "intended"), ("end state", "intended")]
    assert found(run, changes) == expected
    assert ("controller.force", "changed") in found(run, changes, "dob/nan")
    assert not any(one.fault for one in compare.compare("dob/paper", BEFORE, now(state="15"), changes))


def test_the_hash_depends_on_type_sign_and_order() -> None:
    values = np.array([0.0, 1.0])
    others = [
        np.array([-0.0, 1.0]),
        values[::-1],
        values.astype(np.float32),
        values.view(np.int64),
        values[:1],
    ]
    assert record.digest(np.repeat(values, 2)[::2]) == record.digest(values)
    assert len({record.digest(one) for one in [values, *others]}) == 6


def test_an_enumeration_is_a_sequence_of_items_whatever_their_numbers() -> None:
    before = record.enumeration(np.array([3.0, 3.0, 1.0, 3.0, 2.0]), {"A": 1, "B": 2, "C": 3})
    after = record.enumeration(np.array([1.0, 1.0, 7.0, 1.0, 4.0]), {"C": 1, "B": 4, "A": 7})
    other = record.enumeration(np.array([3.0, 1.0, 1.0, 3.0, 2.0]), {"A": 1, "B": 2, "C": 3})
    assert before == after
    assert before.endswith(":C,A,B")
    assert other != before
    assert other.endswith(":C,A,B")


@pytest.mark.parametrize(
    ("pattern", "fitting"),
    [
        ("dob", ["dob", "dob/paper"]),
        ("dob/*", ["dob/paper"]),
        ("*/paper", ["dob/paper", "fts/paper"]),
        ("*", ["dob", "dob/paper", "fts", "fts/paper"]),
        ("do", []),
    ],
)
def test_a_pattern_is_a_loop_or_some_of_its_variants(pattern: str, fitting: list[str]) -> None:
    assert record.selected(["dob", "dob/paper", "fts", "fts/paper"], [pattern]) == fitting


def test_a_recording_is_read_as_written_one_line_per_scenario(tmp_path: Path) -> None:
    file = tmp_path / "recording.json"
    recording = Recording({"numpy": "2"}, {"dob": BEFORE, "dob/paper": now(state="15")})
    record.write(recording, file)
    assert record.read(file) == recording
    assert [line[:6] for line in file.read_text().splitlines() if "time" in line] == ['"dob":', '"dob/p']


def test_the_map_is_read_and_a_wrong_key_in_it_is_an_error(tmp_path: Path) -> None:
    file = tmp_path / "renamed.toml"
    file.write_text(
        '["dob/pa*"]\n"a" = "b"\n"s" = { items = { X = "Y" } }\n'
        '[[exception]]\nscenarios = "fts"\ncolumns = ["c"]\nreason = "why"\n'
    )
    table = {"a": Renamed("b"), "s": Renamed("s", {"X": "Y"})}
    found = compare.read(file)
    assert (found.renamed, found.exceptions) == ({"dob/pa*": table}, [Intended("fts", ["c"], "why")])
    file.write_text('[dob]\n"s" = { item = { X = "Y" } }\n')
    with pytest.raises(TypeError, match="item"):
        compare.read(file)


def test_the_map_of_the_project_names_recorded_columns() -> None:
    recording, changes = record.read(), compare.read()
    for pattern, table in changes.renamed.items():
        fitting = record.selected(recording.scenarios, [pattern])
        assert fitting, pattern
        assert set(table) <= {c for name in fitting for c in recording.scenarios[name].columns}, pattern
    for exception in changes.exceptions:
        assert record.selected(recording.scenarios, [exception.scenarios]), exception
