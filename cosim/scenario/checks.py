"""Rules for scenarios beyond types and ranges: time grid, one driver per target, known names."""

from __future__ import annotations

import keyword
import re
from collections.abc import Iterable

from cosim.errors import closest, show
from cosim.scenario.injection import INJECTED, Injection
from cosim.scenario.model import Criterion, FmuChoice, Loop, Scenario, Signal, Wire
from cosim.scenario.overrides import Overrides
from cosim.scenario.tables import IDENTITY, Fail

MAX_STEPS = 1e12
"""Maximum number of steps; later times are never reached."""
TAKEN = {"plant", "loop", "time", "title", "description", "undriven", "plot", *IDENTITY}
"""Names with another meaning in wires, columns and overrides."""


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
    check_streams(scenario.wire, merged.fail)
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
        fail("loop.duration", f"is `{loop.duration}` s, which is more than {MAX_STEPS:g} steps")
    ratio = loop.duration / loop.step
    if loop.steps < 1 or abs(ratio - loop.steps) > 1e-6:
        nearest = max(1, loop.steps) * loop.step
        fail(
            "loop.duration",
            f"is `{loop.duration}` s, it must be a multiple of `loop.step` = `{loop.step}` s",
            f"Use {nearest:.12g} s.",
        )
    if loop.record_every > loop.steps:
        most = f"it must not exceed the {loop.steps} steps of the run"
        hint = "Metrics would have only the first row."
        fail("loop.record_every", f"is `{loop.record_every}`, {most}", hint)


def check_forms(merged: Overrides) -> None:
    """Check that there is either one FMU or a list of FMUs."""
    hint = "Use a table `[controller]` for one FMU, tables `[[fmu]]` for several."
    if "fmu" not in merged.table:
        if "controller" not in merged.table:
            merged.fail("controller", "is missing", hint)
    elif "controller" in merged.table:
        merged.fail("fmu", "cannot be combined with `controller`", hint)
    elif not merged.table["fmu"]:
        merged.fail("fmu", "is empty", hint)


def check_fmu(choice: FmuChoice, loop: Loop, fail: Fail) -> None:
    """Check that the name of an FMU is valid in wires and expressions, and its step is on the grid."""
    key = f"fmu.{choice.name}"
    if not re.fullmatch(r"[A-Za-z_]\w*", choice.name, re.ASCII) or keyword.iskeyword(choice.name):
        letters = "letters, digits and `_`, without a leading digit, and not a Python keyword"
        fail(f"{key}.name", f"is {show(choice.name)}, it must consist of {letters}")
    if choice.name in TAKEN:
        fail(f"{key}.name", f"is `{choice.name}`, which is a reserved name", "Choose another name.")
    if choice.step is not None and not MAX_STEPS > choice.step / loop.step > 0.5:
        fail(f"{key}.step", f"is `{choice.step}` s, it must be a multiple of `loop.step` = `{loop.step}` s")
    every = loop.every(choice.step)
    if every > loop.steps:
        fail(
            f"{key}.step", f"is `{choice.step}` s, it must not be above `loop.duration` = `{loop.duration}` s"
        )
    if choice.step is not None and abs(choice.step / loop.step - every) > 1e-6:
        hint = f"Use {every * loop.step:.12g} s."
        fail(
            f"{key}.step",
            f"is `{choice.step}` s, it must be a multiple of `loop.step` = `{loop.step}` s",
            hint,
        )


def check_unique(keys: list[tuple[str, str]], fail: Fail) -> None:
    """Check that names and driven targets are unique and not empty."""
    seen: dict[str, str] = {}
    for section, name in keys:
        if not name and section != "fmu":
            fail(f"{section}.{name}.{IDENTITY[section]}", "is empty")
        if name in seen:
            fail(
                f"{section}.{name}",
                f"is given twice, as `{seen[name]}` and as `{section}`",
                "Give each target one wire or signal, and each FMU, metric and criterion its own name.",
            )
        seen[name] = section


def check_wire(wire: Wire, loop: Loop, fail: Fail) -> None:
    """Check the delay and the limits of a wire."""
    key = f"wire.{wire.to}"
    if not 0 <= wire.delay <= loop.steps:
        fail(
            f"{key}.delay", f"is `{wire.delay}` steps, it must be in 0 .. {loop.steps}, the steps of the run"
        )
    check_order(key, wire, fail)


def check_streams(wires: Iterable[Wire], fail: Fail) -> None:
    """Check that no two wires share a random stream: their noise would be the same."""
    seen: dict[str, Wire] = {}
    for wire in wires:
        stream = wire.stream or wire.to
        other = seen.setdefault(stream, wire)
        if other is not wire:
            named, without = (wire, other) if wire.stream else (other, wire)
            fail(
                f"wire.{named.to}.stream",
                f"is `{stream}`, the stream of `wire.{without.to}`",
                "Give each wire its own stream.",
            )


def check_order(key: str, limited: Wire | Criterion, fail: Fail) -> None:
    """Check that a minimum is not above its maximum."""
    low, high = limited.minimum, limited.maximum
    if low is not None and high is not None and low > high:
        fail(f"{key}.minimum", f"is `{low}`, it must not be above `maximum` = `{high}`")


def check_signal(signal: Signal, fail: Fail) -> None:
    """Check that a signal is given once, starts at 0 and has increasing times."""
    key = f"signal.{signal.to}"
    if signal.file:
        if signal.times or signal.values:
            fail(
                f"{key}.file",
                "cannot be combined with `times` and `values`",
                "Use either a file, or `times` and `values`.",
            )
        return
    if signal.column:
        fail(f"{key}.column", f"is `{signal.column}`, but the signal has no `file`")
    if len(signal.times) != len(signal.values):
        fail(
            key,
            f"has {len(signal.times)} `times` and {len(signal.values)} `values`, but needs equal numbers",
        )
    if not signal.times or signal.times[0] != 0.0:
        fail(f"{key}.times", "must start with 0.0")
    if any(not earlier < later for earlier, later in zip(signal.times, signal.times[1:], strict=False)):
        fail(f"{key}.times", "must increase")


def check_injection(injection: Injection, loop: Loop, fail: Fail) -> None:
    """Check that an injection has one start, at most one end after it, and one kind."""
    key = f"inject.{injection.to}"
    begin, end = injection.from_time, injection.to_time
    check_kinds(key, injection, fail)
    if not injection.when and begin is None:
        fail(f"{key}.from_time", "is missing", "Give `from_time` (s) or `when` (a condition) as its start.")
    if injection.when and begin is not None:
        fail(f"{key}.when", f"cannot be combined with `from_time` = `{begin}` s", "Give only one of them.")
    if injection.when and end is not None:
        hint = "Use `duration` (s)."
        fail(f"{key}.to_time", f"is `{end}` s, but with `when` its start is unknown", hint)
    if injection.after and not injection.when:
        fail(
            f"{key}.after",
            f"is `{injection.after}` s, but there is no `when`",
            "Include the delay in `from_time`.",
        )
    if injection.duration is not None and end is not None:
        fail(f"{key}.duration", f"cannot be combined with `to_time` = `{end}` s", "Give only one of them.")
    if begin is not None and end is not None and not begin < end:
        fail(f"{key}.to_time", f"is `{end}` s, it must be later than `from_time` = `{begin}` s")
    if injection.late is not None and injection.late > loop.steps:
        most = f"it must not exceed the {loop.steps} steps of the run"
        fail(f"{key}.late", f"is `{injection.late}` steps, {most}")


def check_kinds(key: str, injection: Injection, fail: Fail) -> None:
    """Check that an injection has one kind."""
    kinds, choices = injection.kinds, ", ".join(f"`{kind}`" for kind in INJECTED)
    if not kinds:
        fail(key, "has no kind", f"Give one of {choices}.")
    if len(kinds) > 1:
        hint = "Give one kind each; several `[[inject]]` of one target act in their order."
        fail(f"{key}.{kinds[1]}", f"cannot be combined with `{kinds[0]}`", hint)


def check_criterion(criterion: Criterion, metrics: list[str], fail: Fail) -> None:
    """Check that a criterion has a limit and names a metric that exists."""
    key = f"criterion.{criterion.id}"
    if criterion.metric not in metrics:
        fail(
            f"{key}.metric",
            f"is `{criterion.metric}`, which is not a metric of the scenario",
            closest(criterion.metric, metrics),
        )
    limits = (criterion.minimum, criterion.maximum, criterion.equals)
    if all(limit is None for limit in limits):
        fail(key, "has no limit", "Give a `minimum`, a `maximum` or `equals`.")
    if criterion.equals is not None and limits[:2] != (None, None):
        other = "minimum" if criterion.maximum is None else "maximum"
        fail(
            f"{key}.equals",
            f"is `{criterion.equals}`, it cannot be combined with `{other}`",
            "Use two criteria.",
        )
    check_order(key, criterion, fail)
