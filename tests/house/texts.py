"""Texts that a person reads, with their lines: Markdown, Rust, Python, TOML, Modelica, HTML, notebooks."""

from __future__ import annotations

import ast
import io
import json
import re
import tokenize
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

KINDS = ("page", "documentation", "message", "settings", "comment")
"""Markdown; doc comments and docstrings; strings of the code; TOML; ordinary comments of Rust and Python."""

FENCE = re.compile(r"^[ ]*(```+|~~~+)[^\n]*\n.*?^[ ]*\1[ ]*$", re.DOTALL | re.MULTILINE)
CODE = re.compile(r"(`+)(?!`).+?(?<!`)\1(?!`)", re.DOTALL)
FIELD = re.compile(r"\{[\w.\[\]]+(?::[^{}]*)?\}")
LINK = re.compile(r"\]\([^)\s]*\)|<https?:[^>]*>|https?://\S+|\]\[[^\]\n]*\]")
RUST = re.compile(
    r"""(?P<doc>//[/!](?!/)[^\n]*)|(?P<comment>//[^\n]*|/\*.*?\*/)"""
    r"""|(?P<string>b?r(?P<fence>\#*)".*?"(?P=fence)|b?"(?:\\[\s\S]|[^"\\])*")|b?'(?:\\[^']*'|[^\\']')""",
    re.DOTALL,
)
PARAMETER = re.compile(r"^( *)\w+(?:, \w+)*\n(?=\1 +\S)", re.MULTILINE)
"""Names of parameters in a docstring, each on a line of its own."""
STRING = re.compile(
    r'"""(.*?)"""|\'\'\'(.*?)\'\'\'|"((?:\\.|[^"\\\n])*)"|\'([^\'\n]*)\'|(#[^\n]*)', re.DOTALL
)
MODELICA = re.compile(r'"((?:\\[\s\S]|[^"\\])*)"|(//[^\n]*)', re.DOTALL)
TAG = re.compile(r"<script.*?</script>|<style.*?</style>|<[^>]*>|\{[{%#].*?[}%#]\}", re.DOTALL)


@dataclass(frozen=True)
class Text:
    """One text: the line of a file where it starts, its kind, and its content without code."""

    line: int
    kind: str
    content: str

    def line_of(self, offset: int) -> int:
        """Line of the file for an offset into the content."""
        return self.line + self.content.count("\n", 0, offset)


def blank(found: re.Match[str]) -> str:
    """Return the line breaks of a match, with a mark in place of its first line."""
    return "·" + "\n" * found[0].count("\n")


def prose(text: str) -> str:
    """Text without code, fields of a format and link targets; the lines stay."""
    return LINK.sub("]", FIELD.sub(blank, CODE.sub(blank, FENCE.sub(blank, text))))


def texts(file: Path) -> Iterator[Text]:
    """All texts of a file by its suffix; none for a file of another kind."""
    read = READERS.get(file.suffix)
    if read is not None and file.is_file():
        yield from read(file.read_text(encoding="utf-8"))


def markdown(text: str) -> Iterator[Text]:
    yield Text(1, "page", prose(text))


def rust(text: str) -> Iterator[Text]:
    """Doc comments and comments by paragraphs, and strings of at least two words."""
    parts: list[tuple[int, str, str]] = []
    line, at = 1, 0
    for found in RUST.finditer(text):
        line, at = line + text.count("\n", at, found.start()), found.start()
        if found["doc"]:
            parts.append((line, "documentation", found[0][3:]))
        elif found["comment"]:
            parts.append((line, "comment", found[0].removeprefix("//")))
        elif found["string"] and " " in found[0]:
            yield Text(line, "message", prose(found[0]))
    yield from joined(parts)


def joined(parts: list[tuple[int, str, str]]) -> Iterator[Text]:
    """Join comments of one kind on consecutive lines."""
    start, kind, lines = 0, "", [""]
    for line, of, content in parts:
        if of == kind and line == start + len(lines):
            lines.append(content)
            continue
        yield Text(start, kind, prose("\n".join(lines)))
        start, kind, lines = line, of, content.split("\n")
    yield Text(start, kind, prose("\n".join(lines)))


def python(text: str) -> Iterator[Text]:
    """Docstrings, also those of attributes, strings of at least two words, and comments."""
    tree = ast.parse(text)
    documentation = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            if id(node) in documentation:
                yield Text(node.lineno, "documentation", prose(PARAMETER.sub(r"\1·\n", node.value)))
            elif " " in node.value:
                yield Text(node.lineno, "message", prose(node.value))
    comments = [
        (token.start[0], "comment", token.string.lstrip("#"))
        for token in tokenize.generate_tokens(io.StringIO(text).readline)
        if token.type == tokenize.COMMENT
    ]
    yield from joined(comments)


def toml(text: str) -> Iterator[Text]:
    """Strings of at least two words, and comments."""
    yield from strings(text, STRING)


def modelica(text: str) -> Iterator[Text]:
    """Strings of at least two words, and comments."""
    yield from strings(text, MODELICA)


def strings(text: str, pattern: re.Pattern[str]) -> Iterator[Text]:
    for found in pattern.finditer(text):
        content = next(group for group in found.groups() if group is not None)
        if " " in content:
            yield Text(1 + text.count("\n", 0, found.start()), "settings", prose(content))


def html(text: str) -> Iterator[Text]:
    yield Text(1, "page", TAG.sub(blank, text))


def notebook(text: str) -> Iterator[Text]:
    for cell in json.loads(text)["cells"]:
        if cell["cell_type"] == "markdown":
            yield Text(1, "page", prose("".join(cell["source"]).replace("\n", " ")))


READERS = {
    ".md": markdown,
    ".rs": rust,
    ".py": python,
    ".pyi": python,
    ".toml": toml,
    ".mo": modelica,
    ".html": html,
    ".ipynb": notebook,
}
