"""Options that all commands share: one form of JSON, `-v` and `-q` anywhere, engines, origins in messages."""

from __future__ import annotations

import inspect
import json
import re
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

import cosim as package
from cosim import paths
from cosim.cli.app import app
from handbook import reference

from ..conftest import END, entry, grid
from .commands import called, cosim

Write = Callable[..., Path]
LIMIT = END + entry("criterion", id="end", claim="x < 9", metric="end", maximum=9.0)
COMMANDS = typer.main.get_command(app).commands  # type: ignore[attr-defined]


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_a_help_fits_into_80_columns_with_a_line_for_each_example(name: str) -> None:
    shown = called(*filter(None, [name]), "--help", COLUMNS="80", TERMINAL_WIDTH="80").stdout
    assert max(map(len, shown.splitlines())) <= 80
    assert not re.search(r"\x08|\w\.\.\.$|<(str|int|float|path)\b", shown, re.MULTILINE)
    callback = COMMANDS[name].callback if name else None
    text = inspect.cleandoc((callback and callback.__doc__) or "").replace("\b", "")
    examples = {line.strip() for line in text.splitlines() if line.startswith("    ")}
    assert examples <= {line.strip() for line in shown.splitlines()}


def test_a_summary_is_complete_in_the_list_of_the_help_and_on_the_page_of_the_commands() -> None:
    page = reference.commands()
    assert not re.search(r"^\* .*\.\.\.$", page, re.MULTILINE)
    assert "\b" not in page


def test_an_old_command_points_to_its_new_name() -> None:
    assert called("judge", "x.npz", "dob").stderr.endswith("hint: Use `cosim evaluate`.\n")


@pytest.mark.parametrize("name", COMMANDS)
def test_options_of_a_name_are_alike_in_all_commands(name: str) -> None:
    options = {option: param for param in COMMANDS[name].params for option in param.opts}
    assert {"-v", "-q"} <= options.keys()
    assert ("-o" in options) == ("--out" in options)
    if "--json" in options:
        assert options["--json"].metavar == "FILE|-"
    if "--engine" in options:
        assert (options["--engine"].default, options["--engine"].metavar) == ("native", "native|reference")


@pytest.mark.parametrize("before", [True, False])
def test_quiet_and_verbose_stand_before_or_after_the_command(write: Write, before: bool) -> None:
    write()
    for option, detail in (("-q", False), ("-v", True)):
        words = [option, "run", "lag.toml"] if before else ["run", "lag.toml", option]
        assert ("info: the plant `probe_plants:Lag` runs in the reference" in cosim(*words).stderr) == detail
        wrong = called(*words, "--set", "loop.seed=x")
        assert ("Traceback" in wrong.stderr) == detail


def test_the_native_engine_is_the_default(monkeypatch: pytest.MonkeyPatch) -> None:
    short = ("--duration", "0.01", "--json", "-", "-q")
    done = {engine: called("run", "dob", *short, "--engine", engine) for engine in ("native", "reference")}
    found = {engine: json.loads(run.stdout) for engine, run in done.items()}
    assert json.loads(called("run", "dob", *short).stdout)["engine"] == "native"
    assert package.run(package.load("dob", set="loop.duration=0.01")).engine == "native"
    assert {engine: run["engine"] for engine, run in found.items()} == {one: one for one in found}
    assert found["native"]["metrics"] == found["reference"]["metrics"]


@pytest.mark.parametrize(
    ("words", "status"),
    [
        (["run", "lag.toml"], "passed"),
        (["run", "lag.toml", "--set", "criterion.end.maximum=-1"], "failed"),
        (["run", "lag.toml", "--set", "plant.fail_at=7"], "error"),
        (["run", "none.toml"], "error"),
        (["run", "lag.toml", "--trace", "x.xls"], "error"),
        (["sweep", "study.toml", "--workers", "1"], "failed"),
        (["sweep", "lag.toml"], "error"),
        (["optimize", "lag.toml"], "error"),
        (["compare", "none.npz", "lag.npz"], "error"),
        (["evaluate", "none.npz", "lag.toml"], "error"),
    ],
)
def test_json_of_every_outcome_has_a_status(write: Write, words: list[str], status: str) -> None:
    folder = write(LIMIT).parent
    (folder / "study.toml").write_text(grid(fail_at=[-1, 7]))
    done = called(*words, "--json", "-")
    content = json.loads(done.stdout)
    assert content["status"] == status
    if status == "error":
        assert done.returncode == 2
        assert content["error"] in done.stderr


def test_json_of_several_runs_has_a_status_for_each(write: Write) -> None:
    write(LIMIT)
    for words, statuses in (
        (["test", "lag.toml", "none.toml"], ["passed", "error"]),
        (["run", "lag.toml", "--seeds", "1,2"], ["passed", "passed"]),
        (["check", "x.toml"], ["error"]),
    ):
        content = json.loads(called(*words, "--json", "-").stdout)
        assert [entry["status"] for entry in content] == statuses


def test_an_error_leaves_the_json_file_of_an_earlier_run(write: Write, folder: Path) -> None:
    write()
    assert called("run", "lag.toml", "--json", "x.json").returncode == 0
    before = (folder / "x.json").read_bytes()
    assert called("run", "none.toml", "--json", "x.json").returncode == 2
    assert (folder / "x.json").read_bytes() == before


@pytest.mark.parametrize(
    ("option", "value", "key"),
    [
        ("--delay", "2", "loop.compute_delay"),
        ("--seed", "-1", "loop.seed"),
        ("--duration", "0", "loop.duration"),
    ],
)
def test_a_message_names_the_option_that_set_a_value(write: Write, option: str, value: str, key: str) -> None:
    write()
    assert called("run", "lag.toml", option, value).stderr.startswith(f"error: `{option}`: `{key}` is `")


@pytest.mark.parametrize(("text", "value"), [(".05", 0.05), ("1.", 1.0), ("+.5e-1", 0.05), ("1.e-2", 0.01)])
def test_a_number_may_start_or_end_with_its_point(write: Write, text: str, value: float) -> None:
    assert package.load(write(), set=f"loop.duration={text}").loop.duration == value


def test_a_pattern_points_to_the_command_that_takes_patterns() -> None:
    done = called("run", "dob/*")
    assert done.stderr == (
        "error: `dob/*` is a pattern, not a scenario\n"
        "hint: Run all matching scenarios with `cosim test 'dob/*'`.\n"
    )


def test_a_study_of_the_project_is_named_by_its_kind_everywhere(folder: Path) -> None:
    done = called("run", "studies/dob-contact.toml")
    assert "studies/dob-contact.toml` is a study, not a scenario\nhint: Use `cosim sweep " in done.stderr


def test_an_option_without_its_value_points_to_the_help_of_its_command() -> None:
    done = called("run", "dob", "--in-process", "--plot")
    assert done.stderr.endswith("hint: Show the arguments with `cosim run --help`.\n")


def test_studies_are_listed_by_name_and_title() -> None:
    shown = called("list", "--studies").stdout
    assert all(name in shown for name in paths.list_studies())


def test_workers_need_seeds(write: Write) -> None:
    write()
    assert "Add `--seeds`" in called("run", "lag.toml", "--workers", "2").stderr
    assert called("run", "lag.toml", "--seeds", "1..3", "--workers", "1").returncode == 0


def test_parts_of_a_scenario_are_shown(write: Write) -> None:
    write()
    shown = called("show", "lag.toml", "plant").stdout
    assert "plant measurements" in shown
    assert not re.search("controller inputs|injections|loop: step", shown)
    shown = called("show", "lag.toml", "inputs", "wires").stdout
    assert "controller inputs" in shown
    assert "wires, signals and injections" in shown
    assert "plant measurements" not in shown
    done = called("show", "lag.toml", "plants")
    assert done.stderr == "error: `lag` has no part `plants`\nhint: Use `plant`.\n"


def test_the_cache_is_shown_and_cleaned(write: Write, tmp_path: Path) -> None:
    write()
    variables = {"COSIM_CACHE": str(tmp_path)}
    folder = Path(called("cache", "dir", **variables).stdout.strip())
    assert called("cache", "clean", **variables).stdout == f"removed 0 extracted FMUs from {folder}\n"
    called("run", "lag.toml", **variables)
    (folder / "notes").mkdir()
    assert called("cache", "clean", **variables).stdout == f"removed 1 extracted FMUs from {folder}\n"
    assert [file.name for file in folder.iterdir() if not file.name.startswith(".")] == ["notes"]
    assert called("run", "lag.toml", **variables).returncode == 0
