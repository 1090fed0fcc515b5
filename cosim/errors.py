"""Errors a user can cause and correct."""

from __future__ import annotations

import contextlib
import datetime
import difflib
from collections.abc import Iterable, Iterator
from typing import Any

from cosim.renamed import replacement

LONGEST = 500
"""Maximum length of the text of an unexpected error."""


class CosimError(Exception):
    """An error that a user can cause, in one sentence.

    Parameters
    ----------
    message
        The problem: names the object, its value and its limit in backticks.
    hint
        The remedy; empty if there is none.

    Attributes
    ----------
    key
        Key of the scenario that it concerns, if known.
    status
        Status in JSON and in the rows of a sweep.
    """

    status = "error"

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message, hint)
        self.message = message
        self.hint = hint
        self.key = ""

    def __str__(self) -> str:
        """Message and hint as on the command line."""
        return f"{self.message}\nhint: {self.hint}" if self.hint else self.message

    def to_dict(self) -> dict[str, str]:
        """Return plain data for JSON."""
        return {"status": self.status, "error": self.message, "hint": self.hint}


class ScenarioError(CosimError):
    """A scenario file or an override is wrong."""


class ExpressionError(CosimError):
    """A metric or `stop_when` expression is wrong."""


class FmuError(CosimError):
    """An FMU cannot be found, opened, initialized or stepped."""


class PlantError(CosimError):
    """A plant cannot be found or built, or failed in a step."""


class UnforeseenError(CosimError):
    """An unexpected error."""


def unforeseen(error: BaseException) -> UnforeseenError:
    """Error for an unexpected exception."""
    words = " ".join(str(error).split())[:LONGEST] or "no message"
    problem = f"unexpected error: {type(error).__name__}: {words}"
    failure = UnforeseenError(problem, "Show the origin with `-v` and report it.")
    failure.__cause__ = error
    return failure


def readable(text: str) -> str:
    """Foreign text for a message, without terminal codes and invisible characters."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t\xa0" else "\ufffd" for c in text)


def show(value: Any) -> str:
    """Value as in a TOML file, in backticks."""
    text = toml_text(value)
    return f"`{text if len(text) <= 60 else text[:57] + '...'}`"


def toml_text(value: Any) -> str:
    """Value as in a TOML file, texts and tables as in Python."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, datetime.date | datetime.time):
        return value.isoformat()
    if isinstance(value, list):
        return f"[{', '.join(map(toml_text, value))}]"
    return repr(value)


def similar(name: str, choices: Iterable[str]) -> str:
    """Hint that names the closest of `choices` or the new name, empty when none is close."""
    known = list(choices)
    if hint := replacement(name, known):
        return hint
    match = difflib.get_close_matches(name, known, n=1, cutoff=0.6)
    return f"Use `{match[0]}`." if match else ""


def closest(name: str, choices: Iterable[str]) -> str:
    """Hint that names the closest of `choices`, or lists them when none is close."""
    known = list(choices)
    if hint := similar(name, known):
        return hint
    if not known:
        return ""
    shown = ", ".join(f"`{choice}`" for choice in known[:20]) + (", ..." if len(known) > 20 else "")
    return f"Known names: {shown}."


@contextlib.contextmanager
def concerning(key: str) -> Iterator[None]:
    """Add the key of the scenario to errors in the block."""
    try:
        yield
    except CosimError as error:
        error.key = error.key or key
        raise
