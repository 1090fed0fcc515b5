"""Parts of the HTML report: thinned and packed columns, drawings, videos."""

from __future__ import annotations

import base64
import json
import shutil
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any
from unittest.mock import Mock

import numpy as np
import pytest
from lxml import html

import cosim
from cosim.acceptance import runner
from cosim.acceptance.job import RecordedJob
from cosim.errors import CosimError
from cosim.pool.job import Outcome
from cosim.report import command as report
from cosim.report import drawing
from cosim.report.charts import STEPS, packed_values
from cosim.report.job import VideoJob
from cosim.show.plot import Curve, PanelData, PlotView
from cosim.trace.columns import BUCKETS, thinned

from ..cli.commands import cosim as command
from ..conftest import DATA, SCENARIO
from .traces import points, texts, unpacked

NAN = float("nan")


def test_no_peak_is_lost() -> None:
    values = np.sin(np.linspace(0.0, 20.0, 100_003))
    values[[17, 51_234]] = 40.0, -30.0
    found = thinned(values)
    assert len(found) == 2 * BUCKETS
    assert (found.max(), found.min()) == (40.0, -30.0)
    # in the order of the time: the peak in the first part, the dip where it was
    assert np.argmax(found) // 2 == 0
    assert np.argmin(found) // 2 == 51_234 * BUCKETS // 100_003
    assert np.abs(np.sort(found) - found).max() > 1.0


def test_a_short_column_stays_as_it_is() -> None:
    values = np.random.default_rng(5).normal(size=2 * BUCKETS)
    assert np.array_equal(thinned(values), values)


def test_what_is_no_number_stays_none() -> None:
    values = np.full(10_000, NAN)
    values[5000:] = 3.0
    found = unpacked(packed_values(thinned(values)))
    half = len(found) // 2
    assert np.all(np.isnan(found[:half]))
    assert np.all(found[half:] == 3.0)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e12])
def test_packed_values_are_closer_than_a_pixel(scale: float) -> None:
    values = scale * np.random.default_rng(7).normal(size=500)
    values[3] = NAN
    found = unpacked(packed_values(values))
    assert np.isnan(found[3])
    assert np.nanmax(np.abs(found - values)) <= 0.5 / STEPS * np.ptp(values[np.isfinite(values)]) * (1 + 1e-6)


def shown(line: np.ndarray, log: bool = False, items: dict[str, int] | None = None) -> str:
    """Drawing of a panel with one line."""
    curve = Curve("y", np.linspace(0.0, 2.0, len(line)), line, stepped=False)
    panel = PanelData("t", "m", [curve], log, items or {})
    return drawing.views([PlotView("run", 0.0, 2.0, [(1.0, "hit")], [panel])])


def test_a_drawing_shows_values_from_low_to_high_within_its_frame() -> None:
    svg = shown(np.sqrt(np.linspace(0.0, 1.0, 100)))
    x, y = points(svg, "#1f77b4").T
    assert np.all(np.diff(x) > 0.0)
    assert np.all(np.diff(y) < 0.0)
    ((middle, _), _) = points(svg, "#595959")
    assert middle == pytest.approx(0.5 * (x[0] + x[-1]), abs=1.0)
    assert {"t (m)", "time (s), run", "hit"} <= set(texts(svg))


def test_a_drawing_is_interrupted_where_there_is_no_number() -> None:
    assert len(points(shown(np.array([1.0, 2.0, NAN, 4.0, 5.0])), "#1f77b4")) == 4


def test_a_logarithmic_drawing_leaves_out_what_is_not_positive() -> None:
    heights = points(shown(np.array([-1.0, 0.0, 1.0, 100.0, 10.0, 1000.0]), log=True), "#1f77b4")[:, 1]
    assert len(heights) == 4
    parts = (heights[0] - heights) / (heights[0] - heights[-1])
    assert parts == pytest.approx([0.0, 2 / 3, 1 / 3, 1.0], abs=0.02)


def test_the_items_that_come_are_named_at_the_axis_and_escaped() -> None:
    items = {"<Idle>": 1, "Never": 2, "it's": 3, 'a"b': 4, "Run & on": 5}
    svg = shown(np.array([1.0, 3.0, 3.0, 4.0, 5.0]), items=items)
    assert [text for text in texts(svg) if text in items] == ["<Idle>", "it's", 'a"b', "Run & on"]
    assert '"' not in svg


def test_a_drawing_without_content_is_none() -> None:
    assert drawing.views([]) == drawing.charts([]) == ""


def encoded(content: bytes) -> str:
    return base64.b64encode(content).decode()


def test_a_video_that_is_too_large_becomes_a_picture(tmp_path: Path) -> None:
    (tmp_path / "a.mp4").write_bytes(bytes(report.MAX_VIDEO + 100_000))
    (tmp_path / "a.jpg").write_bytes(b"still")
    reported = "it has 1.1 MB, the limit is 1 MB\nhint: Make it with `cosim video`."
    assert report.encoded_video(tmp_path / "a.mp4") == {"picture": encoded(b"still"), "no_video": reported}


def test_one_scenario_of_each_loop_is_recorded(write: Callable[..., Path], monkeypatch: Any) -> None:
    write()
    scenario = cosim.load("lag.toml")
    result = cosim.run(scenario)

    def run(names: Sequence[str], options: runner.RunOptions, change: Any) -> runner.Outcomes:
        for name in names:
            job = change(name, RecordedJob(scenario, 7))
            assert job.keep_trace
            job.section.write_text(json.dumps({"name": name}))
        return {name: CosimError("not run") if name == "dob" else result for name in names}

    def outcomes(jobs: Mapping[str, VideoJob], options: runner.RunOptions) -> Iterator[tuple[str, Outcome]]:
        for name, job in jobs.items():
            assert (job.scenario, job.seed) == (scenario, 7)
            job.video.write_bytes(b"video")
            job.video.with_suffix(".jpg").write_bytes(b"still")
            yield name, CosimError("too dark") if name == "fts/lens" else result

    monkeypatch.setattr(runner, "run", run)
    monkeypatch.setattr(runner, "outcomes", outcomes)
    names = ["dob", "dob/nan", "fts/lens", "fts", "dob/10"]
    _, sections = report.run_scenarios(report.Contents("", names), runner.RunOptions())
    assert sections == [
        {"name": "dob/nan", "video": encoded(b"video"), "picture": encoded(b"still")},
        {"name": "fts/lens", "no_video": "too dark"},
        {"name": "fts"},
        {"name": "dob/10"},
    ]
    _, sections = report.run_scenarios(report.Contents("", names, videos=False), runner.RunOptions())
    assert sections == [{"name": name} for name in names[1:]]


def test_nothing_is_run_for_a_video_that_cannot_be_drawn(
    write: Callable[..., Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def dark(size: tuple[int, int]) -> None:
        raise CosimError("too dark")

    write()
    bench = Mock()
    monkeypatch.setattr("cosim.replay.renderer.graphics", dark)
    with pytest.raises(CosimError, match="too dark"):
        VideoJob(cosim.load("lag.toml"), 1, video=Path("lag.mp4")).run(bench)
    bench.session.assert_called_once()
    bench.session.return_value.run.assert_not_called()


@pytest.mark.skipif(sys.platform != "linux", reason="worker processes of Linux")
def test_a_video_that_ends_its_process_loses_no_run(write: Callable[..., Path], folder: Path) -> None:
    write(text=SCENARIO.replace("probe_plants:Lag", "hostile_plants:EndInFilm"))
    shutil.copy(DATA / "hostile_plants.py", folder)
    done = command("report", "lag.toml", "-o", "lag.html", "-q")
    assert (done.returncode, done.stdout) == (0, "wrote lag.html\n"), done.stderr
    (note,) = html.fromstring((folder / "lag.html").read_text()).find_class("note")
    assert "ended the process with exit code 3" in note.text_content()
