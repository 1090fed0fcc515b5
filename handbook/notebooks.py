"""Notebooks: execution, and conversion to pages."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import nbclient
import nbformat


def store(folder: Path) -> None:
    """Execute all notebooks of a folder and store their output."""
    for file in sorted(folder.glob("*.ipynb")):
        nbformat.write(executed(file), file)


def executed(file: Path) -> Any:
    """Execute a notebook; remove time stamps and the Python version from its output."""
    notebook = nbformat.read(file, as_version=4)
    resources = {"metadata": {"path": file.parent}}
    nbclient.NotebookClient(notebook, record_timing=False, resources=resources).execute()
    notebook.metadata.language_info.pop("version", None)
    for cell in notebook.cells:
        cell.metadata.pop("execution", None)
    return notebook


def write(notebook: Path, place: Path) -> None:
    """Write the cells and outputs of an executed notebook as Markdown, with pictures next to it."""
    cells = json.loads(notebook.read_text("utf-8"))["cells"]
    place.write_text("\n\n".join(part for cell in cells for part in shown(cell, place)) + "\n", "utf-8")


def shown(cell: dict[str, Any], place: Path) -> Iterator[str]:
    """Page elements of one cell."""
    source = "".join(cell["source"])
    if cell["cell_type"] == "markdown":
        yield source
        return
    yield f"```python\n{source}\n```"
    for number, output in enumerate(cell["outputs"]):
        data = output.get("data", {})
        if "image/png" in data:
            picture = place.with_name(f"{place.stem}-{cell['id']}-{number}.png")
            picture.write_bytes(base64.b64decode(data["image/png"]))
            yield f"![Output of the cell above]({picture.name})"
        elif "text/html" in data:
            yield f'<div class="output">{"".join(data["text/html"])}</div>'
        else:
            yield f"```text\n{''.join(data.get('text/plain') or output['text']).rstrip()}\n```"
