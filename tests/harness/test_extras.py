"""Hints about packages that are not installed."""

from __future__ import annotations

from importlib import metadata

import pytest

from cosim import extras

LISTED = [
    "numpy>=2.0",
    "av>=17 ; extra == 'replay'",
    'gone-package[all]>=4,<5; extra == "replay"',
    "numpy>=2 ; extra == 'replay'",
    "other>=1 ; extra == 'report'",
]


def test_the_hint_names_missing_packages_that_a_registry_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(metadata, "requires", lambda _: LISTED)
    monkeypatch.setattr(extras, "version", lambda name: "1.0" if name in ("av", "numpy") else "")
    assert extras.hint("replay") == 'Run `pip install "gone-package[all]>=4,<5"`.'
    monkeypatch.setattr(extras, "version", lambda _: "1.0")
    assert extras.hint("report") == 'Run `pip install "other>=1"`.'
    monkeypatch.setattr(metadata, "requires", lambda _: None)
    assert extras.hint("replay") == "Install the packages of the extra `replay`."


def test_every_extra_has_packages() -> None:
    for extra in metadata.metadata("machining-fmus").get_all("Provides-Extra") or ():
        assert extras.hint(extra).startswith('Run `pip install "')
