"""An FMU without a plant: signals drive it, its outputs are traced and evaluated."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import cosim
from cosim.errors import CosimError
from cosim.loop.session import Session

from ..conftest import entry

Write = Callable[..., Path]
ALONE = (
    """
title = "The probe alone"
loop = {step = 0.001, duration = 0.05, substeps = 3}
controller = {fmu = "probe", parameters = {gain = 2.0}}
"""
    + entry("signal", to="controller.in", times=[0.0, 0.02], values=[1.0, -3.0])
    + entry("inject", to="controller.in", from_time=0.03, to_time=0.04, value=7.0)
    + entry("metric", name="end", value="last(controller.out)")
    + entry("criterion", id="end", claim="The gain holds", metric="end", equals=-6.0)
)


@pytest.mark.parametrize("engine", ["reference", "native"])
def test_signals_and_injections_drive_it(write: Write, engine: str) -> None:
    result = cosim.run(cosim.load(write(text=ALONE)), engine=engine)  # type: ignore[arg-type]
    assert result.engine == engine
    assert result.trace is not None
    expected = np.repeat([1.0, -3.0, 7.0, -3.0], [20, 10, 10, 10])
    assert np.array_equal(result.trace["controller.in"], expected)
    assert np.array_equal(result.trace["controller.out"], 2.0 * expected)
    assert [name for name in result.trace.dtype.names or () if name.startswith("plant.")] == []
    assert result.passed


def test_both_engines_give_the_same_bytes(write: Write) -> None:
    scenario = cosim.load(write(text=ALONE))
    traces = [cosim.run(scenario, engine=engine).trace for engine in ("reference", "native")]
    assert traces[0] is not None
    assert traces[1] is not None
    assert traces[0].tobytes() == traces[1].tobytes()


def test_another_step_takes_over_what_is_open(write: Write) -> None:
    file = write(text=ALONE)
    first = Session(cosim.load(file), engine="native")
    with Session(
        cosim.load(file, set=["loop.step=0.002", "loop.substeps=1"]), engine="native", previous=first
    ) as second:
        result = second.run()
        assert second.fmu is first.fmu
        assert result.trace is not None
        assert len(result.trace) == 25


@pytest.mark.parametrize(
    ("change", "reported"),
    [
        ('[[wire]]\nfrom = "plant.x"\nto = "controller.in"\n', "the scenario has no plant"),
        ('[[signal]]\nto = "plant.u"\ntimes = [0.0]\nvalues = [1.0]\n', "the scenario has no plant"),
        ("[plant.parameters]\npole = 0.5\n", "`plant.name` is missing"),
        ("[plant]\n", "`plant.name` is missing"),
        ('[[metric]]\nname = "x"\nvalue = "last(plant.x)"\n', "names `plant.x`"),
    ],
)
def test_what_needs_a_plant_says_so(write: Write, change: str, reported: str) -> None:
    text = ALONE.replace('to = "controller.in"\ntimes', 'to = "controller.gain"\ntimes').split("[[metric]]")[
        0
    ]
    with pytest.raises(CosimError, match=reported):
        cosim.run(cosim.load(write(text=text + change)))


def test_a_sweep_varies_it(write: Write, folder: Path) -> None:
    write(text=ALONE)
    (folder / "study.toml").write_text(
        'scenario = "lag.toml"\n[design]\nkind = "grid"\n'
        '[[vary]]\nkey = "controller.gain"\nvalues = [1.0, 2.0]\n'
    )
    from cosim.sweep.command import Options, execute

    found, _ = execute(Options(folder / "study.toml", folder / "out", workers=1, plots=False, quiet=True))
    assert dict(found.statuses) == {"passed": 1, "failed": 1}
