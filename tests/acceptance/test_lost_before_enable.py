"""A measurement that is missing from the first sample on: a request for a cycle is answered by a fault.

A sensor may start after the controller. A request without an answer is a wait without an end.
"""

from __future__ import annotations

from dataclasses import replace
from math import nan

import pytest

import cosim
from cosim.scenario.injection import Injection
from cosim.scenario.model import Plot, Signal

PROBES = ("probe_depth", "probe_lateral", "probe_angle")
"""Inputs of `fts` that only a calibration uses."""


def measurements() -> list[tuple[str, str]]:
    """Loops with the Real inputs that their plants measure."""
    loops = {name: cosim.load(name) for name in ("centering", "deburr", "dob", "fts", "polish")}
    return [
        (name, wire.to)
        for name, scenario in loops.items()
        for wire in scenario.wire
        if wire.to.startswith("controller.") and not wire.to.endswith((".contact", *PROBES))
    ]


@pytest.mark.parametrize(("name", "input_name"), measurements())
def test_a_request_without_a_measurement_is_answered(name: str, input_name: str) -> None:
    scenario = cosim.load(name, set=["loop.duration=0.06", 'loop.stop_when=""'])
    scenario = replace(
        scenario,
        metric=(),
        criterion=(),
        plot=Plot(),
        signal=(
            *(signal for signal in scenario.signal if signal.to != "controller.enable"),
            Signal("controller.enable", times=(0.0, 0.01), values=(False, True)),
        ),
        inject=(Injection(input_name, 0.0, value=nan),),
    )
    result = cosim.run(scenario, engine="native")
    assert result.trace is not None
    faults = result.trace["controller.fault"]
    assert (faults != result.items["controller.fault"]["None"]).any()
