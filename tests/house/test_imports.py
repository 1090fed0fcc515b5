"""Detection of imports, on crates and packages of a few lines."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest

from . import python, rust


def written(folder: Path, files: Mapping[str, str]) -> list[Path]:
    for name, text in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_text(text)
    return [folder / name for name in files]


def named(graph: Mapping[Path, set[Path]], folder: Path) -> dict[str, set[str]]:
    arrows = {file.relative_to(folder).as_posix(): found for file, found in graph.items()}
    return {
        file: {other.relative_to(folder).as_posix() for other in found}
        for file, found in arrows.items()
        if found
    }


FACADE = {
    "lib.rs": "mod part; mod user; pub use part::Thing;",
    "part/mod.rs": "mod thing; pub use thing::Thing;",
}


@pytest.mark.parametrize(
    ("text", "imported"),
    [
        ("use crate::part::Thing;", "part/thing.rs"),
        ("use crate::part::{self, Other as Thing};", "part/mod.rs"),
        ("use crate::Thing;", "lib.rs"),
        ("use crate::part; fn f() { part::Thing::new() }", "part/thing.rs"),
        ("fn f() -> crate::part::Thing { super::part::Thing }", "part/thing.rs"),
        ("mod inner { use super::super::part::Thing; }", "part/thing.rs"),
    ],
)
def test_a_rust_path_leads_through_facades_to_a_file(tmp_path: Path, text: str, imported: str) -> None:
    written(tmp_path, {**FACADE, "part/thing.rs": "pub struct Thing;", "user.rs": text})
    assert imported in named(rust.imports(tmp_path / "lib.rs"), tmp_path)["user.rs"]


@pytest.mark.parametrize(
    "text",
    [
        "// use crate::part::Thing;",
        'const TEXT: &str = "crate::part::Thing";',
        "use std::part::Thing;",
        "macro_rules! m { () => { $crate::part::Thing } }",
        "#[cfg(test)] mod tests { use crate::part::Thing; fn f() {} }",
    ],
)
def test_what_is_no_code_of_the_file_imports_nothing(tmp_path: Path, text: str) -> None:
    written(tmp_path, {**FACADE, "part/thing.rs": "pub struct Thing;", "user.rs": text})
    assert "user.rs" not in named(rust.imports(tmp_path / "lib.rs"), tmp_path)


def test_a_file_below_a_facade_imports_the_facade_itself(tmp_path: Path) -> None:
    written(
        tmp_path, {**FACADE, "part/thing.rs": "use super::Thing; use crate::Thing as Same;", "user.rs": ""}
    )
    arrows = named(rust.imports(tmp_path / "lib.rs"), tmp_path)
    assert arrows["part/thing.rs"] == {"part/mod.rs", "lib.rs"}
    assert arrows["lib.rs"] == arrows["part/mod.rs"] == {"part/thing.rs"}


def test_types_of_tests_and_comments_do_not_count(tmp_path: Path) -> None:
    text = "/// struct A\npub struct B<'a>(&'a str);\n#[cfg(test)]\nmod tests { struct C; }\nenum D {}"
    written(tmp_path, {"src/lib.rs": text, "src/tests.rs": "struct E;"})
    assert [name for name, _ in rust.types(tmp_path)] == ["B", "D"]


def test_classes_within_classes_and_functions_count(tmp_path: Path) -> None:
    text = '"""class A."""\nclass B:\n    class C: ...\ndef f():\n    class D: ...\n'
    assert [name for name, _ in python.types(written(tmp_path, {"a.py": text}))] == ["B", "C", "D"]


@pytest.mark.parametrize(
    ("text", "imported"),
    [
        ("from package.part import Thing", "package/part/thing.py"),
        ("from package.part import thing", "package/part/thing.py"),
        ("import package.part.thing as t", "package/part/thing.py"),
        ("def f():\n    from .part.thing import Thing", "package/part/thing.py"),
        ("if TYPE_CHECKING:\n    from .part import Thing", "package/part/thing.py"),
        ("from package import Thing", "package/__init__.py"),
    ],
)
def test_a_python_import_leads_through_facades_to_a_file(tmp_path: Path, text: str, imported: str) -> None:
    files = {
        "package/__init__.py": "from package.part import Thing",
        "package/part/__init__.py": "from package.part.thing import Thing",
        "package/part/thing.py": "class Thing: ...",
        "package/user.py": text,
    }
    packages = python.Packages(tmp_path, written(tmp_path, files))
    assert named(packages.imports(), tmp_path)["package/user.py"] == {imported}
