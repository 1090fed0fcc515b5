"""The report file: templates, style, script and library in one file that loads nothing."""

from __future__ import annotations

import base64
import functools
import gzip
import html
import itertools
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from cosim import extras, paths
from cosim.errors import CosimError
from cosim.extras import PROJECT, version
from cosim.formatting import strict
from cosim.report import sections
from cosim.report.provenance import SOURCES
from cosim.report.sections import Chapter

FOLDER = Path(__file__).parent / "templates"
DISTRIBUTIONS = {"cosim": PROJECT, "FMPy": "fmpy", "MuJoCo": "mujoco-core", "numpy": "numpy"}
"""Programs that compute the results, with their distributions."""


def check() -> None:
    """Check before long runs that a report can be made.

    Raises
    ------
    CosimError
        A package is missing.
    """
    for package in ("jinja2", "markdown_it", "matplotlib", "plotly"):
        problem = f"the report needs the package `{package}`, which is not installed"
        extras.needed(package, problem, extras.hint("report"))


def text(
    title: str,
    chapters: Sequence[Chapter],
    errors: Sequence[dict[str, str]] = (),
    sweeps: Sequence[dict[str, Any]] = (),
    documents: Sequence[dict[str, str]] = (),
) -> str:
    """Text of the report.

    Parameters
    ----------
    title
        Its title.
    chapters
        Data of each scenario, see `chapter.chapter`.
    errors
        Name, message and hint of the failed ones.
    sweeps
        Data of each sweep, see `sweeps.section`.
    documents
        Name, HTML and loop of each document, see `document`.
    """
    check()
    import jinja2

    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(FOLDER),
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
        undefined=jinja2.StrictUndefined,
    )
    environment.filters["words"] = words
    claims = [claim for chapter in chapters for claim in chapter["claims"]]
    parts = sections.made(chapters, sweeps, documents)
    return environment.get_template("page.html").render(
        title=title,
        loops=parts,
        claims=len(claims),
        held=sum(claim["passed"] for claim in claims),
        errors=errors,
        sweeps=[sweep for part in parts for sweep in part.sweeps],
        documents=[one for one in documents if all(one not in part.documents for part in parts)],
        versions={name: version(of) for name, of in DISTRIBUTIONS.items() if version(of)},
        style=(FOLDER / "page.css").read_text(encoding="utf-8"),
        script=(FOLDER / "page.js").read_text(encoding="utf-8"),
        library=library(),
        sources=SOURCES,
        data=compressed(strict.line([plain(one) for one in (*chapters, *sweeps)])),
    )


def plain(chapter: Chapter) -> dict[str, Any]:
    """Charts and views of a chapter or sweep, as the script of the page draws them."""
    charts = (*chapter["charts"], *chapter.get("distributions", ()))
    return {"charts": charts, "views": chapter.get("views", ())}


@functools.cache
def library() -> str:
    """Read Plotly's script, compressed to a third of its size."""
    import plotly.offline

    return compressed(plotly.offline.get_plotlyjs())


def compressed(content: str) -> str:
    """Text as gzip in base64; the same text gives the same bytes."""
    return base64.b64encode(gzip.compress(content.encode(), mtime=0)).decode()


def document(file: Path) -> dict[str, str]:
    """Document in Markdown as a part of the page; HTML in it is shown as text.

    Each table cell has the name of its column, for narrow screens.

    Raises
    ------
    CosimError
        The file cannot be read.
    """
    check()
    from markdown_it import MarkdownIt

    if paths.is_there(file) and not paths.is_file(file):
        raise CosimError(f"cannot read `{paths.shown(file)}`: it is not a regular file")
    try:
        content = file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        reason = error.strerror if isinstance(error, OSError) else "it is not a text in UTF-8"
        raise CosimError(f"cannot read `{paths.shown(file)}`: {reason}") from None
    heading = next((line.lstrip("# ") for line in content.splitlines() if line.startswith("# ")), file.stem)
    renderer = MarkdownIt("commonmark", {"html": False}).enable("table")
    tokens = renderer.parse(content)
    label(tokens)
    body = renderer.renderer.render(tokens, renderer.options, {})
    # the page has the heading already
    shown = body.replace(f"<h1>{html.escape(heading)}</h1>", "", 1)
    return {"name": heading, "loop": file.stem, "html": shown}


def label(tokens: Sequence[Any]) -> None:
    """Add the name of its column to each cell of a table."""
    heads: list[str] = []
    for token, following in itertools.pairwise(tokens):
        if token.type == "table_open":
            heads = []
            token.attrSet("class", "cards")
        elif token.type == "th_open":
            heads.append(following.content)
        elif token.type == "tr_open":
            column = 0
        elif token.type == "td_open":
            token.attrSet("data-label", heads[column])
            column += 1


def words(content: str) -> Any:
    """Line of Markdown as HTML: code and emphasis; links and HTML are shown as text."""
    from markupsafe import Markup

    return Markup(renderer_of_lines().renderInline(content))


@functools.cache
def renderer_of_lines() -> Any:
    """Make the renderer of lines once, because its construction is slow."""
    from markdown_it import MarkdownIt

    return MarkdownIt("commonmark").disable(["link", "image", "autolink", "html_inline"])
