"""Check the language of the project: words, lengths and counts that STYLE.md sets.

    .venv/bin/python -m tests.house.language [--comments] [PATH...]

prints `file:line: rule: text` for each offense and exits with 1 if there is one; without a path: everything.
`--comments` checks ordinary comments of Rust and Python too; their counts are in `comments.toml`.
"""

from __future__ import annotations

import argparse
import fnmatch
import os
import re
import sys
import tomllib
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

from .interface import Interface
from .texts import FENCE, READERS, texts

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).parent
TABLE = tomllib.loads((HERE / "language.toml").read_text("utf-8"))
ALLOWED: list[dict[str, str]] = TABLE.get("allow", [])
WITHOUT = ("tests/house/language.toml", "tests/house/comments.toml")
"""Files that list the words themselves."""
LINE_LIMIT = 88

CELL_WORDS = 35
HINT_WORDS = 20
DESCRIPTION = 90
PAGE_WORDS = 1500
SENTENCE_WORDS = 25
LANDING_LINES = 110
INPUT_TABLE_LINE = 60
INPUTS = 16
OUTPUTS = {"fmu-deburr": 16}
OUTPUTS_OTHER = 12
PARAMETERS = 45
ESSENTIAL = 10

GENERATED_PAGES = ("docs/faults/*.md", "fmu-*/doc/variables.md", "docs/communication-step.md")
"""Pages that are generated as a whole: only their words and table cells are checked."""
HISTORY = ("CHANGELOG.md", "*/CHANGELOG.md")
"""Pages that grow with each release: no limit for the whole page."""
BLOCK = re.compile(
    r"<!-- (?:measured:|variables -->|[^>]*generated).*?<!-- end[^>]*-->",
    re.DOTALL,
)
"""Generated blocks of a page."""
CONTEXT = re.compile(r"^(Its|That|The same)\b")
WORD = re.compile(r"[^\W_]")


def compiled(section: str) -> list[tuple[re.Pattern[str], str]]:
    """Patterns of a section; a space matches any white space, except in a look-behind (fixed width)."""
    found = []
    for words, instead in TABLE[section].items():
        parts = re.split(r"(\(\?<!.*?\))", words)
        spaced = "".join(part if part.startswith("(?<!") else part.replace(" ", r"\s+") for part in parts)
        whole = rf"(?<![\w./-])(?:{spaced})(?![\w/(]|\.\w|\s*=[^=])"
        found.append((re.compile(whole, re.IGNORECASE), instead))
    return found


PATTERNS = [found for section in ("words", "phrases", "spelling") for found in compiled(section)]
ANY = re.compile("|".join(pattern.pattern for pattern, _ in PATTERNS), re.IGNORECASE)
"""All patterns in one: most texts match none."""


@dataclass(frozen=True, order=True)
class Offense:
    """Offense against a rule, with its file and line."""

    file: str
    line: int
    rule: str
    text: str

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.rule}: {self.text}"


def every_file() -> list[Path]:
    """Files with texts, without build results and installed packages."""
    found: list[Path] = []
    for folder, folders, names in os.walk(ROOT):
        folders[:] = sorted(name for name in folders if name != "target" and not name.startswith("."))
        found += [Path(folder, name) for name in sorted(names) if Path(name).suffix in READERS]
    return found


def below(paths: Iterable[Path]) -> list[Path]:
    """Files of some paths; a folder stands for all files below it."""
    chosen = [path.resolve() for path in paths]
    every = every_file()
    return [file for file in every if any(file.is_relative_to(path) for path in chosen)]


def shown(file: Path) -> str:
    return file.relative_to(ROOT).as_posix()


def matches(file: str, patterns: Iterable[str]) -> bool:
    return any(fnmatch.fnmatch(file, pattern) for pattern in patterns)


def allowed(file: str, word: str) -> bool:
    """Whether an entry of the allow-list covers a word of a file."""
    return any(
        fnmatch.fnmatch(file, entry["file"]) and re.fullmatch(entry["match"], word, re.IGNORECASE)
        for entry in ALLOWED
    )


def words(file: Path, *kinds: str) -> Iterator[Offense]:
    """Words and phrases of some kinds of text that the glossary replaces."""
    name = shown(file)
    if name in WITHOUT:
        return
    for text in texts(file):
        if text.kind not in kinds or not ANY.search(text.content):
            continue
        for pattern, instead in PATTERNS:
            for found in pattern.finditer(text.content):
                word = " ".join(found[0].split())
                if not allowed(name, word):
                    yield Offense(name, text.line_of(found.start()), "word", f"`{word}` -> {instead}")


def comment_counts() -> dict[str, int]:
    """Offenses in the ordinary comments of each top folder that has some."""
    counts: dict[str, int] = {}
    for file in every_file():
        found = sum(1 for _ in words(file, "comment"))
        folder = shown(file).split("/")[0]
        counts[folder] = counts.get(folder, 0) + found
    return {folder: number for folder, number in sorted(counts.items()) if number}


def count(text: str) -> int:
    """Count words; a code span is one."""
    return sum(1 for word in re.sub(r"`[^`]*`", "x", text).split() if WORD.search(word))


def page(file: Path) -> Iterator[Offense]:
    """Lengths of a Markdown page."""
    name = shown(file)
    text = file.read_text(encoding="utf-8")
    lines = FENCE.sub(lambda found: "\n" * found[0].count("\n"), text).split("\n")
    for number, line in enumerate(lines, 1):
        if line.lstrip().startswith("|"):
            for cell in re.split(r"(?<!\\)\|", line)[1:-1]:
                if (length := count(cell)) > CELL_WORDS:
                    start = " ".join(cell.split()[:6])
                    yield Offense(name, number, "cell", f"{length} words, limit {CELL_WORDS}: {start} ...")
    if matches(name, GENERATED_PAGES):
        return
    hand_written = FENCE.sub("\n\n", BLOCK.sub("\n\n", text))
    if not matches(name, HISTORY) and (total := count(hand_written)) > PAGE_WORDS:
        yield Offense(name, 1, "page", f"{total} words, limit {PAGE_WORDS}")
    lengths = sorted(count(sentence) for sentence in sentences(hand_written))
    if lengths and (length := lengths[int(0.9 * (len(lengths) - 1))]) > SENTENCE_WORDS:
        yield Offense(name, 1, "sentences", f"p90 is {length} words, limit {SENTENCE_WORDS}")
    if re.fullmatch(r"fmu-\w+/README\.md", name):
        yield from landing(name, text)


def sentences(text: str) -> list[str]:
    """Sentences of the prose of a page, without tables, headings and comments."""
    text = re.sub(r"<!--.*?-->", "", text, flags=re.DOTALL)
    kept = ["\n\n" if line.lstrip().startswith(("|", "#", ">", "![")) else line for line in text.split("\n")]
    paragraphs = re.split(r"\n\s*\n|\n\s*(?:[-*+]|\d+\.)\s+", "\n" + "\n".join(kept))
    found = [
        sentence
        for paragraph in paragraphs
        for sentence in re.split(r"(?<=[.!?])[)\"*]*\s+(?=[A-Z`*\[(0-9])", " ".join(paragraph.split()))
    ]
    return [sentence for sentence in found if count(sentence) > 1]


def landing(name: str, text: str) -> Iterator[Offense]:
    """Length of the page that a user opens first, and where its inputs are."""
    lines = text.rstrip("\n").split("\n")
    if len(lines) > LANDING_LINES:
        yield Offense(name, len(lines), "landing", f"{len(lines)} lines, limit {LANDING_LINES}")
    table = re.compile(r"\|\s*Inputs?\b|#+ Inputs?\b|\*\*Inputs?")
    at = next((number for number, line in enumerate(lines, 1) if table.match(line)), None)
    if at is None or at > INPUT_TABLE_LINE:
        where = f"line {at}" if at else "missing"
        yield Offense(name, at or 1, "landing", f"input table: {where}, limit line {INPUT_TABLE_LINE}")


def interface(file: Path) -> Iterator[Offense]:
    """Descriptions, hints and counts of the variables of a controller."""
    name = shown(file)
    declared = Interface(file)
    for item in declared.items.values():
        described = [(item.line, item.documentation)] if item.kind == "enum" else []
        described += [(member.line, member.documentation) for member in item.members]
        for line, text in described:
            if len(text) > DESCRIPTION:
                yield Offense(name, line, "description", f"{len(text)} characters, limit {DESCRIPTION}")
            if "`" in text:
                yield Offense(name, line, "description", "backticks")
            if CONTEXT.match(text):
                yield Offense(name, line, "description", f"starts with `{text.split()[0]}`: name the subject")
        for member in item.members:
            hint = member.text("hint")
            if hint is not None and count(hint) > HINT_WORDS:
                yield Offense(name, member.line, "hint", f"{count(hint)} words, limit {HINT_WORDS}")
            if hint is not None and "?" in hint:
                yield Offense(name, member.line, "hint", "a question; write an instruction")
            detection = member.text("detection")
            if detection is not None and count(detection) > CELL_WORDS:
                yield Offense(name, member.line, "detection", f"{count(detection)} words, limit {CELL_WORDS}")
    crate = name.split("/")[0]
    for what, found, limit in (
        ("inputs", declared.count("inputs"), INPUTS),
        ("outputs", declared.count("outputs", "local", "hidden"), OUTPUTS.get(crate, OUTPUTS_OTHER)),
        ("visible parameters", declared.count("parameters", "expert", "hidden", "calculated"), PARAMETERS),
        ("essential parameters", declared.flagged("parameters", "essential"), ESSENTIAL),
    ):
        if found > limit:
            yield Offense(name, 1, "count", f"{found} {what}, limit {limit}")


def offenses(files: Iterable[Path], *, comments: bool = False) -> Iterator[Offense]:
    """Everything in some files that breaks a rule."""
    kinds = ("page", "documentation", "message", "settings", *(["comment"] if comments else []))
    for file in files:
        if not file.is_file():
            continue
        yield from sorted(words(file, *kinds))
        if file.suffix == ".md":
            yield from page(file)
        if re.fullmatch(r"fmu-\w+/src/interface\.rs", shown(file)):
            yield from interface(file)


def main() -> int:
    """Run the command line."""
    parser = argparse.ArgumentParser(prog="python -m tests.house.language", description="Check STYLE.md.")
    parser.add_argument(
        "--comments", action="store_true", help="also check ordinary Rust and Python comments"
    )
    parser.add_argument("--summary", action="store_true", help="print counts by file instead of offenses")
    parser.add_argument("paths", nargs="*", type=Path, metavar="PATH", help="files, folders; default: all")
    chosen = parser.parse_args()
    files = below(chosen.paths) if chosen.paths else every_file()
    total = 0
    counts: dict[str, int] = {}
    for offense in offenses(files, comments=chosen.comments):
        total += 1
        counts[offense.file] = counts.get(offense.file, 0) + 1
        if not chosen.summary:
            print(offense)
    if chosen.summary:
        for name, number in sorted(counts.items(), key=lambda found: -found[1]):
            print(f"{number:6} {name}")
    print(f"{total} offenses in {len(files)} files", file=sys.stderr)
    return 1 if total else 0


if __name__ == "__main__":
    sys.exit(main())
