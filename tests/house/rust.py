"""Rust sources as text: the module tree of a crate, what each file imports, the types it defines."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path

HIDDEN = re.compile(
    r"""//[^\n]*|/\*.*?\*/|b?r(?P<fence>\#*)".*?"(?P=fence)|b?"(?:\\[\s\S]|[^"\\])*"|b?'(?:\\.[^']*|[^\\'])'""",
    re.DOTALL,
)
"""Comments, strings and characters: what they hold is no code."""
TEST = re.compile(
    r"#\[cfg\(test\)\]\s*(?:#\[[^\]]*\]\s*)*(?:pub(?:\([^)]*\))?\s+)?(?P<kind>mod\s+\w+\s*[{;]|use\b[^;]*;)"
)
TOKEN = re.compile(
    r"\bmod\s+(?P<inline>\w+)\s*\{|\bmod\s+(?P<file>\w+)\s*;|(?P<public>\bpub(?:\([^)]*\))?\s+)?\buse\s+(?P<use>[^;]+);"
    r"|(?<![\w$:])(?P<path>\w+(?:\s*::\s*\w+)+)|(?P<brace>[{}])"
)
TYPE = re.compile(r"\b(?:struct|enum|trait|union)\s+(?P<name>[A-Za-z]\w*)")
NAMES = re.compile(r"\w+|::|[{},*]")

Module = tuple[str, ...]
"""Path of a module below the root of its crate."""


@dataclass
class Source:
    """One file of a crate.

    Parameters
    ----------
    module
        Position in the module tree.
    paths
        Paths that the code names, each with the module it is named in, absolute where they begin at the root.
    aliases, exports
        What a name means that `use` and `pub use` bring into a module of the file.
    """

    file: Path
    module: Module
    text: str
    paths: list[tuple[Module, Module]] = field(default_factory=list)
    aliases: dict[tuple[Module, str], Module] = field(default_factory=dict)
    exports: dict[tuple[Module, str], Module] = field(default_factory=dict)


def code(text: str) -> str:
    """Text without comments, strings and unit tests."""
    text = HIDDEN.sub('""', text)
    while found := TEST.search(text):
        end = found.end() if found["kind"].endswith(";") else closing(text, found.end())
        text = text[: found.start()] + text[end:]
    return text


def closing(text: str, start: int) -> int:
    """Offset after the brace that ends the block that starts at `start`."""
    depth = 1
    for brace in re.finditer(r"[{}]", text[start:]):
        depth += 1 if brace[0] == "{" else -1
        if depth == 0:
            return start + brace.end()
    raise ValueError("missing closing brace")


def roots(crate: Path) -> list[Path]:
    """Files that a compiler starts from: library, program, and each test and example."""
    patterns = ("src/lib.rs", "src/main.rs", "tests/*.rs", "tests/*/main.rs", "examples/*.rs")
    return sorted(file for pattern in patterns for file in crate.glob(pattern))


def tree(root: Path) -> dict[Module, Source]:
    """All files below a root by their modules; inline modules belong to their file."""
    sources: dict[Module, Source] = {}
    waiting: list[tuple[Path, Module]] = [(root, ())]
    while waiting:
        file, module = waiting.pop()
        source = sources[module] = Source(file, module, code(file.read_text(encoding="utf-8")))
        folder = (
            file.parent
            if file.name in ("lib.rs", "main.rs", "mod.rs") or file == root
            else file.with_suffix("")
        )
        for child in scan(source):
            below = folder.joinpath(*child[len(module) : -1])
            beside = (below / f"{child[-1]}.rs", below / child[-1] / "mod.rs")
            waiting += [(found, child) for found in beside if found.exists()]
    return sources


def scan(source: Source) -> list[Module]:
    """Collect paths and aliases of a file; returns the modules that it declares."""
    children = []
    modules = [source.module]
    for token in TOKEN.finditer(source.text):
        if token["inline"]:
            modules.append((*modules[-1], token["inline"]))
        elif token["file"]:
            children.append((*modules[-1], token["file"]))
        elif token["brace"]:
            modules.append(modules[-1]) if token["brace"] == "{" else modules.pop()
        elif token["use"]:
            for path, name in uses(token["use"]):
                source.paths.append((modules[-1], path))
                source.aliases[modules[-1], name] = path
                if token["public"]:
                    source.exports[modules[-1], name] = path
        else:
            source.paths.append((modules[-1], tuple(re.split(r"\s*::\s*", token["path"]))))
    return children


def uses(tree_: str) -> list[tuple[Module, str]]:
    """Paths of a `use`, each with the name it gets: `a::{b, c as d}` is `a::b` as `b` and `a::c` as `d`."""
    found: list[tuple[Module, str]] = []
    prefixes: list[Module] = [()]
    path: Module = ()
    alias = ""
    tokens = [*NAMES.findall(tree_), ","]
    for index, token in enumerate(tokens):
        if token == "{":
            prefixes.append(path)
        elif token in (",", "}"):
            if path != prefixes[-1]:
                whole = path[:-1] if path[-1] == "self" else path
                found.append((whole, alias or whole[-1]))
            if token == "}":
                prefixes.pop()
            path, alias = prefixes[-1], ""
        elif tokens[index - 1] == "as":
            alias = token
        elif token not in ("::", "as"):
            path = (*path, token)
    return found


def absolute(sources: dict[Module, Source], source: Source, at: Module, path: Module) -> Module | None:
    """Path from the root of the crate; none for what comes from elsewhere."""
    head, rest = path[0], path[1:]
    if head == "crate":
        return rest
    if head in ("self", "super"):
        base = at
        while rest and head == "super":
            base, head, rest = base[:-1], rest[0], rest[1:]
        return (*base, *rest) if head == "self" else (*base, head, *rest)
    alias = source.aliases.get((at, head))
    if alias and alias != path[: len(alias)] and alias[0] in ("crate", "self", "super"):
        found = absolute(sources, source, at, alias)
        return None if found is None else (*found, *rest)
    return (*at, *path) if (*at, head) in sources else None


def target(sources: dict[Module, Source], importer: Source, path: Module) -> Source:
    """File that a path leads to; a facade leads on, unless the importer is below it."""
    module = path
    while module not in sources:
        module = module[:-1]
    source, name = sources[module], path[len(module) : len(module) + 1]
    below = importer.module[: len(module)] == module
    if below or not name or (module, name[0]) not in source.exports:
        return source
    onward = absolute(sources, source, module, source.exports[module, name[0]])
    return (
        source
        if onward is None or onward == path
        else target(sources, source, (*onward, *path[len(module) + 1 :]))
    )


def imports(root: Path) -> dict[Path, set[Path]]:
    """Files below a root, each with those that it imports."""
    sources = tree(root)
    graph: dict[Path, set[Path]] = {}
    for source in sources.values():
        places = [absolute(sources, source, at, path) for at, path in source.paths]
        found = {target(sources, source, place).file for place in places if place is not None}
        graph[source.file] = found - {source.file}
    return graph


def types(crate: Path) -> list[tuple[str, Path]]:
    """Types that the library of a crate defines outside its tests, each with its file."""
    files = [file for file in sorted((crate / "src").rglob("*.rs")) if file.name != "tests.rs"]
    return [
        (found["name"], file)
        for file in files
        for found in TYPE.finditer(code(file.read_text(encoding="utf-8")))
    ]
