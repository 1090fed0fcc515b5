"""Arguments of the Python functions: scenarios by name or file, seeds, overrides, limits."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cosim

Write = Callable[..., Path]


def test_a_scenario_may_be_given_by_its_file(write: Write) -> None:
    file = write()
    whole = cosim.run(cosim.load(file), seed=3).trace
    assert whole is not None
    assert whole.tobytes() == cosim.run("lag.toml", seed=3).trace.tobytes()  # type: ignore[union-attr]
    assert [found.seed for found in cosim.run_many(file, [3, 4], workers=1)] == [3, 4]


@pytest.mark.parametrize("seed", ["x", -1, 1.5])
def test_a_seed_is_a_whole_number(seed: Any, write: Write) -> None:
    write()
    with pytest.raises(cosim.CosimError, match=r"`seed` is `.*`, it must be a non-negative integer"):
        cosim.run("lag.toml", seed=seed)


def test_a_seed_of_numpy_is_one(write: Write) -> None:
    write()
    assert cosim.run("lag.toml", seed=np.int64(7)).to_dict()["seed"] == 7  # type: ignore[arg-type]


@pytest.mark.parametrize("changes", [{"loop.seed": 1}, [1]])
def test_overrides_are_texts(changes: Any, write: Write) -> None:
    write()
    with pytest.raises(cosim.CosimError, match=r"`set` is `.*`, it must hold texts"):
        cosim.load("lag.toml", set=changes)


@pytest.mark.parametrize("limits", [{"timeout": float("inf")}, {"memory": 1e300}, {"memory": float("nan")}])
def test_limits_can_be_kept(limits: dict[str, float]) -> None:
    with pytest.raises(cosim.CosimError, match="must be positive and"):
        cosim.Limits(**limits)  # type: ignore[arg-type]
