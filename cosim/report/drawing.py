"""Figures of views and charts for print and for browsers without scripts.

They show the same data as the script of the page, which draws them interactively.
"""

from __future__ import annotations

import io
import itertools
import re
import string
from collections.abc import Sequence
from textwrap import fill
from typing import Any
from urllib.parse import quote

import numpy as np

from cosim.report.charts import ChartData
from cosim.show import figure as figures
from cosim.show import plot
from cosim.show.plot import PlotView

STYLE: Any = {
    "svg.fonttype": "none",
    "axes.titlelocation": "left",
    "axes.titlesize": 9.0,
    "legend.fontsize": 7.0,
    "path.simplify_threshold": 0.7,
}
DASHES = ("-", (0, (7, 3)), (0, (2, 2)), "-.", (0, (12, 3)), (0, (4, 2)), (0, (1, 2)), (0, (10, 2, 2, 2)))
"""Dashes of lines in their order, for print without colors."""
INTERVALS = 100
"""Time intervals of a curve; a page with all scenarios must stay below 15 MB."""
PLAIN = string.punctuation.translate({ord(one): None for one in "#%&"}) + " \n"
"""Characters that are themselves in the address of an image, between `"` in a page."""
WIDTH = 75
"""Letters in a line of a title."""
COLUMNS = 2
"""Charts next to each other."""
CIRCLE = np.linspace(0.0, 2.0 * np.pi, 181)


def views(found: Sequence[PlotView]) -> str:
    """Draw the views of a run side by side, each with its panels; empty without a panel."""
    rows = len(found[0].panels) if found else 0
    if not rows:
        return ""
    with figures.styled((6.0 * len(found), 1.7 * rows), STYLE) as figure:
        grid = figure.subplots(rows, len(found), sharex="col", squeeze=False)
        for column, view in zip(grid.T, found, strict=True):
            for axes, panel in zip(column, view.panels, strict=True):
                plot.draw(axes, panel, view.events, INTERVALS, DASHES)
                unit = f" ({panel.unit})" if panel.unit else ""
                axes.set_title(fill(f"{panel.title}{unit}".strip(), WIDTH))
                axes.legend(ncols=3)
            plot.name_events(column[0], view.events)
            column[-1].set_xlabel(f"time (s), {view.title}")
        return image(figure)


def charts(found: Sequence[ChartData]) -> str:
    """Draw charts that are not time series; empty without a chart."""
    if not found:
        return ""
    columns = min(COLUMNS, len(found))
    rows = -(-len(found) // columns)
    with figures.styled((6.0 * columns, 3.2 * rows), STYLE) as figure:
        for number, data in enumerate(found, 1):
            projection = "polar" if data.chart.kind == "polar" else None
            draw_chart(figure.add_subplot(rows, columns, number, projection=projection), data)
        return image(figure)


def draw_chart(axes: Any, data: ChartData) -> None:
    """Draw one chart: lines or cells, marked positions and values."""
    from matplotlib.ticker import MaxNLocator

    chart = data.chart
    if cells := data.cells:
        axes.pcolormesh(cells.x, cells.y, cells.parts, cmap="Blues", vmin=0.0, vmax=1.0, rasterized=True)
    marker = "." if data.points else ""
    for line, dash in zip(data.lines, itertools.cycle(DASHES), strict=False):
        axes.plot(line.x, line.y, label=line.name, linewidth=1.1, linestyle=dash, marker=marker)
    for position, text in data.marks:
        axes.axvline(position, label=text or None, **plot.EVENT)
    axes.set_title(fill(chart.title, WIDTH))
    axes.set_yscale("log" if chart.log else "linear")
    if chart.kind == "polar":
        for value, text in data.levels:
            axes.plot(CIRCLE, np.full(len(CIRCLE), value), label=text or None, **plot.LIMIT)
        if not chart.log:
            axes.set_ylim(bottom=min(0.0, axes.get_ylim()[0]))
    else:
        for value, text in data.levels:
            axes.axhline(value, label=text or None, **plot.LIMIT)
        axes.set(xlabel=data.x_label, ylabel=data.label, xscale="log" if chart.x_log else "linear")
        if data.integer:
            axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    if chart.equal:
        axes.set_aspect("equal", adjustable="datalim")
    if axes.get_legend_handles_labels()[1]:
        axes.legend()


def image(figure: Any) -> str:
    """Address of a figure as SVG for an `img` in the page."""
    figures.escape_dollars(figure)
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
