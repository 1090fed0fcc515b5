"""The FMUs with a defect, made once; a folder that holds what the bad inputs speak of."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..conftest import END
from . import fmus
from .calling import Refuse, refused


@pytest.fixture
def lag(write: object, folder: Path) -> Path:
    """Write the lag scenario with a metric and a criterion into a folder of its own."""
    assert callable(write)
    write(END + '[[criterion]]\nid = "end"\nclaim = "ends"\nmetric = "end"\nmaximum = 1.0\n')
    return folder


@pytest.fixture
def refuse(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> Refuse:
    """Check that a bad input is rejected correctly."""
    return lambda case: refused(case, monkeypatch, capsys)


@pytest.fixture
def broken(lag: Path, broken_library: bytes, request: pytest.FixtureRequest) -> str:
    """FMU with the defect that the test is parametrized with."""
    build, _ = (fmus.FILES | fmus.WARNED)[request.param]
    build(lag / "broken.fmu", broken_library)
    return "broken.fmu"
