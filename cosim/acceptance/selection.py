"""Selection of scenarios by names, files and patterns."""

from __future__ import annotations

import fnmatch
from collections.abc import Sequence

from cosim import paths
from cosim.errors import ScenarioError


def select(words: Sequence[str]) -> list[str]:
    """Names and files of the selected scenarios, each once; by default all of `cosim list`.

    The words are names (`dob`), files (`my.toml`) and patterns of names (`dob/*`, `*` matches any text).
    Raises ScenarioError if a pattern matches no name, or if there is no scenario at all.
    """
    known = [name for name, _ in paths.list_scenarios()]
    if not words and not known:
        problem = f"no scenario files in {paths.folders_text()}"
        raise ScenarioError(problem, f"Set {paths.SCENARIOS_ENV} to your folder.")
    selected: list[str] = []
    for word in words or known:
        found = fnmatch.filter(known, word) if set(word) & set("*?[") and words else [word]
        if not found:
            problem = f"no scenario matches `{paths.brief(word)}`"
            raise ScenarioError(problem, "List the known names with `cosim list`.")
        selected += found
    return list(dict.fromkeys(selected))
