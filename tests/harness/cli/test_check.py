"""`cosim check`: scenarios and studies looked at without a run."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from cosim.check import lint
from cosim.check.files import check, file_of
from cosim.loop.session import Session
from cosim.scenario.load import load

from ..conftest import END, SCENARIO, entry
from .commands import called, cosim

Write = Callable[..., Path]
COMPLETE = (
    END
    + entry("signal", to="plant.extra", times=[0.0], values=[0.0])
    + entry("criterion", id="end", claim="The lag settles", metric="end", maximum=0.7)
)
STUDY = """
scenario = "lag.toml"
[design]
kind = "grid"
[[vary]]
key = "plant.pole"
values = [0.1, {}]
"""


def test_good_files_are_fit_and_nothing_is_run(write: Write, folder: Path) -> None:
    # the plant would fail after its first step; its measurements at t = 0 are inputs of the initialization
    write(COMPLETE + "[plant.parameters]\nfail_at = 1\n")
    (folder / "study.toml").write_text(STUDY.format(0.2))
    done = cosim("check", "lag.toml", "study.toml")
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "lag.toml: scenario, valid\nstudy.toml: study, 2 runs, valid\n"


OPTIMIZATION = """
scenario = "lag.toml"
vary = [{{key = "plant.pole", minimum = 0.1, maximum = {}}}]
objective = {{metric = "end"}}
search = {{trials = 20, seeds = [1, 2]}}
"""


def test_an_optimization_is_checked_at_both_ends(write: Write, folder: Path) -> None:
    write(COMPLETE + "[plant.parameters]\nfail_at = 1\n")
    (folder / "good.toml").write_text(OPTIMIZATION.format(0.9))
    (folder / "bad.toml").write_text(OPTIMIZATION.format(1.5))
    done = called("check", "good.toml", "bad.toml")
    assert done.returncode == 2
    assert done.stdout == "good.toml: optimization, 40 runs, valid\n"
    assert "`plant.pole` is `1.5`, it must be in 0 .. 1" in done.stderr


def test_the_studies_of_the_project_are_known_in_any_folder(folder: Path) -> None:
    assert file_of("studies/dob-contact.toml").is_file()
    found = check("studies/dob-contcat.toml")
    assert found.error is not None
    assert "the study file `studies/dob-contcat.toml` does not exist" in found.error.message
    assert "studies/dob-contact.toml" in found.error.hint


def test_a_file_is_named_once(write: Write, folder: Path) -> None:
    write(COMPLETE)
    (folder / "bad.toml").write_text(STUDY.format(7.0))
    done = called("check", "./bad.toml", "none.toml")
    first, second = (line for line in done.stderr.splitlines() if line.startswith("error: "))
    assert first.startswith("error: `bad.toml`, case 1: ")
    assert first.count("bad.toml") == 1
    assert second.startswith("error: `none.toml`: the scenario file `none.toml`")


def test_one_bad_file_of_three_is_exit_code_2_and_the_others_are_reported(write: Write, folder: Path) -> None:
    write(COMPLETE)
    (folder / "bad.toml").write_text(STUDY.format(7.0))
    done = called("check", "bad.toml", "none.toml", "lag.toml", "--json", "-")
    assert done.returncode == 2
    bad, none, good = json.loads(done.stdout)
    assert (bad["kind"], bad["ok"], bad["runs"]) == ("study", False, 0)
    assert "`plant.pole` is `7.0`, it must be in 0 .. 1" in bad["error"]["message"]
    assert none["error"] == {
        "message": "the scenario file `none.toml` does not exist",
        "hint": "List the known names with `cosim list`.",
    }
    assert good == {
        "file": "lag.toml", "kind": "scenario", "status": "valid", "ok": True, "runs": 1, "error": None,
        "warnings": [],
    }  # fmt: skip


@pytest.mark.parametrize(
    ("added", "reported"),
    [
        ("[controller.parameters]\ngian = 1.0\n", "no variable `gian`"),
        ("[controller.parameters]\ngain = 99.0\n", "the FMU rejected"),
        ("[plant.parameters]\npole = 2.0\n", "must be in 0 .. 1"),
        ("[plant.parameters]\nfail_at = 0\n", "failed at t = 0 s (step 0): RuntimeError: failed on request"),
        ('[[wire]]\nfrom = "plant.rmap"\nto = "controller.count"\n', "no measurement `rmap`"),
        ('[[wire]]\nfrom = "controller.label_out"\nto = "plant.extra"\n', "not a numeric output"),
        ('[[signal]]\nto = "controller.mode"\ntimes = [0.0]\nvalues = ["Fats"]\n', "`controller.mode` is"),
        ('[[metric]]\nname = "m"\nvalue = "last(plant.y)"\n', "names `plant.y`"),
    ],
)
def test_what_a_run_would_reject_is_found(write: Write, added: str, reported: str) -> None:
    found = check(str(write(added)))
    assert found.error is not None
    assert reported in found.error.message


def test_undriven_ends_and_missing_demands_are_warnings(write: Write) -> None:
    text = (
        'title = "t"\nloop = {step = 0.001, duration = 0.01}\ncontroller = {fmu = "probe"}\n'
        'plant = {name = "probe_plants:Lag"}\n'
    )
    found = check(str(write(text=text)))
    assert found.error is None
    ends = (
        "`controller.in`, `controller.count`, `controller.mode`, `controller.flag`, `plant.u`, `plant.extra`"
    )
    assert found.warnings == [
        f"nothing drives {ends}: add the missing wires and list the others in `undriven`",
        "the scenario has no criteria",
    ]


def test_an_unknown_name_in_idle_is_a_warning(write: Write) -> None:
    text = SCENARIO.replace('"plant.extra"]', '"plant.extra", "plant.extras"]')
    (reported,) = check(str(write(COMPLETE, text=text))).warnings
    assert reported.startswith(
        "`undriven` lists `plant.extras`, which is not an input or command. Use `plant."
    )


def test_a_start_value_a_signal_or_idle_is_an_answer(write: Write) -> None:
    text = (
        'title = "t"\nundriven = ["controller.count", "controller.mode", "controller.flag"]\n'
        'loop = {step = 0.001, duration = 0.01}\nplant = {name = "probe_plants:Lag"}\n'
        'controller = {fmu = "probe", parameters = {"in" = 0.5}}\n'
        '[[signal]]\nto = "plant.u"\ntimes = [0.0]\nvalues = [0.0]\n'
    )
    assert check(str(write(COMPLETE, text=text))).warnings == []


def test_a_wire_between_unlike_units_gives_an_error_with_its_scale(write: Write) -> None:
    file = write(COMPLETE)
    unlike = "`wire.controller.in` connects s of `plant.ramp` to m without conversion"
    changed = load(file, set=["wire.controller.in.from=plant.ramp"])
    with Session(changed) as session:
        assert lint.check(session) == [unlike]
    with Session(load(file, set=["wire.controller.in.from=plant.ramp", "wire.controller.in.scale=2"])) as s:
        assert lint.check(s) == []
