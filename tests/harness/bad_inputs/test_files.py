"""MJCF files and studies with one mistake each."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from . import models, studies
from .calling import Case, Refuse, given


@pytest.mark.parametrize(("content", "words"), models.FILES.values(), ids=models.FILES)
def test_a_bad_model_is_named(content: str, words: tuple[str, ...], lag: Path, refuse: Refuse) -> None:
    (lag / "model.xml").write_text(content)
    (lag / "model.toml").write_text(models.WIRED)
    refuse(Case(given("run", "model.toml"), words))


@pytest.mark.parametrize(("content", "words"), studies.FILES.values(), ids=studies.FILES)
def test_a_bad_study_is_named(
    content: str | bytes, words: tuple[str, ...], lag: Path, refuse: Refuse
) -> None:
    for name, table in studies.CSV.items():
        (lag / name).write_bytes(table)
    (lag / "cache").mkdir(exist_ok=True)
    (lag / "zero.csv").symlink_to("/dev/zero")
    os.mkfifo(lag / "pipe.csv")
    (lag / "study.toml").write_bytes(content if isinstance(content, bytes) else content.encode())
    refuse(Case(given("sweep", "study.toml", "--no-plots"), words))
    assert not (lag / "study.sweep").exists()
