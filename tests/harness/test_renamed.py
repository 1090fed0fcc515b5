"""A name that an FMU has replaced gets an error with the new name."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim import renamed


@pytest.fixture(autouse=True)
def table(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(renamed, "REPLACEMENTS", {})
    (tmp_path / "resources").mkdir()
    (tmp_path / renamed.FILE).write_text(
        '[variables]\n"teach.place" = "calibration.position"\n"cusum.drift" = ""\ngain = "scale"\n'
        '"x[1]" = "first"\n[items.State]\nTeach = "Calibrate"\n'
    )
    renamed.learn(tmp_path)


@pytest.mark.parametrize(
    ("name", "hint"),
    [
        ("teach.place", "Use `calibration.position`, the new name of `teach.place`."),
        (
            "controller.teach.place",
            "Use `controller.calibration.position`, the new name of `controller.teach.place`.",
        ),
        ("gain[2]", "Use `scale[2]`, the new name of `gain[2]`."),
        ("x[1]", "Use `first`, the new name of `x[1]`."),
        ("Teach", "Use `Calibrate`, the new name of `Teach`."),
        ("a.cusum.drift", "Remove `a.cusum.drift`: the FMU no longer has it."),
        ("teach", ""),
        ("x[2]", ""),
    ],
)
def test_the_hint_names_the_replacement(name: str, hint: str) -> None:
    assert renamed.replacement(name) == hint


@pytest.mark.parametrize("text", ["not TOML", "variables = 3\nitems = 4\n", "[items]\nState = 1\n"])
def test_a_file_of_another_form_is_ignored(tmp_path: Path, text: str) -> None:
    (tmp_path / renamed.FILE).write_text(text)
    renamed.learn(tmp_path)
    assert renamed.replacement("teach.place")


def test_the_known_names_select_among_the_replacements_of_several_fmus(tmp_path: Path) -> None:
    for table in ('"time" = ""\n"job" = "cycle"\n', '"time" = "expert.time"\n"job" = "expert.cycle"\n'):
        (tmp_path / renamed.FILE).write_text(f"[variables]\n{table}")
        renamed.learn(tmp_path)
    known = ["c.expert.time", "c.expert.cycle"]
    assert renamed.replacement("c.time", known) == "Use `c.expert.time`, the new name of `c.time`."
    assert renamed.replacement("c.job", known) == "Use `c.expert.cycle`, the new name of `c.job`."
    assert renamed.replacement("job", ["cycle"]) == "Use `cycle`, the new name of `job`."
    assert renamed.replacement("time", ["cycle"]) == "Remove `time`: the FMU no longer has it."
