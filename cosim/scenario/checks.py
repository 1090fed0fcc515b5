"""Rules for scenarios beyond types and ranges: time grid, one driver per target, known names."""

from __future__ import annotations

import itertools
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
    loop, fail = scenario.loop, merged.fail
    check_loop(loop, fail)
    check_forms(merged)
    check_unique(scenario, ("fmu",), fail)
    for choice in scenario.fmu:
        check_fmu(choice, loop, fail)
    for sections in (("wire", "signal"), ("metric",), ("criterion",)):
        check_unique(scenario, sections, fail)
    for wire in scenario.wire:
        check_wire(wire, loop, fail)
    check_streams(scenario.wire, fail)
    for signal in scenario.signal:
        check_signal(signal, fail)
    for injection in scenario.inject:
        check_injection(injection, loop, fail)
    metrics = [metric.name for metric in scenario.metric]
    for criterion in scenario.criterion:
        check_criterion(criterion, metrics, fail)


def check_loop(loop: Loop, fail: Fail) -> None:
    """Check that the duration lies on the grid `k * step`."""
    key, ratio = "loop.duration", loop.duration / loop.step
    if ratio > MAX_STEPS:
        fail(key, f"is `{loop.duration}` s, which is more than {MAX_STEPS:g} steps")
    if loop.steps < 1 or abs(ratio - loop.steps) > 1e-6:
        problem = f"is `{loop.duration}` s, it must be a multiple of `loop.step` = `{loop.step}` s"
        fail(key, problem, f"Use {max(1, loop.steps) * loop.step:.12g} s.")
    if loop.record_every > loop.steps:
        problem = f"is `{loop.record_every}`, it must not exceed the {loop.steps} steps of the run"
        fail("loop.record_every", problem, "Metrics would have only the first row.")


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
    if choice.step is None:
        return
    key, ratio = f"{key}.step", choice.step / loop.step
    off_grid = f"is `{choice.step}` s, it must be a multiple of `loop.step` = `{loop.step}` s"
    if not MAX_STEPS > ratio > 0.5:
        fail(key, off_grid)
    every = loop.every(choice.step)
    if every > loop.steps:
        fail(key, f"is `{choice.step}` s, it must not be above `loop.duration` = `{loop.duration}` s")
    if abs(ratio - every) > 1e-6:
        fail(key, off_grid, f"Use {every * loop.step:.12g} s.")


def check_unique(scenario: Scenario, sections: Iterable[str], fail: Fail) -> None:
    """Check that names and driven targets are unique and not empty."""
    seen: dict[str, str] = {}
    for section in sections:
        for item in getattr(scenario, section):
            name = getattr(item, IDENTITY[section])
            if not name and section != "fmu":
                fail(f"{section}.{name}.{IDENTITY[section]}", "is empty")
            if name in seen:
                problem = f"is given twice, as `{seen[name]}` and as `{section}`"
                hint = "Give each target one wire or signal, and each FMU, metric and criterion its own name."
                fail(f"{section}.{name}", problem, hint)
            seen[name] = section


def check_wire(wire: Wire, loop: Loop, fail: Fail) -> None:
    """Check the delay and the limits of a wire."""
    key = f"wire.{wire.to}"
    if not 0 <= wire.delay <= loop.steps:
        problem = f"is `{wire.delay}` steps, it must be in 0 .. {loop.steps}, the steps of the run"
        fail(f"{key}.delay", problem)
    check_order(key, wire, fail)


def check_streams(wires: Iterable[Wire], fail: Fail) -> None:
    """Check that no two wires share a random stream: their noise would be the same."""
    seen: dict[str, Wire] = {}
    for wire in wires:
        stream = wire.stream or wire.to
        other = seen.setdefault(stream, wire)
        if other is not wire:
            named, without = (wire, other) if wire.stream else (other, wire)
            problem = f"is `{stream}`, the stream of `wire.{without.to}`"
            fail(f"wire.{named.to}.stream", problem, "Give each wire its own stream.")


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
            hint = "Use either a file, or `times` and `values`."
            fail(f"{key}.file", "cannot be combined with `times` and `values`", hint)
        return
    if signal.column:
        fail(f"{key}.column", f"is `{signal.column}`, but the signal has no `file`")
    if len(signal.times) != len(signal.values):
        numbers = f"{len(signal.times)} `times` and {len(signal.values)} `values`"
        fail(key, f"has {numbers}, but needs equal numbers")
    if not signal.times or signal.times[0] != 0.0:
        fail(f"{key}.times", "must start with 0.0")
    if not all(earlier < later for earlier, later in itertools.pairwise(signal.times)):
        fail(f"{key}.times", "must increase")


def check_injection(injection: Injection, loop: Loop, fail: Fail) -> None:
    """Check that an injection has one start, at most one end after it, and one kind."""
    key = f"inject.{injection.to}"
    begin, end = injection.from_time, injection.to_time
    kinds = injection.kinds
    if not kinds:
        choices = ", ".join(f"`{kind}`" for kind in INJECTED)
        fail(key, "has no kind", f"Give one of {choices}.")
    if len(kinds) > 1:
        hint = "Give one kind each; several `[[inject]]` of one target act in their order."
        fail(f"{key}.{kinds[1]}", f"cannot be combined with `{kinds[0]}`", hint)
    if not injection.when and begin is None:
        fail(f"{key}.from_time", "is missing", "Give `from_time` (s) or `when` (a condition) as its start.")
    if injection.when and begin is not None:
        fail(f"{key}.when", f"cannot be combined with `from_time` = `{begin}` s", "Give only one of them.")
    if injection.when and end is not None:
        problem = f"is `{end}` s, but with `when` its start is unknown"
        fail(f"{key}.to_time", problem, "Use `duration` (s).")
    if injection.after and not injection.when:
        problem = f"is `{injection.after}` s, but there is no `when`"
        fail(f"{key}.after", problem, "Include the delay in `from_time`.")
    if injection.duration is not None and end is not None:
        fail(f"{key}.duration", f"cannot be combined with `to_time` = `{end}` s", "Give only one of them.")
    if begin is not None and end is not None and not begin < end:
        fail(f"{key}.to_time", f"is `{end}` s, it must be later than `from_time` = `{begin}` s")
    if injection.late is not None and injection.late > loop.steps:
        problem = f"is `{injection.late}` steps, it must not exceed the {loop.steps} steps of the run"
        fail(f"{key}.late", problem)


def check_criterion(criterion: Criterion, metrics: list[str], fail: Fail) -> None:
    """Check that a criterion has a limit and names a metric that exists."""
    key = f"criterion.{criterion.id}"
    if criterion.metric not in metrics:
        problem = f"is `{criterion.metric}`, which is not a metric of the scenario"
        fail(f"{key}.metric", problem, closest(criterion.metric, metrics))
    given = [name for name in ("maximum", "minimum", "equals") if getattr(criterion, name) is not None]
    if not given:
        fail(key, "has no limit", "Give a `minimum`, a `maximum` or `equals`.")
    if criterion.equals is not None and len(given) > 1:
        problem = f"is `{criterion.equals}`, it cannot be combined with `{given[0]}`"
        fail(f"{key}.equals", problem, "Use two criteria.")
    check_order(key, criterion, fail)
