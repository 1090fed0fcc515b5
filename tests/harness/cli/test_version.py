"""`cosim --version`, what a shell completes, and the help that a wrong command line is pointed to."""

from __future__ import annotations

import importlib.metadata
import platform
from collections.abc import Callable
from pathlib import Path

import pytest

from .commands import called, cosim

Write = Callable[..., Path]


def completed(*words: str) -> list[str]:
    """List what bash would offer for the last word."""
    line = " ".join(["cosim", *words])
    program = {"COMP_WORDS": line, "COMP_CWORD": str(len(words)), "_COSIM_COMPLETE": "complete_bash"}
    done = cosim(**program)
    assert done.stderr == ""
    return done.stdout.split()


def test_the_version_shows_what_computes_the_numbers() -> None:
    done = cosim("--version")
    assert done.returncode == 0
    found = dict(line.split() for line in done.stdout.splitlines())
    assert found == {
        "cosim": importlib.metadata.version("machining-fmus"),
        "FMPy": importlib.metadata.version("fmpy"),
        "MuJoCo": importlib.metadata.version("mujoco-core"),
        "numpy": importlib.metadata.version("numpy"),
        "Python": platform.python_version(),
    }


def test_names_of_scenarios_and_files_are_completed(write: Write, folder: Path) -> None:
    write(name="scenarios/lag.toml")
    write(name="scenarios/lag/fast.toml", text='extends = "lag"')
    write(name="lagging.toml")
    (folder / "lag.csv").write_text("")
    assert completed("run", "lag") == ["lag", "lag/fast", "lagging.toml"]
    assert completed("run", "scenarios/lag") == ["scenarios/lag/", "scenarios/lag.toml"]
    assert completed("show", str(folder / "lagg")) == [str(folder / "lagging.toml")]
    assert completed("run", "./lagg") == ["./lagging.toml"]
    assert completed("run", "./sc") == ["./scenarios/"]
    assert completed("run", f"../{folder.name}/lagg") == [f"../{folder.name}/lagging.toml"]
    write(name=".hidden.toml")
    assert completed("run", "./") == ["./lagging.toml", "./scenarios/"]
    assert completed("run", "./.h") == ["./.hidden.toml"]
    assert completed("ru") == ["run"]


def test_keys_are_those_of_the_scenario_and_its_fmu(write: Write) -> None:
    write("[plant.parameters]\npole = 0.2\n")
    assert completed("run", "lag.toml", "--set", "controller.g") == ["controller.gain="]
    found = completed("run", "lag.toml", "--set", "plant.")
    # parameters that the file does not set are those of the plant's class
    assert {"plant.name=", "plant.pole=", "plant.fail_at="} <= set(found)
    assert completed("run", "--set", "loop.seed=3", "lag.toml", "--set", "loop.d") == ["loop.duration="]
    assert "wire.controller.in.noise=" in completed("run", "lag.toml", "--set", "wire.")


@pytest.mark.parametrize("text", ["title =", "controller = 3", "controller = {fmu = 'lag.toml'}"])
def test_a_broken_scenario_completes_only_what_is_known_and_says_nothing(write: Write, text: str) -> None:
    write(name="lag.toml", text=text)
    assert completed("run", "lag.toml", "--set", "controller.gain") == []
    assert completed("run", "none.toml", "--set", "controller.") == []


def test_studies_and_engines_are_completed(folder: Path) -> None:
    (folder / "stages.toml").write_text("")
    assert completed("sweep", "studies/dob-cont") == ["studies/dob-contact.toml"]
    assert {"stages.toml", "studies/dob-contact.toml"} <= set(completed("sweep", "st"))
    assert completed("run", "lag.toml", "--engine", "na") == ["native"]
    assert completed("show", "dob", "pl") == ["plant"]
    assert completed("cache", "cl") == ["clean"]


@pytest.mark.parametrize(
    ("line", "asked"), [(["new", "-o", "x"], "cosim new"), (["run"], "cosim run"), (["walk"], "cosim")]
)
def test_a_wrong_command_line_points_to_the_help_of_its_command(line: list[str], asked: str) -> None:
    done = cosim(*line)
    assert done.returncode == 2
    assert done.stderr.endswith(f"hint: Show the arguments with `{asked} --help`.\n")


@pytest.mark.parametrize("option", ["--show-completion", "--install-completion"])
def test_completion_is_shown_and_installed(option: str, tmp_path: Path) -> None:
    shell = {"HOME": str(tmp_path), "_TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION": "1"}
    done = cosim(option, "bash", **shell)
    assert (done.returncode, done.stderr) == (0, "")
    files = (*tmp_path.rglob("*.sh"), *tmp_path.rglob(".bashrc"))
    reported = done.stdout + "".join(file.read_text() for file in files)
    assert "complete -o default -F _cosim_completion cosim" in reported


@pytest.mark.parametrize("option", ["--show-completion", "--install-completion"])
def test_completion_for_a_shell_that_is_not_known_is_rejected(
    option: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    for module in ("typer.completion", "typer._completion_shared"):
        monkeypatch.setattr(f"{module}._get_shell_name", lambda: None)
    done = called(option)
    assert done.returncode == 2
    assert "error: completion is not available for this shell\nhint: Use bash, zsh, fish" in done.stderr
