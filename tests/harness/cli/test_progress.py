"""Progress where stderr is no terminal: lines that come now and then."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from cosim.show.console import ProgressLines
from cosim.sweep import study
from cosim.sweep.plan import Plan

from ..conftest import grid

Write = Callable[..., Path]


class Clock:
    def __init__(self) -> None:
        self.now = 100.0

    def __call__(self) -> float:
        return self.now


def reported(moments: list[tuple[float, int]], total: int) -> list[str]:
    """Lines about what was done at these times after the start, s."""
    lines: list[str] = []
    clock = Clock()
    progress = ProgressLines("lag", lines.append, clock)
    for time, done in moments:
        clock.now = 100.0 + time
        progress(done, total)
    return lines


def test_what_is_quick_is_not_reported() -> None:
    assert reported([(0.05 * done, done) for done in range(101)], 100) == []


def test_every_tenth_is_reported_once() -> None:
    lines = reported([(2.0 * done, done) for done in range(101)], 100)
    assert [line.split(" after")[0] for line in lines] == [f"lag: {share} %" for share in range(10, 101, 10)]
    assert lines[3] == "lag: 40 % after 0:01:20, about 0:02:00 left"


def test_what_is_slow_is_reported_every_minute() -> None:
    lines = reported([(float(done), done) for done in range(600)], 100_000)
    assert len(lines) == 9
    assert lines[0] == "lag: 0 % after 0:01:00, about 1 day, 3:45:40 left"


def test_what_was_done_before_does_not_count_as_speed() -> None:
    assert reported([(0.0, 90), (60.0, 95)], 100) == ["lag: 95 % after 0:01:00, about 0:01:00 left"]


def test_nothing_new_in_a_minute_promises_no_end() -> None:
    assert reported([(0.0, 0), (60.0, 0)], 100) == ["lag: 0 % after 0:01:00"]


def test_planning_is_reported(write: Write, folder: Path) -> None:
    write()
    (folder / "study.toml").write_text(grid(pole=[0.1, 0.2, 0.3]))
    heard: list[tuple[int, int]] = []
    Plan(study.load(folder / "study.toml"), progress=lambda done, total: heard.append((done, total)))
    assert heard == [(1, 3), (2, 3), (3, 3)]


@pytest.mark.parametrize("quiet", [True, False])
def test_a_sweep_without_a_terminal_shows_its_runs(
    quiet: bool,
    write: Write,
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    from cosim.show import console
    from cosim.sweep.command import Options, execute

    # every look is late enough for a line
    monkeypatch.setattr(console, "TENTH", 0.0)
    write()
    file = folder / "study.toml"
    file.write_text(grid(fail_at=[-1, 3]))
    execute(Options(file, folder / "out", workers=1, plots=False, quiet=quiet))
    reported = capsys.readouterr().err
    assert ("study, planning: 100 % after 0:00:0" in reported) is not quiet
    assert ("2 of 2 runs, 0 failed, 1 without result" in reported) is not quiet
