"""Files that are there only when they are whole."""

from __future__ import annotations

from pathlib import Path

import pytest

from cosim.errors import CosimError
from cosim.writing import whole


def test_a_link_stays_one_and_leads_to_the_whole_file(tmp_path: Path) -> None:
    link, target = tmp_path / "link.csv", tmp_path / "deep" / "target.csv"
    target.parent.mkdir()
    target.write_text("before")
    link.symlink_to(target)
    with whole(link) as file:
        file.write_text("after")
        assert target.read_text() == "before"
    assert link.is_symlink()
    assert target.read_text() == "after"
    assert sorted(path.name for path in tmp_path.rglob("*.csv*")) == ["link.csv", "target.csv"]


def test_what_fails_half_way_leaves_the_file_of_before(tmp_path: Path) -> None:
    file = tmp_path / "x.csv"
    file.write_text("before")

    def write() -> None:
        with whole(file) as part:
            part.write_text("half")
            raise OSError(28, "No space left on device")

    with pytest.raises(CosimError, match=r"cannot write `.*x\.csv`: No space left on device"):
        write()
    assert file.read_text() == "before"
    assert [path.name for path in tmp_path.iterdir()] == ["x.csv"]
