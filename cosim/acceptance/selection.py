"""Which scenarios are meant: names, files and patterns of names."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator, Sequence

from cosim import paths
from cosim.errors import ScenarioError


def select(words: Sequence[str]) -> list[str]:
    """Names and files of the scenarios that are meant, each once; all of `cosim list` without a word.

    Parameters
    ----------
    words
        Names (`dob`), files (`my.toml`) and patterns of names (`dob/*`, where `*` stands for anything).

    Raises
    ------
    ScenarioError
        A pattern matches no name, or there is no scenario at all.
    """
    known = [name for name, _ in paths.list_scenarios()]
    if not words and not known:
        raise ScenarioError(
            f"no scenario files in {paths.folders_text()}", f"set {paths.SCENARIOS_ENV} to your folder"
        )
    return list(dict.fromkeys(meant(words, known) if words else known))


def meant(words: Sequence[str], known: Sequence[str]) -> Iterator[str]:
    """Names and files, patterns replaced by the known names that they match."""
    for word in words:
        if not set(word) & set("*?["):
            yield word
            continue
        found = fnmatch.filter(known, word)
        if not found:
            problem = f"no scenario matches `{paths.brief(word)}`"
            raise ScenarioError(problem, "`cosim list` shows the known names")
        yield from found
