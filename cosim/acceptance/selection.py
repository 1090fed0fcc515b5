"""Selection of scenarios by names, files and patterns."""

from __future__ import annotations

import fnmatch
from collections.abc import Iterator, Sequence

from cosim import paths
from cosim.errors import ScenarioError


def select(words: Sequence[str]) -> list[str]:
    """Names and files of the selected scenarios, each once; by default all of `cosim list`.

    Parameters
    ----------
    words
        Names (`dob`), files (`my.toml`) and patterns of names (`dob/*`, where `*` matches any text).

    Raises
    ------
    ScenarioError
        A pattern matches no name, or there is no scenario at all.
    """
    known = [name for name, _ in paths.list_scenarios()]
    if not words and not known:
        raise ScenarioError(
            f"no scenario files in {paths.folders_text()}", f"Set {paths.SCENARIOS_ENV} to your folder."
        )
    return list(dict.fromkeys(meant(words, known) if words else known))


def meant(words: Sequence[str], known: Sequence[str]) -> Iterator[str]:
    """Names and files, with patterns replaced by the matching names."""
    for word in words:
        if not set(word) & set("*?["):
            yield word
            continue
        found = fnmatch.filter(known, word)
        if not found:
            problem = f"no scenario matches `{paths.brief(word)}`"
            raise ScenarioError(problem, "List the known names with `cosim list`.")
        yield from found
