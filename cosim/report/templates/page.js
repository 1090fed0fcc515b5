"use strict";
const root = document.documentElement;
const one = (selector, from = document) => from.querySelector(selector);
const all = (selector, from = document) => [...from.querySelectorAll(selector)];

// without this the pictures of the plots stay
if ("DecompressionStream" in window) root.classList.add("scripted");

// texts are compressed in the page
const bytesOf = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
async function expanded(id) {
  const stream = new Blob([bytesOf(one("#" + id).textContent)]).stream();
  return new Response(stream.pipeThrough(new DecompressionStream("gzip"))).text();
}

// the library is loaded when the first plot becomes visible
let ready;
function prepared() {
  ready ??= (async () => {
    const script = document.createElement("script");
    script.textContent = await expanded("library");
    document.head.append(script);
    return JSON.parse(await expanded("data"));
  })();
  return ready;
}

function numbers(entry) {
  const steps = new Uint16Array(bytesOf(entry.data).buffer);
  return Array.from(steps, (step) => (step > 65534 ? null : entry.low + (entry.span * step) / 65534));
}

const DASHES = ["solid", "14px,6px", "4px,5px", "14px,5px,4px,5px", "24px,6px", "8px,4px", "2px,4px", "20px,5px,4px,5px"];
function color(name) {
  const probe = document.createElement("i");
  probe.style.color = "var(" + name + ")";
  document.body.append(probe);
  const found = getComputedStyle(probe).color;
  probe.remove();
  return found;
}

function traces(view, panel) {
  return panel.curves.map((line, i) => {
    // a logarithmic axis has the logarithms
    const y = numbers(line).map((value) => (panel.log && value !== null ? 10 ** value : value));
    const step = (view.end - view.begin) / Math.max(1, y.length - 1);
    return {
      x: y.map((_, k) => view.begin + k * step), y, name: line.name, mode: "lines",
      line: { width: 1.5, color: color("--c" + (i % 8)), dash: DASHES[i % 8], shape: line.stepped ? "hv" : "linear" },
      hovertemplate: "%{y:.5g}",
    };
  });
}

function frame() {
  const ink = color("--faint");
  return {
    height: 210, margin: { l: 62, r: 8, t: 6, b: 34 }, font: { color: ink, size: 11 },
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", hovermode: "x unified",
    hoverlabel: { bgcolor: color("--sheet"), font: { color: color("--ink") } },
    showlegend: true, legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom", font: { size: 11 } },
  };
}

function axis(more) {
  const rule = color("--rule");
  return { gridcolor: rule, linecolor: rule, zeroline: false, automargin: true, exponentformat: "SI", ...more };
}

function layout(view, panel) {
  const names = Object.keys(panel.items), red = color("--no");
  const wide = names.length ? { tickvals: Object.values(panel.items), ticktext: names } : { nticks: 5 };
  const mark = { type: "line", line: { color: red, width: 1.5, dash: "dash" } };
  const events = view.events.map(([t]) => ({ ...mark, x0: t, x1: t, yref: "paper", y0: 0, y1: 1 }));
  const limits = panel.limits.map(([y]) => ({ ...mark, xref: "paper", x0: 0, x1: 1, y0: y, y1: y, line: { ...mark.line, dash: "dot" } }));
  const words = { showarrow: false, font: { size: 10, color: red } };
  return {
    ...frame(),
    xaxis: axis({ range: [view.begin, view.end], title: { text: "time (s)", standoff: 4 }, hoverformat: ".5g" }),
    yaxis: axis({ ...wide, type: panel.log ? "log" : "linear" }),
    shapes: [...events, ...limits],
    annotations: [
      // on separate lines, because events can coincide
      ...view.events.map(([t, text], i) => ({ ...words, x: t, yref: "paper", y: 1 - 0.14 * (i % 4), yanchor: "top", text, xanchor: "left" })),
      // on a logarithmic axis the position is the logarithm
      ...panel.limits.map(([y, text]) => ({ ...words, xref: "paper", x: 1, xanchor: "right", y: panel.log ? Math.log10(y) : y, yanchor: "bottom", text })),
    ],
  };
}

function plotOf(figure) {
  if (!one(".plot", figure)) figure.append(Object.assign(document.createElement("div"), { className: "plot" }));
  figure.classList.add("drawn");
  return one(".plot", figure);
}

async function drawChart(figure) {
  const sections = await prepared();
  const chart = sections[figure.closest("[data-number]").dataset.number].charts[figure.dataset.chart];
  const element = plotOf(figure);
  const values = (entry, log) => numbers(entry).map((value) => (log && value !== null ? 10 ** value : value));
  if (chart.polar) return drawPolar(element, chart, values);
  const lines = chart.lines.map((line, i) => ({
    x: values(line.x, chart.x_log), y: values(line.y, chart.log), name: line.name, mode: chart.points ? "lines+markers" : "lines",
    line: { width: 1.5, color: color("--c" + (i % 8)), dash: DASHES[i % 8] }, marker: { size: 5, symbol: i },
    hovertemplate: "%{x:.5g}, %{y:.5g}",
  }));
  if (chart.cells) {
    const flat = numbers(chart.cells), wide = chart.cells.x.length - 1;
    lines.push({
      type: "heatmap", zmin: 0, zmax: 1, x: chart.cells.x, y: chart.cells.y, z: chart.cells.y.slice(1).map((_, row) => flat.slice(row * wide, (row + 1) * wide)),
      colorscale: [[0, color("--paper")], [1, color("--c0")]], colorbar: { thickness: 10, outlinewidth: 0 },
      hovertemplate: "%{x:.4g}, %{y:.4g}: %{z:.2f}<extra></extra>",
    });
  }
  const red = color("--no"), mark = { type: "line", line: { color: red, width: 1.5, dash: "dash" } };
  const words = { showarrow: false, font: { size: 11, color: red }, xref: "paper", x: 1, xanchor: "right" };
  await Plotly.react(element, lines, {
    shapes: [
      ...chart.marks.map(([x]) => ({ ...mark, x0: x, x1: x, yref: "paper", y0: 0, y1: 1 })),
      ...chart.levels.map(([y]) => ({ ...mark, xref: "paper", x0: 0, x1: 1, y0: y, y1: y, line: { ...mark.line, dash: "dot" } })),
    ],
    annotations: [
      ...chart.marks.map(([, text], i) => ({ ...words, yref: "paper", y: 1 - 0.07 * i, yanchor: "top", text, bgcolor: color("--paper") })),
      // on a logarithmic axis the position is the logarithm
      ...chart.levels.map(([y, text]) => ({ ...words, y: chart.log ? Math.log10(y) : y, yanchor: "bottom", text })),
    ],
    // automatic margins and equal scales interact
    ...frame(), height: 360, margin: { l: 74, r: 12, t: 6, b: 44 }, hovermode: "closest",
    xaxis: axis({ automargin: false, title: { text: chart.x_label, standoff: 4 }, type: chart.x_log ? "log" : "linear", ...(chart.integer ? { dtick: between(lines.flatMap((line) => line.x)) } : {}) }),
    yaxis: axis({ automargin: false, title: { text: chart.label, standoff: 4 }, type: chart.log ? "log" : "linear", ...(chart.equal ? { scaleanchor: "x" } : {}) }),
  }, { responsive: true, displaylogo: false, displayModeBar: false });
}

// integer tick distance
const between = (x) => Math.max(1, Math.ceil((Math.max(...x) - Math.min(...x)) / 10));

// values over an angle, with limits as circles
async function drawPolar(element, chart, values) {
  const turn = Array.from({ length: 91 }, (_, i) => 4 * i), red = color("--no"), rule = color("--rule");
  const lines = chart.lines.map((line, i) => ({
    type: "scatterpolar", r: values(line.y, chart.log), theta: numbers(line.x), thetaunit: "radians", name: line.name, mode: "lines",
    line: { width: 1.5, color: color("--c" + (i % 8)), dash: DASHES[i % 8] }, hovertemplate: "%{r:.4g}",
  }));
  const limits = chart.levels.map(([y, text]) => ({
    type: "scatterpolar", r: turn.map(() => y), theta: turn, name: text, mode: "lines", line: { width: 2, color: red, dash: "dot" }, hoverinfo: "skip",
  }));
  const spokes = { gridcolor: rule, linecolor: rule };
  await Plotly.react(element, [...lines, ...limits], {
    ...frame(), height: 420, margin: { l: 34, r: 34, t: 60, b: 30 }, hovermode: "closest", legend: { ...frame().legend, y: 1.12 },
    polar: {
      bgcolor: "rgba(0,0,0,0)", angularaxis: { ...spokes, thetaunit: "degrees" },
      radialaxis: { ...spokes, type: chart.log ? "log" : "linear", exponentformat: "power", angle: 90, tickangle: 90, title: { text: chart.label } },
    },
  }, { responsive: true, displaylogo: false, displayModeBar: false });
}

async function draw(box) {
  if (box.dataset.chart) return drawChart(box);
  const sections = await prepared();
  const view = sections[box.closest("[data-number]").dataset.number].views[box.dataset.view];
  const plots = all("figure", box).map((figure) => [plotOf(figure), view.panels[figure.dataset.panel]]);
  for (const [element, panel] of plots) {
    await Plotly.react(element, traces(view, panel), layout(view, panel), { responsive: true, displaylogo: false, displayModeBar: false });
  }
  if (box.classList.contains("drawn")) return;
  box.classList.add("drawn");
  // the panels of a view show the same time
  for (const [element] of plots) {
    element.on("plotly_relayout", (change) => {
      const keys = ["xaxis.range[0]", "xaxis.range[1]", "xaxis.autorange"].filter((key) => key in change);
      if (!keys.length) return;
      const range = change["xaxis.autorange"] ? [view.begin, view.end] : [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      for (const [other] of plots) {
        const now = other.layout.xaxis.range;
        if (now[0] !== range[0] || now[1] !== range[1]) Plotly.relayout(other, { "xaxis.range": range });
      }
    });
  }
}

const watch = new IntersectionObserver((entries) => {
  for (const entry of entries) {
    if (entry.isIntersecting) {
      watch.unobserve(entry.target);
      draw(entry.target);
    }
  }
}, { rootMargin: "200px" });
const DRAWN = ".view[data-view], figure[data-chart]";
all(DRAWN).forEach((box) => watch.observe(box));

// light or dark as in the system, until the user chooses
const dark = matchMedia("(prefers-color-scheme: dark)");
const again = () => all(DRAWN).filter((box) => box.classList.contains("drawn")).forEach(draw);
one("#theme").addEventListener("click", () => {
  const now = root.dataset.theme ?? (dark.matches ? "dark" : "light");
  root.dataset.theme = now === "dark" ? "light" : "dark";
  again();
});
dark.addEventListener("change", again);

const filters = one("#filters");
function filter() {
  const words = filters.words.value.toLowerCase().split(/\s+/).filter(Boolean);
  const rows = all("#table tbody tr");
  for (const row of rows) {
    const chosen = ["which", "loop", "passed", "source"].every((key) => !filters[key]?.value || row.dataset[key] === filters[key].value);
    const text = row.textContent.toLowerCase();
    row.hidden = !(chosen && words.every((word) => text.includes(word)));
  }
  one("#shown").textContent = rows.filter((row) => !row.hidden).length + " of " + rows.length;
}
if (filters) {
  filters.addEventListener("input", filter);
  filters.addEventListener("submit", (event) => event.preventDefault());
  filter();
}

// each picture is once in the page: in its section, as the poster of the video
all("img[data-picture]").forEach((image) => { image.src = one("#" + image.dataset.picture + " .with-video img, #" + image.dataset.picture + " .description img").src; });
all(".with-video").forEach((box) => { one("video", box).poster = one("img", box).src; });

// a link opens its target
function opened() {
  const target = location.hash && document.getElementById(location.hash.slice(1));
  if (!target) return;
  for (let part = target; part; part = part.parentElement) if (part.tagName === "DETAILS") part.open = true;
  target.scrollIntoView();
}
addEventListener("hashchange", opened);
opened();

// print closed parts as well
let closed = [];
addEventListener("beforeprint", () => {
  closed = all("details:not([open])");
  closed.forEach((part) => { part.open = true; });
});
addEventListener("afterprint", () => closed.forEach((part) => { part.open = false; }));
