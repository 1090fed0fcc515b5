"""The command line as a user or a script meets it: exit codes, streams, messages."""

from __future__ import annotations

import json
import os
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from cosim.cli import main

from .conftest import DATA, END, SCENARIO, SETTLING, entry, pack

Write = Callable[..., Path]
ROOT = Path(__file__).resolve().parents[2]

CRITERION = (
    SETTLING
    + END
    + entry("criterion", id="end", claim="The lag settles", paper="about 0.7 m", metric="end", maximum=0.7)
)


def cosim(*arguments: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run the command line in the working directory."""
    variables = {**os.environ, "PYTHONPATH": str(ROOT), **environment}
    command = [sys.executable, "-m", "cosim", *arguments]
    return subprocess.run(command, capture_output=True, text=True, env=variables, check=False, timeout=120)


def test_exit_code_0_and_the_table_on_stdout(write: Write) -> None:
    write(CRITERION)
    done = cosim("run", "lag.toml")
    assert done.returncode == 0
    assert done.stderr == ""
    for part in ("claim", "paper", "measured", "limit", "result"):
        assert part in done.stdout
    assert re.search(r"The lag settles *│ about 0.7 m *│ 666.7 mm *│ <= 700 mm *│ passed", done.stdout)
    assert "1 of 1 criteria passed; seed 1, 0.05 s simulated" in done.stdout
    assert "\x1b" not in done.stdout


def test_exit_code_1_when_a_criterion_does_not_hold(write: Write) -> None:
    write(CRITERION)
    done = cosim("run", "lag.toml", "--set", "criterion.end.maximum=0.1")
    assert done.returncode == 1
    assert "0 of 1 criteria passed" in done.stdout
    assert done.stderr == ""


def test_a_backend_of_matplotlib_that_is_none_is_named_before_the_run(write: Write) -> None:
    write(CRITERION)
    done = cosim("run", "lag.toml", "--plot", "x.svg", "--json", "x.json", MPLBACKEND="nope")
    assert done.returncode == 2
    assert done.stdout == ""
    assert re.match("error: matplotlib does not start: .*'nope'.*\nhint: Unset `MPLBACKEND`", done.stderr)
    assert not Path("x.json").exists()


def test_json_to_stdout_is_nothing_but_json(write: Write) -> None:
    write(CRITERION.removeprefix(SETTLING))
    done = cosim("run", "lag.toml", "--json", "-", "--seed", "9", "--delay", "0", "--duration", "0.02")
    assert done.returncode == 1
    found = json.loads(done.stdout)
    assert (found["seed"], found["simulated_s"], found["passed"]) == (9, 0.02, False)
    assert found["metrics"]["end"]["value"] == 1.0


def test_all_files_are_written(write: Write, folder: Path) -> None:
    write(CRITERION)
    done = cosim("run", "lag.toml", "--json", "a.json", "--trace", "a.npz", "--plot", "a.svg")
    assert done.returncode == 0
    assert done.stdout.splitlines()[-2:] == ["wrote a.npz", "wrote a.svg"]
    assert json.loads((folder / "a.json").read_text())["passed"] is True
    assert len(np.load(folder / "a.npz")["trace"]) == 50
    assert (folder / "a.svg").read_text().startswith("<?xml")


def test_the_same_seed_gives_the_same_bytes_in_two_processes(write: Write, folder: Path) -> None:
    write()
    noisy = ("--set", "wire.controller.in.noise=0.1", "--seed", "5")
    for name in ("one.csv", "two.csv", "one.npz", "two.npz"):
        assert cosim("run", "lag.toml", *noisy, "--trace", name).returncode == 0
    assert (folder / "one.csv").read_bytes() == (folder / "two.csv").read_bytes()
    assert (folder / "one.npz").read_bytes() == (folder / "two.npz").read_bytes()


@pytest.mark.skipif(os.name == "nt", reason="POSIX pipes")
@pytest.mark.parametrize("command", ["list", "show lag.toml", "run lag.toml --json -"])
def test_a_reader_that_closes_causes_no_traceback(write: Write, command: str) -> None:
    write(name="scenarios/lag.toml")
    write()
    variables = {**os.environ, "PYTHONPATH": str(ROOT)}
    pipeline = f"{sys.executable} -m cosim {command} | true"
    done = subprocess.run(pipeline, shell=True, capture_output=True, text=True, env=variables, check=False)
    assert done.stderr == ""


def test_options_win_over_overrides(write: Write) -> None:
    write()
    done = cosim("run", "lag.toml", "--set", "loop.seed=3", "--seed", "4", "--json", "-")
    assert json.loads(done.stdout)["seed"] == 4


def test_list_shows_names_and_titles_and_survives_a_broken_file(write: Write) -> None:
    write(name="scenarios/lag.toml")
    write(name="scenarios/lag/fast.toml", text='extends = "lag"\ntitle = "Fast lag"\n')
    write(name="scenarios/broken.toml", text="title = ")
    done = cosim("list")
    assert done.returncode == 0
    assert re.search(r"^lag +Lag with a probe *$", done.stdout, re.MULTILINE)
    assert re.search(r"^lag/fast +Fast lag *$", done.stdout, re.MULTILINE)
    assert "warning: `scenarios/broken.toml` is not valid TOML" in done.stderr


def test_show_shows_variables_parameters_and_wires(write: Write) -> None:
    write("[controller.parameters]\ngain = 3.0\n")
    done = cosim("show", "lag.toml", "--set", "plant.pole=0.25", "--set", "wire.controller.in.noise=0.5")
    assert done.returncode == 0
    assert re.search(r"gain +3 \(default 1\) +.. 10 +Gain", done.stdout)
    assert re.search(r"pole +0.25 \(default 0.5\) +1 +0 .. 1 +Pole +test", done.stdout)
    assert re.search(r"mode +Off +Off Slow Fast", done.stdout)
    assert re.search(r"controller.in +plant.x +noise 0.5", done.stdout)


def test_color_goes_to_terminals_only_and_never_with_no_color(write: Write) -> None:
    write(CRITERION)
    colored = cosim("run", "lag.toml", FORCE_COLOR="1")
    plain = cosim("run", "lag.toml", FORCE_COLOR="1", NO_COLOR="1")
    assert "\x1b[32m" in colored.stdout.replace("\x1b[1;32m", "\x1b[32m")
    assert not re.search(r"\x1b\[[0-9;]*3\dm", plain.stdout)


BAD = {
    "unknown --set key": (["run", "lag.toml", "--set", "loop.dration=1"], "Use `duration`."),
    "wrong type": (["run", "lag.toml", "--set", "plant.pole=high"], ""),
    "missing scenario": (["run", "nothing.toml"], "`cosim list`"),
    "missing scenario name": (["run", "lagg"], "Use `lag`."),
    "missing FMU": (["run", "lag.toml", "--set", "controller.fmu=fmu-none"], "cargo xtask fmu none"),
    "FMU is no zip": (["run", "lag.toml", "--set", "controller.fmu=text.fmu"], "again"),
    "other platform": (["run", "lag.toml", "--set", "controller.fmu=other.fmu"], "this machine"),
    "broken TOML": (["run", "broken.toml"], "quotes"),
    "bad seed": (["run", "lag.toml", "--seed", "one"], "--help"),
    "show without FMU": (["show", "lag.toml", "--set", "controller.fmu=fmu-none"], "cargo xtask fmu none"),
}


IN_OWN_PROCESS = (
    "unknown --set key",
    "wrong type",
    "missing FMU",
    "other platform",
    "broken TOML",
    "bad seed",
)


@pytest.fixture
def mistakes(write: Write, folder: Path) -> None:
    """Write the files that the bad command lines speak of."""
    write()
    write(name="scenarios/lag.toml")
    write(name="broken.toml", text=SCENARIO + "\nwrong = one")
    (folder / "text.fmu").write_text("text")
    pack(folder / "other.fmu", (DATA / "probe.xml").read_text(), {"binaries/win32/probe.dll": b""})


def check_refusal(code: object, stdout: str, stderr: str, hint: str) -> None:
    assert code == 2
    assert stdout == ""
    assert "Traceback" not in stderr
    lines = stderr.strip().splitlines()
    assert lines[0].startswith("error: ")
    assert len(lines[0]) > len("error: ") + 10
    assert len(lines) <= 2
    if hint:
        assert lines[1].startswith("hint: ")
        assert hint in lines[1]


@pytest.mark.usefixtures("mistakes")
@pytest.mark.parametrize(("arguments", "hint"), BAD.values(), ids=BAD.keys())
def test_bad_input_is_one_message_and_exit_code_2(
    arguments: list[str], hint: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(sys, "argv", ["cosim", *arguments])
    with pytest.raises(SystemExit) as exited:
        main()
    check_refusal(exited.value.code, *capsys.readouterr(), hint)


@pytest.mark.usefixtures("mistakes")
@pytest.mark.parametrize("name", IN_OWN_PROCESS)
def test_bad_input_is_the_same_in_a_process_of_its_own(name: str) -> None:
    arguments, hint = BAD[name]
    done = cosim(*arguments)
    check_refusal(done.returncode, done.stdout, done.stderr, hint)


def test_verbose_shows_where_a_plant_failed(write: Write) -> None:
    write()
    done = cosim("run", "lag.toml", "--set", "plant.fail_at=3", "-v")
    assert done.returncode == 2
    assert "probe_plants.py" in done.stderr
    assert "RuntimeError: failed on request" in done.stderr


@pytest.mark.skipif(os.name == "nt", reason="POSIX signals")
def test_ctrl_c_is_exit_code_130_without_traceback(write: Write, tmp_path: Path) -> None:
    write()
    cache = tmp_path / "cache"
    cache.mkdir()
    command = [sys.executable, "-m", "cosim", "run", "lag.toml", "--duration", "1000", "--json", "-"]
    variables = {**os.environ, "PYTHONPATH": str(ROOT), "XDG_CACHE_HOME": str(cache)}
    process = subprocess.Popen(
        command,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=variables,
        # a shell that starts the tests in the background lets them ignore the signal
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    # the unpacked FMU is the first sign of life
    while process.poll() is None and not any(cache.glob("*/*")):
        time.sleep(0.05)
    process.send_signal(signal.SIGINT)
    stdout, stderr = process.communicate(timeout=30)
    assert process.returncode == 130, stderr
    assert stdout == ""
    assert stderr.strip() == "error: interrupted"


def test_no_arguments_show_the_help() -> None:
    done = cosim()
    assert done.returncode == 0
    assert "Usage" in done.stdout
    for command in ("list", "show", "run"):
        assert command in done.stdout
