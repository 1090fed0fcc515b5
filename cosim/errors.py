"""Errors a user can cause and correct."""

from __future__ import annotations

import contextlib
import difflib
from collections.abc import Iterable, Iterator

LONGEST = 500
"""Characters shown of an error that nobody foresaw."""


class CosimError(Exception):
    """A run that could not be done, said in one sentence.

    Parameters
    ----------
    message
        What is wrong: names the thing, its value and its limit in backticks.
    hint
        What to do about it, empty if nothing useful can be said.

    Attributes
    ----------
    key
        Key of the scenario that it concerns, where known.
    """

    def __init__(self, message: str, hint: str = "") -> None:
        super().__init__(message, hint)
        self.message = message
        self.hint = hint
        self.key = ""

    def __str__(self) -> str:
        """Message and hint as the command line shows them."""
        return f"{self.message}\nhint: {self.hint}" if self.hint else self.message


class ScenarioError(CosimError):
    """A scenario file or an override is wrong."""


class ExpressionError(CosimError):
    """A metric or `stop_when` expression is wrong."""


class FmuError(CosimError):
    """An FMU cannot be found, opened, initialised or stepped."""


class PlantError(CosimError):
    """A plant cannot be found or built, or failed in a step."""


class UnforeseenError(CosimError):
    """What should not happen."""


def unforeseen(error: BaseException) -> UnforeseenError:
    """Error of what should not happen."""
    words = " ".join(str(error).split())[:LONGEST] or "without a word"
    failure = UnforeseenError(
        f"this should not happen: {type(error).__name__}: {words}", "`-v` shows where; please report it"
    )
    failure.__cause__ = error
    return failure


def readable(text: str) -> str:
    """Text of others as a message may show it: no codes of terminals, nothing that cannot be seen."""
    if text.isprintable():
        return text
    return "".join(c if c.isprintable() or c in "\n\t\xa0" else "\ufffd" for c in text)


def similar(name: str, choices: Iterable[str]) -> str:
    """Hint that names the closest of `choices`, empty when none is close."""
    match = difflib.get_close_matches(name, list(choices), n=1, cutoff=0.6)
    return f"did you mean `{match[0]}`?" if match else ""


def closest(name: str, choices: Iterable[str]) -> str:
    """Hint that names the closest of `choices`, or lists them when none is close."""
    known = list(choices)
    if hint := similar(name, known):
        return hint
    if not known:
        return ""
    shown = ", ".join(f"`{choice}`" for choice in known[:20])
    return f"known here: {shown}" + (", ..." if len(known) > 20 else "")


@contextlib.contextmanager
def concerning(key: str) -> Iterator[None]:
    """Note on errors from within which key of the scenario they concern."""
    try:
        yield
    except CosimError as error:
        error.key = error.key or key
        raise
