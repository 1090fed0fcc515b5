"""Every command of the documents is understood, and does what it is said to do."""

from __future__ import annotations

import contextlib
import re
import shlex
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest
import typer

import cosim
from cosim.acceptance.selection import select
from cosim.check import lint
from cosim.cli.app import app
from cosim.formatting.verdicts import row
from handbook.pages import ROOT

from ..cli.commands import called
from ..test_any import files as crane
from . import words

PROGRAMS = Path(sys.executable).parent
ELSEWHERE = {
    r"sweep my\.toml|sweep merge": "tests/harness/sweep runs and merges parts of a study",
    r"first-sweep\.toml": "tests/harness/test_guides.py loads the study",
    r"sweep studies/": "hours: the acceptance tests run some cases of each study",
    r"report -o|--study studies/": "minutes: `cargo xtask demo` runs every scenario and a study of each loop",
    r"cosim video|cosim view": "needs what draws: tests/harness/replay",
    r"notes\.md": "tests/harness/report has a document on its page",
    r"cosim run trial": "tests/house makes the trial",
    r"crane": "tests/harness/test_any.py goes through the tutorials step by step",
    r"chiller\.toml": "tests/harness/loop/test_chiller.py builds its FMUs",
    r"dob --update|compare dob$": "would write next to the scenario: tests/harness/compare",
}
"""Commands that are run elsewhere, and where."""
OTHERS = {
    r"^source \.venv/bin/activate$|^mkdir crane && cd crane$": "tests/harness/test_any.py",
    r"^pip install pythonfmu$|^pythonfmu build -f pd\.py$": "tests/harness/test_any.py",
    r"^pythonfmu build -f (spindle|chiller|compensation)\.py$": "tests/harness/loop/test_chiller.py",
    r"^pip install .*machining_fmus-.*\[sweep,report\]": "tests/harness/test_wheel.py",
    r"^cargo (new|add|install) |^cargo fmu$|^cargo fmu (-o|--package) ": "tests/conformance/test_example.py",
    r"^cargo fmu inspect ": "tests/conformance/test_example.py",
    r"^cargo fmu --binary ": "tests/conformance/test_platforms.py",
    r"^cargo fmu --outputs all$": "cargo-fmu/src/main.rs",
    r"^cargo fmu --plain-c$": "tests/conformance/plain/test_plain_c.py",
    r"^fmpy (info|simulate|validate) ": "tests/conformance/test_documents.py",
    r"^BLESS=1 cargo test -p fmu-trial$": "tests/house/test_new.py",
    r"^cargo test -p control-blocks$": "xtask/src/test.rs",
    r"^\.venv/bin/python fmu-\w+/doc/quick_start\.py$": "tests/conformance/test_quick_start.py",
    r"^\.venv/bin/python -m tests\.house\.language PATH": "tests/house/test_language.py",
    r"^python -m plants\.tools\.cl_path ": "tests/plants/test_cl_path.py",
    r"^python -m tests\.communication_step": "tests/communication_step/test_communication_step.py",
}
"""Commands of other programs, and what runs them or the like."""
SEARCH = """
scenario = "my.toml"
objective = {metric = "settling"}
search = {trials = 2}
[[vary]]
key = "controller.kd"
minimum = 10.0
maximum = 14.0
"""
FAILS = {"study.toml": 1}
"""Exit codes of commands whose criteria passed."""


def here(line: str) -> bool:
    return not any(re.search(pattern, line) for pattern in ELSEWHERE)


@pytest.mark.parametrize("line", words.listed("cosim"))
def test_a_command_is_understood(line: str) -> None:
    group = typer.main.get_command(app)
    context = group.make_context("cosim", shlex.split(line)[1:])
    assert isinstance(group, typer.core.TyperGroup)
    name, command, rest = group.resolve_command(context, [*context._protected_args, *context.args])
    assert command is not None
    reported = command.make_context(name, rest, parent=context).params
    assert reported
    select([word for word in reported.get("scenarios") or () if "*" in word])
    if (ROOT / "scenarios" / f"{reported.get('loop', '')}".partition("/")[0]).with_suffix(".toml").is_file():
        # connecting FMU and plant finds every wrong name and key
        with cosim.Session(cosim.load(reported["loop"], reported["set_"])) as session:
            lint.check(session)


@pytest.fixture(scope="module")
def user(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of a user who has an FMU, an MJCF, a scenario, a study and a search of his own."""
    folder = tmp_path_factory.mktemp("user")
    files = crane()
    (folder / "pd.py").write_text(files["pd.py"])
    subprocess.run([PROGRAMS / "pythonfmu", "build", "-f", "pd.py"], cwd=folder, check=True)
    shutil.copy(folder / "Pd.fmu", folder / "my.fmu")
    for name in ("my.xml", "crane.xml"):
        (folder / name).write_text(files["crane.xml"])
    (folder / "my.toml").write_text(files["crane.toml"])
    (folder / "crane.toml").write_text(files["crane.toml"])
    study = files["crane-study.toml"]
    assert "[10.0, 15.0, 20.0]" in study
    (folder / "study.toml").write_text(study.replace("[10.0, 15.0, 20.0]", "[10.0]"))
    (folder / "search.toml").write_text(SEARCH)
    for name in ("before", "after"):
        run(folder, f"cosim run my.toml --trace {name}.npz")
    return folder


@pytest.fixture(scope="module")
def done() -> set[str]:
    """Lines that ran, which leave their files in the folder for the other pages."""
    return set()


def fewer(line: str) -> str:
    """Line that does the same with fewer seeds and scenarios."""
    return line.replace("1..20", "1..2").replace("'dob*'", "'dob/no-*'")


def quick(line: str) -> str:
    """Line that does the same sooner."""
    if line.startswith("cosim report"):
        line += " --no-videos"
    return fewer(line)


def run(folder: Path, line: str) -> None:
    with contextlib.chdir(folder):
        done = called(*shlex.split(line)[1:])
    wanted = next((code for part, code in FAILS.items() if part in line), 0)
    assert done.returncode == wanted, (line, done.stdout[-500:], done.stderr)


def pages() -> list[Any]:
    """Pages with commands; those of the controllers have runs of the same kind."""
    found = [page for page in words.PAGES if any(map(here, words.lines(page, "cosim")))]
    full = pytest.mark.full
    return [pytest.param(page, marks=full) if page.startswith("fmu-") else page for page in found]


@pytest.mark.parametrize("page", pages())
def test_the_commands_of_a_page_run(
    page: str, user: Path, done: set[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSIM_CACHE", str(user / "cache"))
    scenario = (user / "crane.toml").read_text()
    for line in filter(here, words.lines(page, "cosim")):
        if line in done:
            continue
        # `new` writes over nothing
        (user / "my.toml").unlink() if "cosim new" in line else (user / "my.toml").write_text(scenario)
        run(user, quick(line))
        done.add(line)


@pytest.mark.full
@pytest.mark.parametrize(
    "line", [line for line in words.listed("cosim") if here(line) and fewer(line) != line]
)
def test_a_command_of_many_runs_runs_unchanged(
    line: str, user: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("COSIM_CACHE", str(user / "cache"))
    run(user, line)


def test_what_runs_elsewhere_is_on_a_page() -> None:
    lines = words.listed("cosim")
    assert [pattern for pattern in ELSEWHERE if not any(re.search(pattern, line) for line in lines)] == []


def test_the_steps_of_the_project_are_there() -> None:
    source = (ROOT / "xtask/src/main.rs").read_text("utf-8")
    (steps,) = re.findall(r"enum Command \{\n(.*?)^\}", source, re.DOTALL | re.MULTILINE)
    known = {name.lower() for name in re.findall(r"^    (\w+)", steps, re.MULTILINE)}
    named = {line.split()[2] for line in words.listed("cargo") if line.startswith("cargo xtask ")}
    assert named <= known
    reported = [one.split()[2] for one in words.mentioned("cargo") if one.startswith("cargo xtask ")]
    assert [name for name in reported if name.isalpha() and name.islower() and name not in known] == []
    modules = [line.split()[2] for line in (*words.listed("python"), *words.mentioned("python -m"))]
    assert [name for name in modules if find_spec(name) is None] == []
    folders = [line.split()[-1] for line in words.listed("pytest")]
    assert all((ROOT / folder).exists() for folder in folders)


def test_no_line_of_a_fence_is_left_over() -> None:
    """Lines of `cosim`, `cargo xtask` and pytest have tests above, all others have one by name."""
    here = re.compile(r"cosim |cargo xtask |pytest ")
    lines = dict.fromkeys(line for page in words.PAGES for line in words.shell(page) if not here.match(line))
    assert [line for line in lines if not any(re.search(pattern, line) for pattern in OTHERS)] == []
    assert [pattern for pattern in OTHERS if not any(re.search(pattern, line) for line in lines)] == []
    assert [place for place in OTHERS.values() if not (ROOT / place).is_file()] == []


def test_options_of_cargo_fmu_are_there() -> None:
    source = (ROOT / "cargo-fmu/src/main.rs").read_text("utf-8")
    fields = re.findall(r"#\[arg\([^\n]*long[^\n]*\)\]\n\s*(?:pub )?(\w+):", source)
    known = {f"--{name.replace('_', '-')}" for name in fields}
    lines = [*words.listed("cargo"), *words.mentioned("cargo")]
    options = {one for line in lines if line.startswith("cargo fmu") for one in re.findall(r"--[\w-]+", line)}
    assert options
    assert options <= known


def test_commands_of_sentences_are_understood() -> None:
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    names = {one.split()[1] for one in words.mentioned("cosim")}
    assert [name for name in names if re.fullmatch(r"[a-z]+", name) and name not in group.commands] == []


def test_the_table_of_the_tutorial_is_measured() -> None:
    result = cosim.run(cosim.load("dob"), engine="native")
    page = words.text("docs/tutorials/first-sweep.md")
    (block,) = re.findall(r"^claim +paper.*?\n```", page, re.DOTALL | re.MULTILINE)
    shown = [re.split(r"\s{2,}", line.strip()) for line in block.splitlines()[1:-2]]
    assert shown == [[cell for cell in row(verdict) if cell] for verdict in result.criteria[: len(shown)]]
    assert shown
