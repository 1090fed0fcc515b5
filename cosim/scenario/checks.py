"""What types and ranges cannot say about a scenario: the time grid, one driver per target, known names."""

from __future__ import annotations

import keyword
import re

from cosim.errors import closest
from cosim.scenario.injection import INJECTED, Injection
from cosim.scenario.model import Criterion, FmuChoice, Loop, Scenario, Signal, Wire
from cosim.scenario.overrides import Overrides
from cosim.scenario.tables import IDENTITY, Fail, show

MAX_STEPS = 1e12
"""More steps than any run has; times beyond are never reached."""
TAKEN = {"plant", "loop", "time", "title", "description", "idle", "plot", *IDENTITY}
"""Names that mean something else in wires, columns and overrides."""


def check(scenario: Scenario, merged: Overrides) -> None:
    """Check a loaded scenario."""
    check_loop(scenario.loop, merged.fail)
    check_forms(merged)
    check_unique([("fmu", choice.name) for choice in scenario.fmu], merged.fail)
    for choice in scenario.fmu:
        check_fmu(choice, scenario.loop, merged.fail)
    check_unique(
        [
            *(("wire", wire.to) for wire in scenario.wire),
            *(("signal", signal.to) for signal in scenario.signal),
        ],
        merged.fail,
    )
    check_unique([("metric", metric.name) for metric in scenario.metric], merged.fail)
    check_unique([("criterion", criterion.id) for criterion in scenario.criterion], merged.fail)
    for wire in scenario.wire:
        check_wire(wire, scenario.loop, merged.fail)
    for signal in scenario.signal:
        check_signal(signal, merged.fail)
    for injection in scenario.inject:
        check_injection(injection, scenario.loop, merged.fail)
    metrics = [metric.name for metric in scenario.metric]
    for criterion in scenario.criterion:
        check_criterion(criterion, metrics, merged.fail)


def check_loop(loop: Loop, fail: Fail) -> None:
    """Check that the duration lies on the grid `k * step`."""
    if loop.duration / loop.step > MAX_STEPS:
        fail("loop.duration", f"is `{loop.duration}` s, that is more than {MAX_STEPS:g} steps")
    ratio = loop.duration / loop.step
    if loop.steps < 1 or abs(ratio - loop.steps) > 1e-6:
        nearest = max(1, loop.steps) * loop.step
        fail(
            "loop.duration",
            f"is `{loop.duration}` s, it must be a multiple of `loop.step` = `{loop.step}` s",
            f"the nearest is {nearest:.12g} s",
        )
    if loop.record_every > loop.steps:
        most = f"it must not be above {loop.steps}, the steps of the run"
        hint = "metrics would see the first row alone"
        fail("loop.record_every", f"is `{loop.record_every}`, {most}", hint)


def check_forms(merged: Overrides) -> None:
    """Check that there is either one FMU or a list of them."""
    hint = "one FMU is a table `[controller]`, several are tables `[[fmu]]`"
    if "fmu" not in merged.table:
        if "controller" not in merged.table:
            merged.fail("controller", "is missing", hint)
    elif "controller" in merged.table:
        merged.fail("fmu", "is there beside `controller`", hint)
    elif not merged.table["fmu"]:
        merged.fail("fmu", "is empty", hint)


def check_fmu(choice: FmuChoice, loop: Loop, fail: Fail) -> None:
    """Check that the name of an FMU can stand in wires and expressions, and its step on the grid."""
    key = f"fmu.{choice.name}"
    if not re.fullmatch(r"[A-Za-z_]\w*", choice.name, re.ASCII) or keyword.iskeyword(choice.name):
        letters = "letters, digits and `_`, with no digit first, and no word of Python"
        fail(f"{key}.name", f"is {show(choice.name)}, it must be made of {letters}")
    if choice.name in TAKEN:
        fail(f"{key}.name", f"is `{choice.name}`, which means something else here", "give it another name")
    if choice.step is not None and not MAX_STEPS > choice.step / loop.step > 0.5:
        fail(f"{key}.step", f"is `{choice.step}` s, it must be a multiple of `loop.step` = `{loop.step}` s")
    every = loop.every(choice.step)
    if every > loop.steps:
        fail(
            f"{key}.step", f"is `{choice.step}` s, it must not be above `loop.duration` = `{loop.duration}` s"
        )
    if choice.step is not None and abs(choice.step / loop.step - every) > 1e-6:
        hint = f"the nearest is {every * loop.step:.12g} s"
        fail(
            f"{key}.step",
            f"is `{choice.step}` s, it must be a multiple of `loop.step` = `{loop.step}` s",
            hint,
        )


def check_unique(keys: list[tuple[str, str]], fail: Fail) -> None:
    """Check that nothing is driven or named twice, or without a name."""
    seen: dict[str, str] = {}
    for section, name in keys:
        if not name and section != "fmu":
            fail(f"{section}.{name}.{IDENTITY[section]}", "is empty")
        if name in seen:
            fail(
                f"{section}.{name}",
                f"is there twice, as `{seen[name]}` and as `{section}`",
                "each target has one wire or one signal, each FMU, metric and criterion its own name",
            )
        seen[name] = section


def check_wire(wire: Wire, loop: Loop, fail: Fail) -> None:
    """Check the delay and the limits of a wire."""
    key = f"wire.{wire.to}"
    if not 0 <= wire.delay <= loop.steps:
        fail(
            f"{key}.delay", f"is `{wire.delay}` steps, it must lie in 0 .. {loop.steps}, the steps of the run"
        )
    check_order(key, wire, fail)


def check_order(key: str, limited: Wire | Criterion, fail: Fail) -> None:
    """Check that a minimum is not above its maximum."""
    low, high = limited.minimum, limited.maximum
    if low is not None and high is not None and low > high:
        fail(f"{key}.minimum", f"is `{low}`, it must not be above `maximum` = `{high}`")


def check_signal(signal: Signal, fail: Fail) -> None:
    """Check that a signal is told once, starts at 0 and its times rise."""
    key = f"signal.{signal.to}"
    if signal.file:
        if signal.times or signal.values:
            fail(f"{key}.file", "does not go with `times` and `values`", "a signal is told in one place")
        return
    if signal.column:
        fail(f"{key}.column", f"is `{signal.column}`, but the signal has no `file`")
    if len(signal.times) != len(signal.values):
        fail(key, f"has {len(signal.times)} `times` and {len(signal.values)} `values`, one each is needed")
    if not signal.times or signal.times[0] != 0.0:
        fail(f"{key}.times", "must start with 0.0")
    if any(not earlier < later for earlier, later in zip(signal.times, signal.times[1:], strict=False)):
        fail(f"{key}.times", "must rise from one to the next")


def check_injection(injection: Injection, loop: Loop, fail: Fail) -> None:
    """Check that an injection has one beginning, at most one end after it, and one kind."""
    key = f"inject.{injection.to}"
    begin, end = injection.from_time, injection.to_time
    check_kinds(key, injection, fail)
    if not injection.when and begin is None:
        fail(f"{key}.from_time", "is missing", "`from_time` (s) or `when` (a condition) says where it begins")
    if injection.when and begin is not None:
        fail(f"{key}.when", f"does not go with `from_time` = `{begin}` s", "either of them begins it")
    if injection.when and end is not None:
        hint = "`duration` (s) says how long it lasts"
        fail(f"{key}.to_time", f"is `{end}` s, but with `when` nobody knows its beginning", hint)
    if injection.after and not injection.when:
        fail(f"{key}.after", f"is `{injection.after}` s, but there is no `when`", "`from_time` alone says it")
    if injection.duration is not None and end is not None:
        fail(f"{key}.duration", f"does not go with `to_time` = `{end}` s", "either of them ends it")
    if begin is not None and end is not None and not begin < end:
        fail(f"{key}.to_time", f"is `{end}` s, it must be later than `from_time` = `{begin}` s")
    if injection.late is not None and injection.late > loop.steps:
        most = f"it must not be above {loop.steps}, the steps of the run"
        fail(f"{key}.late", f"is `{injection.late}` steps, {most}")


def check_kinds(key: str, injection: Injection, fail: Fail) -> None:
    """Check that an injection has one kind."""
    kinds, choices = injection.kinds, ", ".join(f"`{kind}`" for kind in INJECTED)
    if not kinds:
        fail(key, "does not say what happens to the value", f"give it one of {choices}")
    if len(kinds) > 1:
        hint = "each has one kind; several `[[inject]]` of one target act in their order"
        fail(f"{key}.{kinds[1]}", f"does not go with `{kinds[0]}`", hint)


def check_criterion(criterion: Criterion, metrics: list[str], fail: Fail) -> None:
    """Check that a criterion has a limit and names a metric that exists."""
    key = f"criterion.{criterion.id}"
    if criterion.metric not in metrics:
        fail(
            f"{key}.metric",
            f"is `{criterion.metric}`, there is no such metric",
            closest(criterion.metric, metrics),
        )
    limits = (criterion.minimum, criterion.maximum, criterion.equals)
    if all(limit is None for limit in limits):
        fail(key, "has no limit", "give it a `minimum`, a `maximum` or `equals`")
    if criterion.equals is not None and limits[:2] != (None, None):
        other = "minimum" if criterion.maximum is None else "maximum"
        fail(f"{key}.equals", f"is `{criterion.equals}`, it does not go with `{other}`", "two criteria can")
    check_order(key, criterion, fail)
