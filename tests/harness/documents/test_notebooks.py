"""The notebooks show what they give today."""

from __future__ import annotations

from typing import Any

import nbformat
import pytest

from handbook import notebooks
from handbook.pages import ROOT


def shown(notebook: Any) -> list[Any]:
    """Return the outputs by cell: texts as they are, of a picture that there is one."""
    return [
        [
            output.get("text") or {kind: kind == "image/png" or data for kind, data in output["data"].items()}
            for output in cell.outputs
        ]
        for cell in notebook.cells
        if cell.cell_type == "code"
    ]


@pytest.mark.parametrize("name", ["one-loop", "sweep"])
def test_a_notebook_gives_what_it_shows(name: str) -> None:
    file = ROOT / f"examples/{name}.ipynb"
    stored = nbformat.read(file, as_version=4)
    assert any(shown(stored))
    assert shown(notebooks.executed(file)) == shown(stored)


@pytest.mark.parametrize("name", ["one-loop", "sweep"])
def test_a_notebook_does_not_show_where_it_ran(name: str) -> None:
    file = ROOT / f"examples/{name}.ipynb"
    assert str(ROOT) not in file.read_text("utf-8")
    stored = nbformat.read(file, as_version=4)
    assert "version" not in stored.metadata.language_info
    assert [cell.id for cell in stored.cells if "execution" in cell.metadata] == []
