"""Tests of one group run one after the other, also where two processes share the work."""

from __future__ import annotations

import os

import pytest


@pytest.mark.xdist_group("groups")
def test_groups_are_kept(request: pytest.FixtureRequest) -> None:
    if "PYTEST_XDIST_WORKER" not in os.environ or not request.config.getoption("loadgroup", default=False):
        pytest.skip("needs `--numprocesses 2 --dist loadgroup`")
    # pytest-xdist marks a group for its scheduler by the end of the name
    assert request.node.nodeid.endswith("@groups")
