"""The declaration of the variables of a controller, read from `src/interface.rs` as text."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ITEM = re.compile(r"(?:pub\s+)?(?P<kind>struct|enum)\s+(?P<name>\w+)(?:<[^>]*>)?\s*\{")
MEMBER = re.compile(
    r"(?:pub\s+)?(?P<name>[A-Za-z_]\w*)(?:\s*:\s*(?P<type>\[[^\]]*\]|[\w:<>]+))?\s*(?:,|$|\})"
)
CONSTANT = re.compile(r"const\s+(\w+)\s*:\s*usize\s*=\s*(\d+)\s*;")
STRING = re.compile(r'"((?:\\[\s\S]|[^"\\])*)"', re.DOTALL)


@dataclass(frozen=True)
class Member:
    """A field of a struct or an item of an enum, with the line of its documentation."""

    line: int
    name: str
    documentation: str
    attributes: str
    type: str

    def flag(self, word: str) -> bool:
        """Whether a word occurs among the attributes, outside their strings."""
        return re.search(rf"\b{word}\b", STRING.sub('""', self.attributes)) is not None

    def text(self, attribute: str) -> str | None:
        """Text of an attribute: `#[hint("...")]`."""
        string = r'"((?:\\[\s\S]|[^"\\])*)"'
        found = re.search(rf"#\[{attribute}\(\s*r?{string}\s*,?\s*\)\]", self.attributes, re.DOTALL)
        return found[1] if found else None

    @property
    def fields(self) -> int:
        """Number of variables of a struct that is declared elsewhere: `fields = f64[x, y, z]`."""
        found = re.search(r"\bfields\s*=\s*\w+\s*\[([^\]]*)\]", STRING.sub('""', self.attributes))
        return len(re.findall(r"\w+", found[1])) if found else 1


@dataclass(frozen=True)
class Item:
    """A struct or an enum with its members."""

    line: int
    name: str
    kind: str
    documentation: str
    attributes: str
    members: tuple[Member, ...]


class Interface:
    """All items of an interface."""

    def __init__(self, file: Path) -> None:
        text = file.read_text(encoding="utf-8")
        self.items = {item.name: item for item in items(text)}
        self.constants = {name: int(value) for name, value in CONSTANT.findall(text)}

    def root(self, attribute: str) -> Item:
        """Item with an attribute: `inputs`, `outputs` or `parameters`."""
        return next(item for item in self.items.values() if f"#[{attribute}]" in item.attributes)

    def count(self, root: str, *without: str) -> int:
        """Count variables below a root by their elements, without those that have one of some flags."""
        return self.elements(self.root(root), without)

    def flagged(self, root: str, flag: str) -> int:
        """Count variables below a root that have a flag."""
        return self.count(root) - self.count(root, flag)

    def elements(self, item: Item, without: tuple[str, ...]) -> int:
        """Count variables of an item by their elements."""
        total = 0
        for member in item.members:
            if any(member.flag(word) for word in without):
                continue
            length, of = 1, member.type
            if found := re.fullmatch(r"\[\s*(\w+)\s*;\s*([\w:]+)\s*\]", member.type):
                of = found[1]
                length = int(found[2]) if found[2].isdigit() else self.constants[found[2].rpartition("::")[2]]
            group = self.items.get(of)
            inside = self.elements(group, without) if group and group.kind == "struct" else member.fields
            total += length * inside
        return total


def items(text: str) -> Iterator[Item]:
    """Structs and enums in the module of the variables."""
    start = text.find("mod variables")
    at = max(start, 0)
    while found := ITEM.search(text, at):
        documentation, attributes, _ = before(text, found.start())
        end = closing(text, found.end())
        line = 1 + text.count("\n", 0, found.start())
        members = tuple(member_list(text, found.end(), end - 1))
        yield Item(line, found["name"], found["kind"], documentation, attributes, members)
        at = end


def before(text: str, at: int) -> tuple[str, str, int]:
    """Documentation and attributes directly before an item."""
    start = at
    while True:
        line_start = text.rfind("\n", 0, start - 1) + 1
        line = text[line_start:start].strip()
        if line and not line.startswith(("///", "#[")) and not line.endswith("]"):
            break
        if not line and start != at:
            break
        start = line_start
        if start == 0:
            break
    lines = text[start:at].split("\n")
    documentation = " ".join(line.strip()[3:].strip() for line in lines if line.strip().startswith("///"))
    attributes = "\n".join(line for line in lines if not line.strip().startswith("///"))
    return documentation, attributes, start


def closing(text: str, start: int) -> int:
    """Offset after the brace that ends a block, without strings and comments."""
    depth = 1
    for found in re.finditer(r'"(?:\\[\s\S]|[^"\\])*"|//[^\n]*|[{}]', text[start:]):
        if found[0] == "{":
            depth += 1
        elif found[0] == "}":
            depth -= 1
            if depth == 0:
                return start + found.end()
    raise ValueError("a block without an end")


def member_list(text: str, start: int, end: int) -> Iterator[Member]:
    """Fields or items between the braces of a struct or an enum."""
    at, documentation, attributes, line = start, [], "", 0
    while at < end:
        if found := re.compile(r"\s+|//(?!/)[^\n]*").match(text, at, end):
            at = found.end()
        elif found := re.compile(r"///([^\n]*)").match(text, at, end):
            line = line or 1 + text.count("\n", 0, at)
            documentation.append(found[1].strip())
            at = found.end()
        elif text.startswith("#[", at):
            last = attribute_end(text, at + 2)
            attributes += text[at:last]
            at = last
        elif found := MEMBER.match(text, at, end):
            here = line or 1 + text.count("\n", 0, at)
            yield Member(here, found["name"], " ".join(documentation), attributes, found["type"] or "")
            at, documentation, attributes, line = found.end(), [], "", 0
        else:
            at += 1


def attribute_end(text: str, start: int) -> int:
    """Offset after the bracket that ends an attribute."""
    depth = 1
    for found in re.finditer(r'"(?:\\[\s\S]|[^"\\])*"|[\[\]]', text[start:]):
        if found[0] == "[":
            depth += 1
        elif found[0] == "]":
            depth -= 1
            if depth == 0:
                return start + found.end()
    raise ValueError("an attribute without an end")
