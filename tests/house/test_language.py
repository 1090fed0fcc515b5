"""The rules of STYLE.md: words of the field, short pages, cells and hints, few ports and parameters."""

from __future__ import annotations

import os
import tomllib
from collections.abc import Iterable
from pathlib import Path

import pytest

from . import language
from .language import ALLOWED, HERE, Offense, comment_counts, every_file, matches, offenses, shown, words
from .texts import KINDS

FILES = every_file()
FOLDERS = sorted({shown(file).split("/")[0] for file in FILES})
COMMENTS = HERE / "comments.toml"


def listed(found: Iterable[Offense]) -> str:
    return "\n".join(str(offense) for offense in found)


@pytest.mark.parametrize("folder", FOLDERS)
def test_a_folder_follows_the_rules(folder: str) -> None:
    found = listed(offenses(file for file in FILES if shown(file).split("/")[0] == folder))
    assert not found, f"{found}\nhint: STYLE.md has the rules, tests/house/language.toml the words"


def test_the_allow_list_is_short_and_each_entry_has_a_reason_and_a_use() -> None:
    assert len(ALLOWED) <= 10
    for entry in ALLOWED:
        assert entry.keys() == {"file", "match", "reason"}
        assert len(entry["reason"].split()) >= 4
        assert any(matches(shown(file), [entry["file"]]) for file in FILES), entry


def test_comments_with_old_words_become_fewer() -> None:
    """The counts of `comments.toml` may only fall; with `BLESS=1` the test writes lower ones."""
    kept: dict[str, int] = tomllib.loads(COMMENTS.read_text("utf-8"))
    counts = comment_counts()
    above = [
        f"{folder}: {number} old words in comments, {kept.get(folder, 0)} are allowed"
        for folder, number in counts.items()
        if number > kept.get(folder, 0)
    ]
    hint = "hint: `.venv/bin/python -m tests.house.language --comments FOLDER` lists them"
    assert not above, "\n".join([*above, hint])
    fewer = {folder: number for folder, number in counts.items() if number < kept.get(folder, 0)}
    gone = kept.keys() - counts.keys()
    if "BLESS" in os.environ:
        head = COMMENTS.read_text("utf-8").split("\n\n")[0]
        lines = [f"{folder} = {number}" for folder, number in counts.items()]
        COMMENTS.write_text("\n".join([head, "", *lines, ""]), "utf-8")
    else:
        assert not fewer, f"{fewer}: keep the lower counts: `BLESS=1 pytest tests/house/test_language.py`"
        assert not gone, f"{gone}: no old words are left; `BLESS=1 pytest tests/house/test_language.py`"


@pytest.mark.parametrize(
    ("name", "text", "line"),
    [
        ("page.md", "One line.\nThe value as told.\n", 2),
        ("code.rs", "fn a() {}\n/// The value is\n/// in a\n/// row.\nfn b() {}\n", 3),
        ("code.rs", 'fn a() {\n    panic!("the stage stands");\n}\n', 2),
        ("code.py", '"""One line.\n\nIt tells a value.\n"""\n', 3),
        ("settings.toml", 'a = 1\ntitle = "A wanted value"\n', 2),
        ("settings.toml", "a = 1\n# a value beside another\n", 2),
    ],
)
def test_an_old_word_is_found_on_its_line(
    name: str, text: str, line: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(language, "ROOT", tmp_path)
    file = tmp_path / name
    file.write_text(text, "utf-8")
    assert [offense.line for offense in words(file, *KINDS)] == [line]


@pytest.mark.parametrize(
    "text",
    [
        "The value `told` is code.",
        "```sh\ntell me\n```",
        "[a page](docs/taught.md)",
        "The control law at least squares the error.",
        "The standard form stands for a matrix; make sure that it stays in place.",
        "`teach.place` and limits.told are names.",
    ],
)
def test_code_links_and_terms_of_the_field_are_no_old_words(
    text: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(language, "ROOT", tmp_path)
    file = tmp_path / "page.md"
    file.write_text(text, "utf-8")
    assert list(words(file, *KINDS)) == []


def test_lengths_of_a_page_are_counted(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(language, "ROOT", tmp_path)
    file = tmp_path / "page.md"
    long = " ".join(["word"] * 36)
    blocks = f"<!-- measured: a -->\n{'word ' * 2000}\n<!-- end -->\n"
    file.write_text(f"{blocks}\n| a | {long} |\n", "utf-8")
    assert [offense.rule for offense in offenses([file])] == ["cell"]
    file.write_text("A word. " * 800, "utf-8")
    assert [offense.rule for offense in offenses([file])] == ["page"]
    file.write_text(f"Here is a sentence. This {long}.\n", "utf-8")
    assert [offense.rule for offense in offenses([file])] == []
    file.write_text(f"This {long}.\n", "utf-8")
    assert [offense.rule for offense in offenses([file])] == ["sentences"]


INTERFACE = """
const AXES: usize = 9;
mod variables {{
    /// Cause of a fault
    pub enum Fault {{
        /// No fault
        None,
        /// {cause}
        #[hint(
            "{hint}"
        )] Lost,
    }}
    #[inputs] pub struct Input {{ pub axis: [Axis; 20] }}
    pub struct Axis {{
        /// Position of axis {{n}}
        #[var(unit = METER)] pub position: f64,
    }}
    #[outputs] pub struct Output {{
        #[var(local)] pub axis: [Axis; 20],
        pub fault: Fault,
        /// Speed
        #[var(name = "speed", fields = f64[x, y, z])] pub speed: Axes,
        /// Position
        pub position: [f64; super::AXES],
    }}
    #[parameters] pub struct Parameters {{
        /// Gain; "expert" in a string is no flag
        #[var(source = "for an expert", start = 1.0)] pub gain: [f64; 50],
    }}
}}
"""


def test_descriptions_hints_and_ports_of_an_interface_are_checked(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(language, "ROOT", tmp_path)
    file = tmp_path / "fmu-trial/src/interface.rs"
    file.parent.mkdir(parents=True)
    cause, hint = "Its `position` is " + "x" * 90, "is it on? " + "a " * 20
    file.write_text(INTERFACE.format(cause=cause, hint=hint), "utf-8")
    found = [(offense.rule, offense.text.split(",")[0]) for offense in offenses([file])]
    assert found == [
        ("description", "108 characters"),
        ("description", "backticks"),
        ("description", "starts with `Its`: name the subject"),
        ("hint", "23 words"),
        ("hint", "a question; write an instruction"),
        ("count", "20 inputs"),
        ("count", "13 outputs"),
        ("count", "50 visible parameters"),
    ]
