"""Scenario files and overrides with one mistake each: one error that names the key and its value."""

from __future__ import annotations

from pathlib import Path

import pytest

from . import overrides, scenarios, several
from .calling import Case, Refuse, call, given


@pytest.mark.parametrize(("content", "words"), scenarios.FILES.values(), ids=scenarios.FILES)
def test_a_bad_scenario_is_named(
    content: str | bytes, words: tuple[str, ...], lag: Path, refuse: Refuse
) -> None:
    (lag / "torn.py").write_text("def :\n")
    for name, course in scenarios.CSV.items():
        (lag / name).write_text(course)
    (lag / "bad.toml").write_bytes(content if isinstance(content, bytes) else content.encode())
    refuse(Case(given("run", "bad.toml"), words))


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize(("override", "words"), overrides.SETS.values(), ids=overrides.SETS)
def test_a_bad_override_is_named(override: str, words: tuple[str, ...], refuse: Refuse) -> None:
    refuse(Case(given("run", "lag.toml", "--set", override), words))


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize(("content", "words"), several.FILES.values(), ids=several.FILES)
def test_a_bad_scenario_of_several_fmus_is_named(
    content: str, words: tuple[str, ...], refuse: Refuse
) -> None:
    Path("bad.toml").write_text(content)
    refuse(Case(given("run", "bad.toml"), words))


@pytest.mark.usefixtures("lag")
@pytest.mark.parametrize(("override", "words"), several.SETS.values(), ids=several.SETS)
def test_a_bad_override_of_several_fmus_is_named(
    override: str, words: tuple[str, ...], refuse: Refuse
) -> None:
    Path("two.toml").write_text(several.TWO)
    refuse(Case(given("run", "two.toml", "--set", override), words))


@pytest.mark.parametrize(
    "content",
    [
        scenarios.metric("max()"),
        scenarios.metric("percentile(plant.x, 101)"),
        scenarios.edited("[loop]", '[loop]\nstop_when = "plant.x >"'),
        scenarios.WHOLE + '[[signal]]\nto = "controller.count"\nfile = "twice.csv"\n',
    ],
)
def test_a_hint_is_about_the_mistake(content: str, lag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (lag / "twice.csv").write_text("time,u\n0,x\n")
    (lag / "bad.toml").write_text(content)
    with pytest.MonkeyPatch.context() as patch:
        assert call(given("run", "bad.toml"), patch) == 2
    stderr = capsys.readouterr().err
    assert "lists types" not in stderr
    assert "keeps only the rows" not in stderr


@pytest.mark.parametrize("ends", [b"\r\n", b"\n"])
def test_a_scenario_of_windows_is_read(lag: Path, monkeypatch: pytest.MonkeyPatch, ends: bytes) -> None:
    content = b"\xef\xbb\xbf" + scenarios.WHOLE.encode().replace(b"\n", ends)
    (lag / "bom.toml").write_bytes(content)
    assert call(given("run", "bom.toml"), monkeypatch) == 0
