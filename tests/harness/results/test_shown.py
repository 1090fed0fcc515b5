"""Texts of FMUs, models and metrics are shown as they are; files and overrides are taken as texts, too."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import cosim
from cosim.fmu.messages import LONGEST, readable

from ..conftest import DATA, SCENARIO, pack
from ..test_cli import CRITERION, ROOT
from ..test_cli import cosim as command

Write = Callable[..., Path]
HOSTILE = "rate [/min] in [red]m/s[/red] :smile: [link=x]"


def test_markup_in_texts_of_others_is_text(write: Write, folder: Path, probe_library: bytes) -> None:
    description = (DATA / "probe.xml").read_text().replace('description="Gain"', f'description="{HOSTILE}"')
    pack(folder / "marked.fmu", description, {"binaries/linux64/probe.so": probe_library})
    metric = f"[[metric]]\nname = \"end\"\nvalue = 'last(plant.x)'\ndescription = '{HOSTILE}'\n"
    claim = f"[[criterion]]\nid = 'low'\nclaim = '{HOSTILE}'\nmetric = 'low'\nmaximum = 2.0\n"
    low = "[[metric]]\nname = \"low\"\nvalue = 'last(plant.x)'\n"
    write(metric + low + claim, text=SCENARIO.replace("Lag with a probe", HOSTILE))
    shown = command("show", "lag.toml", "--set", "controller.fmu=marked.fmu", COLUMNS="200")
    assert HOSTILE in shown.stdout
    assert shown.stdout.count(HOSTILE) == 2
    done = command("run", "lag.toml", COLUMNS="200")
    assert done.returncode == 0, done.stderr
    assert done.stdout.count(HOSTILE) == 3
    assert HOSTILE in command("sweep", str(study(folder)), "--no-plots", COLUMNS="200").stdout


def study(folder: Path) -> Path:
    file = folder / "study.toml"
    file.write_text('scenario = "lag.toml"\n[design]\nkind = "list"\n[[case]]\n"plant.pole" = 0.5\n')
    return file


def test_messages_of_an_fmu_hold_no_codes_of_the_terminal() -> None:
    assert readable(b"100% \x1b[31mred\xff") == "100% \ufffd[31mred\ufffd"
    assert readable(b"two\nlines") == "two\nlines"
    assert len(readable(b"A" * 1_000_000)) == LONGEST + 3
    assert readable(None) == ""


def test_texts_of_a_scenario_hold_no_codes_of_the_terminal(write: Write) -> None:
    metric = '[[metric]]\nname = "end"\nvalue = "last(plant.x)"\ndescription = "\\u001b[2Jx\\u202ey"\n'
    write(metric, text=SCENARIO.replace("Lag with", "L\\u001b[31mag\\u0007 with"))
    done = command("run", "lag.toml", "--set", "plant.label=\x1b[31m", COLUMNS="200")
    assert done.returncode == 0, done.stderr
    assert "L\ufffd[31mag with a probe" in done.stdout
    assert "\ufffd[2Jx\ufffdy" in done.stdout
    refused = command("run", "lag.toml", "--set", "controller.g\x1b[31main=1", "--set", "plant.p\u200bole=1")
    assert refused.returncode == 2
    assert not {"\x1b", "\x07", "\u200b", "\u202e"} & {*done.stdout, *refused.stderr}


@pytest.mark.parametrize(("encoding", "shown"), [("ascii", "L??g"), ("cp1252", "L\u00e4?g")])
def test_a_terminal_shows_the_characters_that_it_has(write: Write, encoding: str, shown: str) -> None:
    write(CRITERION, text=SCENARIO.replace("Lag with", "L\u00e4\u8d77g with"))
    done = subprocess.run(
        [sys.executable, "-m", "cosim", "run", "lag.toml"],
        capture_output=True,
        env={**os.environ, "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": encoding},
        encoding=encoding,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    assert f"lag: {shown} with a probe" in done.stdout
    assert "| measured |" in done.stdout


def test_files_and_overrides_may_be_texts(write: Write, folder: Path) -> None:
    result = cosim.run(cosim.load(str(write()), set="loop.duration=0.002"))
    assert result.simulated_s == 0.002
    result.save_trace("u.npz")
    result.save_json("u.json")
    assert len(np.load(folder / "u.npz")["trace"]) == 2
    assert (folder / "u.json").read_text().startswith("{")


@pytest.mark.parametrize("name", ["studies/dob-contact.toml", "studies/fts-machines.toml"])
def test_the_own_studies_are_found_from_anywhere(folder: Path, name: str) -> None:
    assert cosim.paths.find_study(name).is_file()
    assert not (folder / name).exists()
