"""Sections of the report: scenarios, studies and documents of one controller."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

Chapter = dict[str, Any]
"""Data of one scenario, see `chapter.chapter`."""


@dataclass
class Section:
    """One closed loop.

    Parameters
    ----------
    name
        Name of the controller.
    chapters
        Data of its scenarios, the nominal one first; see `chapter.chapter`.
    sweeps
        Data of its studies, see `sweeps.section`.
    documents
        Documents about it, see `page.document`.
    """

    name: str
    chapters: list[Chapter] = field(default_factory=list)
    sweeps: list[dict[str, Any]] = field(default_factory=list)
    documents: list[dict[str, str]] = field(default_factory=list)

    @property
    def claims(self) -> list[dict[str, Any]]:
        """Claims of all its scenarios."""
        return [claim for chapter in self.chapters for claim in chapter["claims"]]

    @property
    def held(self) -> int:
        """Number of passed claims."""
        return sum(claim["passed"] for claim in self.claims)

    @property
    def headline(self) -> dict[str, Any] | None:
        """Key number: of its first claim with a number, preferably one of a paper."""
        numbers = [claim for chapter in self.chapters[:1] for claim in chapter["claims"] if claim["number"]]
        return next((claim for claim in numbers if claim["paper"]), next(iter(numbers), None))


def made(
    chapters: Sequence[Chapter], sweeps: Sequence[dict[str, Any]], documents: Sequence[dict[str, str]]
) -> list[Section]:
    """Sections of a report; chapters and sweeps are numbered in their order."""
    found: dict[str, Section] = {}

    def of(loop: str) -> Section:
        return found.setdefault(loop, Section(loop))

    for number, chapter in enumerate(chapters):
        of(chapter["loop"]).chapters.append({**chapter, "number": number})
    for place, sweep in enumerate(sweeps):
        loop = sweep["scenario"].partition("/")[0]
        of(loop).sweeps.append({**sweep, "number": len(chapters) + place, "place": place + 1})
    for document in documents:
        if document["loop"] in found:
            found[document["loop"]].documents.append(document)
    return list(found.values())
