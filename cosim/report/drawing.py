"""Pictures of views and charts by matplotlib, for print and for browsers without scripts.

They show the same data as the script of the page, which draws them interactively.
"""

from __future__ import annotations

import io
import re
import string
from collections.abc import Sequence
from textwrap import fill
from typing import Any
from urllib.parse import quote

import numpy as np

from cosim.report.series import unpacked
from cosim.show import figure as figures
from cosim.show import plot
from cosim.trace.columns import Array
from cosim.trace.thinned import thinned

STYLE: Any = {
    "svg.fonttype": "none",
    "axes.titlelocation": "left",
    "axes.titlesize": 9.0,
    "legend.fontsize": 7.0,
    "path.simplify_threshold": 0.7,
}
DASHES = ("-", (0, (7, 3)), (0, (2, 2)), "-.", (0, (12, 3)), (0, (4, 2)), (0, (1, 2)), (0, (10, 2, 2, 2)))
"""Dashes of lines in their order, for print without colors."""
POINTS = 100
PLAIN = string.punctuation.translate({ord(one): None for one in "#%&"}) + " \n"
"""Characters that are themselves in the address of an image, between `"` in a page."""
WIDTH = 75
"""Letters in a line of a title."""
COLUMNS = 2
"""Charts next to each other."""
CIRCLE = np.linspace(0.0, 2.0 * np.pi, 181)


def views(found: Sequence[dict[str, Any]]) -> str:
    """Draw the views of a run side by side, each with its panels; empty without a panel."""
    if not found or not found[0]["panels"]:
        return ""
    rows = len(found[0]["panels"])
    with figures.styled((6.0 * len(found), 1.7 * rows), STYLE) as figure:
        grid = figure.subplots(rows, len(found), sharex="col", squeeze=False)
        for column, view in zip(grid.T, found, strict=True):
            for axes, panel in zip(column, view["panels"], strict=True):
                draw_panel(axes, view, panel)
            plot.name_events(column[0], view["events"])
            column[-1].set_xlabel(f"time (s), {view['title']}")
        return image(figure)


def draw_panel(axes: Any, view: dict[str, Any], panel: dict[str, Any]) -> None:
    """Draw one panel of a view."""
    for number, line in enumerate(panel["lines"]):
        y = values(thinned(unpacked(line), POINTS), panel["log"])
        y = np.round(y) if panel["items"] else y
        times = np.linspace(view["from"], view["to"], len(y))
        style: Any = {"drawstyle": "steps-post" if line["stepped"] else "default", "linestyle": dash(number)}
        axes.plot(times, y, label=line["name"], linewidth=1.1, **style)
    unit = f" ({panel['unit']})" if panel["unit"] else ""
    axes.set_title(fill(f"{panel['title']}{unit}".strip(), WIDTH))
    axes.set_yscale("log" if panel["log"] else "linear")
    plot.mark(axes, panel["limits"], view["events"], panel["log"], panel["items"])
    axes.margins(x=0.0)
    axes.legend(ncols=3)


def charts(found: Sequence[dict[str, Any]]) -> str:
    """Draw charts that are not time series; empty without a chart."""
    if not found:
        return ""
    columns = min(COLUMNS, len(found))
    rows = -(-len(found) // columns)
    with figures.styled((6.0 * columns, 3.2 * rows), STYLE) as figure:
        for number, chart in enumerate(found, 1):
            projection = "polar" if chart["polar"] else None
            draw_chart(figure.add_subplot(rows, columns, number, projection=projection), chart)
        return image(figure)


def draw_chart(axes: Any, chart: dict[str, Any]) -> None:
    """Draw one chart: lines or cells, marked positions and values."""
    from matplotlib.ticker import MaxNLocator

    if cells := chart["cells"]:
        parts = unpacked(cells).reshape(len(cells["y"]) - 1, -1)
        axes.pcolormesh(cells["x"], cells["y"], parts, cmap="Blues", vmin=0.0, vmax=1.0, rasterized=True)
    for number, line in enumerate(chart["lines"]):
        x, y = values(unpacked(line["x"]), chart["x_log"]), values(unpacked(line["y"]), chart["log"])
        style: Any = {"linestyle": dash(number), "marker": "." if chart["points"] else ""}
        axes.plot(x, y, label=line["name"], linewidth=1.1, **style)
    for position, text in chart["marks"]:
        axes.axvline(position, label=text or None, **plot.EVENT)
    axes.set(title=fill(chart["title"], WIDTH), yscale="log" if chart["log"] else "linear")
    if chart["polar"]:
        for value, text in chart["levels"]:
            axes.plot(CIRCLE, np.full(len(CIRCLE), value), label=text or None, **plot.LIMIT)
        if not chart["log"]:
            axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    else:
        for value, text in chart["levels"]:
            axes.axhline(value, label=text or None, **plot.LIMIT)
        axes.set(xlabel=chart["x_label"], ylabel=chart["label"], xscale="log" if chart["x_log"] else "linear")
        if chart["whole"]:
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if chart["equal"]:
        axes.set_aspect("equal", adjustable="datalim")
    if axes.get_legend_handles_labels()[1]:
        axes.legend()


def values(found: Array, log: bool) -> Array:
    """Values of axis coordinates, see `series.scaled`."""
    return 10.0**found if log else found


def dash(number: int) -> Any:
    """Dashes of a line."""
    return DASHES[number % len(DASHES)]


def image(figure: Any) -> str:
    """Address of a figure as SVG for an `img` in the page."""
    figures.show_as_written(figure)
    content = io.BytesIO()
    figure.savefig(content, format="svg", metadata=figures.SVG)
    return "data:image/svg+xml," + quote(compact(content.getvalue().decode()), safe=PLAIN)


def compact(svg: str) -> str:
    """Return an SVG without `"` and of a third of its size: equal styles once, tenths of a point."""
    styles: dict[str, str] = {}

    def named(found: re.Match[str]) -> str:
        return f'class="{styles.setdefault(found[1], f"s{len(styles)}")}"'

    def short(tag: re.Match[str]) -> str:
        # groups without names, texts that are not turned, and lines without a letter for each point
        content = re.sub(r'style="([^"]*)"', named, tag[0])
        content = re.sub(r'(<g) id=".*?"| transform="rotate\(-0 .*?"|(\.\d)\d+| \nL(?= )', r"\1\2", content)
        return content.replace("'", "&apos;").replace('"', "'")

    svg = re.sub(r"<[^>]*>", short, svg[svg.index("<svg") :])
    rules = "".join(f".{name}{{{style}}}" for style, name in styles.items())
    return re.sub(r"\s*\n\s*", "\n", svg.replace("</style>", f"{rules}</style>")).replace('"', "&quot;")
