"""Plugin of pytest: `pytest --cosim scenarios` runs scenarios, a test for each criterion.

pytest imports this module at every start, so it imports the harness only if `--cosim` is given.
"""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

if TYPE_CHECKING:
    from cosim.loop.result import Result

FOLDER = "scenarios"
"""Folder below which each TOML file is a scenario; other files are collected if they are named."""
WITHOUT_CRITERIA = "run"
"""Name of the test of a scenario without criteria, as in the JUnit file of `cosim test`."""


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the option that enables the plugin."""
    text = "run cosim scenarios (`scenarios/**/*.toml`), a test per criterion"
    parser.getgroup("cosim").addoption("--cosim", action="store_true", help=text)


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marker of pytest-xdist, which is optional."""
    if config.getoption("cosim") and not config.pluginmanager.hasplugin("xdist"):
        config.addinivalue_line("markers", "xdist_group(name): tests that one worker of pytest-xdist runs")


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> ScenarioFile | None:
    """Collect a scenario."""
    if not parent.config.getoption("cosim") or file_path.suffix != ".toml":
        return None
    if FOLDER not in file_path.parent.parts and not parent.session.isinitpath(file_path):
        return None
    return ScenarioFile.from_parent(parent, path=file_path)


class ScenarioFile(pytest.File):
    """A scenario, which runs once, in the first of its tests."""

    def __init__(self, **arguments: Any) -> None:
        super().__init__(**arguments)
        # with `--dist loadgroup` one worker gets all tests of a scenario, and runs it once
        self.add_marker(pytest.mark.xdist_group(name=self.nodeid))

    def collect(self) -> Iterator[pytest.Item]:
        """Load the scenario and make its tests."""
        from cosim.errors import CosimError
        from cosim.scenario.load import load

        try:
            self.scenario = load(self.path)
        except CosimError as error:
            raise self.CollectError(str(error)) from None
        for identifier in [criterion.id for criterion in self.scenario.criterion] or [WITHOUT_CRITERIA]:
            yield CriterionItem.from_parent(self, name=identifier)

    @functools.cached_property
    def outcome(self) -> Result | Exception:
        """Result of the run without its trace, or the error that ended it."""
        from cosim.errors import CosimError
        from cosim.pool.runs import run

        try:
            return dataclasses.replace(run(self.scenario, engine="native", isolated=True), trace=None)
        except CosimError as error:
            return error


class CriterionItem(pytest.Item):
    """A criterion of a scenario."""

    parent: ScenarioFile

    def runtest(self) -> None:
        """Evaluate the criterion."""
        from cosim.formatting import verdicts

        outcome = self.parent.outcome
        if isinstance(outcome, Exception):
            pytest.fail(str(outcome), pytrace=False)
        verdict = next((found for found in outcome.criteria if found.criterion.id == self.name), None)
        if verdict is None:
            pytest.skip(verdicts.NOTHING_DEMANDED)
        self.user_properties += [("value", verdict.value), ("unit", verdict.unit)]
        if not verdict.passed:
            limit = f", limit {limits}" if (limits := verdicts.limits(verdict)) else ""
            measured = f"`{verdict.criterion.metric}` is {verdicts.measured(verdict)}{limit}"
            pytest.fail(f"{verdict.criterion.claim}: {measured}", pytrace=False)

    def reportinfo(self) -> tuple[Path, None, str]:
        """File and name of the test."""
        return self.path, None, f"{self.parent.scenario.name}: {self.name}"
