"""The report file: templates, style, script and library in one file that loads nothing."""

from __future__ import annotations

import base64
import functools
import gzip
import html
import itertools
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from cosim import extras, paths
from cosim.errors import CosimError
from cosim.extras import DISTRIBUTIONS, version
from cosim.formatting import strict

FOLDER = Path(__file__).parent / "templates"
SOURCES = {"paper": "from the paper", "prediction": "prediction", "choice": "choice"}
"""Source of a limit, as in the report."""
Section = dict[str, Any]
"""Data of one scenario or study, see `scenario_section.describe` and `study_section.run`."""


@dataclass
class ClosedLoop:
    """Sections of one controller: scenarios, the nominal one first, studies and documents."""

    name: str
    scenarios: list[Section] = field(default_factory=list)
    studies: list[Section] = field(default_factory=list)
    documents: list[dict[str, str]] = field(default_factory=list)

    @property
    def claims(self) -> list[dict[str, Any]]:
        """Claims of all its scenarios."""
        return [claim for scenario in self.scenarios for claim in scenario["claims"]]

    @property
    def passed(self) -> int:
        """Number of passed claims."""
        return sum(claim["passed"] for claim in self.claims)

    @property
    def headline(self) -> dict[str, Any] | None:
        """Key number: of its first claim with a number, preferably one of a paper."""
        numbers = [claim for first in self.scenarios[:1] for claim in first["claims"] if claim["number"]]
        return next((claim for claim in numbers if claim["paper"]), next(iter(numbers), None))


def closed_loops(
    scenarios: Sequence[Section], studies: Sequence[Section], documents: Sequence[dict[str, str]]
) -> list[ClosedLoop]:
    """Group the parts of a report by closed loop; scenarios and studies are numbered in their order."""
    names = [one["loop"] for one in scenarios] + [one["scenario"].partition("/")[0] for one in studies]
    loops = {name: ClosedLoop(name) for name in names}
    for number, scenario in enumerate(scenarios):
        loops[scenario["loop"]].scenarios.append({**scenario, "number": number})
    for index, study in enumerate(studies):
        numbered = {**study, "number": len(scenarios) + index, "index": index + 1}
        loops[names[numbered["number"]]].studies.append(numbered)
    for document in documents:
        if document["loop"] in loops:
            loops[document["loop"]].documents.append(document)
    return list(loops.values())


def paragraphs(description: str) -> list[str]:
    """Nonempty paragraphs of a description."""
    return [part for part in description.split("\n\n") if part.strip()]


def check() -> None:
    """Check before long runs that the packages for a report are installed."""
    for package in ("jinja2", "markdown_it", "matplotlib", "plotly"):
        problem = f"the report needs the package `{package}`, which is not installed"
        extras.needed(package, problem, extras.hint("report"))


def text(
    title: str,
    scenarios: Sequence[Section],
    errors: Sequence[dict[str, str]] = (),
    studies: Sequence[Section] = (),
    documents: Sequence[dict[str, str]] = (),
) -> str:
    """Text of the report; `errors` are name, message and hint of the scenarios that could not run."""
    check()
    import jinja2

    loader, undefined = jinja2.FileSystemLoader(FOLDER), jinja2.StrictUndefined
    options: Any = {"autoescape": True, "trim_blocks": True, "lstrip_blocks": True}
    environment = jinja2.Environment(loader=loader, undefined=undefined, **options)
    environment.filters["markdown"] = inline_markdown
    claims = [claim for scenario in scenarios for claim in scenario["claims"]]
    loops = closed_loops(scenarios, studies, documents)
    plotted = [
        {"charts": (*one["charts"], *one.get("distributions", ())), "views": one.get("views", ())}
        for one in (*scenarios, *studies)
    ]
    return environment.get_template("page.html").render(
        title=title,
        loops=loops,
        claims=len(claims),
        passed=sum(claim["passed"] for claim in claims),
        errors=errors,
        studies=[study for part in loops for study in part.studies],
        documents=[one for one in documents if all(one not in part.documents for part in loops)],
        versions={name: version(of) for name, of in DISTRIBUTIONS.items() if version(of)},
        style=(FOLDER / "page.css").read_text(encoding="utf-8"),
        script=(FOLDER / "page.js").read_text(encoding="utf-8"),
        library=library(),
        sources=SOURCES,
        data=compressed(strict.line(plotted)),
    )


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
    label_cells(tokens)
    body = renderer.renderer.render(tokens, renderer.options, {})
    # the page has the heading already
    shown = body.replace(f"<h1>{html.escape(heading)}</h1>", "", 1)
    return {"name": heading, "loop": file.stem, "html": shown}


def label_cells(tokens: Sequence[Any]) -> None:
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


def inline_markdown(content: str) -> Any:
    """Line of Markdown as HTML: code and emphasis; links and HTML are shown as text."""
    from markdown_it import MarkdownIt
    from markupsafe import Markup

    renderer = MarkdownIt("commonmark").disable(["link", "image", "autolink", "html_inline"])
    return Markup(renderer.renderInline(content))
