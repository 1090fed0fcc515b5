"""Scenarios of several FMUs with one mistake each."""

from __future__ import annotations

from ..loop.several import LOOP, fmu, signal, wire
from .scenarios import FILE, edited

TWO = (
    LOOP
    + fmu("a")
    + fmu("b")
    + wire("a.out", "b.in")
    + wire("b.out", "a.in", "delay = 1\n")
    + signal("a.count", [0.0], [1.0])
)


def renamed(name: str) -> str:
    """Scenario whose first FMU has another name."""
    return edited('name = "a"', f'name = "{name}"', TWO)


FILES: dict[str, tuple[str, tuple[str, ...]]] = {
    "no FMU": (LOOP, (FILE, "`controller` is missing", "`[[fmu]]`")),
    "both forms": (TWO + '[controller]\nfmu = "probe"\n', ("`fmu` cannot be combined with `controller`",)),
    "no FMU in the list": (f"fmu = []\n{LOOP}", ("`fmu` is empty", "`[controller]`")),
    "FMUs are a table": (LOOP + '[fmu]\nname = "a"\n', ("`fmu`", "an array")),
    "FMUs are texts": (f'fmu = ["a"]\n{LOOP}', ("`fmu[0]`", "a table")),
    "no name": (edited('name = "a"\n', "", TWO), ("`fmu[0].name` is missing",)),
    "no FMU of a name": (edited('fmu = "probe"\n', "", TWO), ("`fmu.a.fmu` is missing",)),
    "name twice": (edited('name = "b"', 'name = "a"', TWO), ("`fmu.a` is given twice",)),
    "name of the plant": (renamed("plant"), ("`fmu.plant.name` is `plant`", "reserved name")),
    "name of a table": (renamed("wire"), ("`fmu.wire.name` is `wire`", "reserved name")),
    "name of a column": (renamed("time"), ("`fmu.time.name` is `time`",)),
    "empty name": (renamed(""), ("is `''`", "letters")),
    "name with a dot": (renamed("a.b"), ("is `'a.b'`", "letters")),
    "name with a digit": (renamed("1st"), ("is `'1st'`", "letters")),
    "name of Python": (renamed("in"), ("is `'in'`", "not a Python keyword")),
    "name is a number": (edited('name = "a"', "name = 1", TWO), ("`fmu[0].name` is `1`", "a text")),
    "key": (edited('fmu = "probe"', 'fmu = "probe"\ndelay = 1', TWO), ("`fmu.a.delay` is not a known key",)),
    "step off the grid": (
        edited("parameters", "step = 0.0025\nparameters", TWO),
        ("`fmu.a.step`", "0.002 s"),
    ),
    "step too short": (edited("parameters", "step = 0.0001\nparameters", TWO), ("`fmu.a.step`", "multiple")),
    "step beyond the end": (
        edited("parameters", "step = 1.0\nparameters", TWO),
        ("`fmu.a.step` is `1.0` s", "above `loop.duration`"),
    ),
    "step 0": (edited("parameters", "step = 0\nparameters", TWO), ("`fmu.a.step` is `0.0`", "positive")),
    "step inf": (edited("parameters", "step = inf\nparameters", TWO), ("`fmu.a.step` is `inf`", "finite")),
    "no such FMU": (edited('fmu = "probe"', 'fmu = "prob"', TWO), (FILE, "`prob.fmu` does not exist")),
    "parameter": (edited("parameters = {", "parameters = {gian = 1.0", TWO), ("the FMU `a`", "`gain`")),
    "parameter rejected": (
        edited("parameters = {", "parameters = {gain = 99.0", TWO),
        ("`a.gain` = `99.0`",),
    ),
    "parameter of a kind": (
        edited("parameters = {", 'parameters = {gain = "x"', TWO),
        ("`a.gain` is `'x'`",),
    ),
    "wire from an unknown FMU": (
        edited('from = "a.out"', 'from = "c.out"', TWO),
        ("`from` = `c.out`", "`plant.` measurement or a `a.` output or a `b.` output"),
    ),
    "wire to an unknown FMU": (
        edited('to = "b.in"', 'to = "bb.in"', TWO),
        ("`to` = `bb.in`", "`a.<input>`, `b.<input>`", "Use `b`"),
    ),
    "signal to an unknown FMU": (edited('to = "a.count"', 'to = "c.count"', TWO), ("`to` = `c.count`",)),
    "wire from nothing": (edited("a.out", "a.otu", TWO), ("the FMU `a` has no variable `otu`", "`out`")),
    "wire to nothing": (edited("b.in", "b.inn", TWO), ("the FMU `b` has no variable `inn`", "`in`")),
    "wire from an input": (edited("a.out", "a.in", TWO), ("`a.in` is not a numeric output of the FMU `a`",)),
    "wire to an output": (edited("b.in", "b.sum", TWO), ("`b.sum` is not an input",)),
    "wire to the plant": (TWO + wire("b.out", "plant.u"), ("the scenario has no plant",)),
    "wire back without delay": (
        edited("a.out", "b.out", edited("b.in", "a.flag", TWO)),
        ("`b.out` to `a.flag` without `delay`", "steps `a`, `b`", "`delay = 1`", "list `b` before `a`"),
    ),
    "algebraic loop": (
        edited("delay = 1\n", "", TWO),
        ("`b.out` to `a.in`", "algebraic loop", "`delay = 1`"),
    ),
    "wire to itself": (TWO + wire("a.out", "a.flag"), ("`a.out` to `a.flag`", "algebraic loop")),
    "negative delay": (edited("delay = 1", "delay = -1", TWO), ("`wire.a.in.delay` is `-1`",)),
    "metric of no FMU": (TWO + '[[metric]]\nname = "m"\nvalue = "last(c.out)"\n', ("names `c.out`",)),
    "fault at no FMU": (
        TWO + '[[inject]]\nto = "c.in"\nfrom_time = 0.0\nto_time = 0.01\nvalue = 1.0\n',
        ("`to` = `c.in`",),
    ),
}
"""Content of `bad.toml`, and what the message must say."""
SETS: dict[str, tuple[str, tuple[str, ...]]] = {
    "unknown variable": ("b.gian=1", ("`--set b.gian`", "the FMU `b` has no variable `gian`", "`gain`")),
    "unknown FMU": ("c.gain=1", ("`--set c.gain`: not a key", "`a.`")),
    "the other form": ("controller.gain=1", ("`--set controller.gain`: not a key", "`b.`")),
    "value": ("b.gain=high", ("`--set b.gain`", "`b.gain` is `'high'`", "a number")),
    "file": ("b.fmu=none", ("`--set b.fmu`", "`none.fmu` does not exist")),
    "step": ("b.step=0.0015", ("`--set b.step`", "`loop.step`")),
    "delay": ("wire.a.in.delay=0", ("algebraic loop",)),
    "failure": ("b.fail_at=3", ("the FMU `b` failed at t = 0.003 s (step 3)", "failed on request")),
    "not a number": ("b.nan_at=3", ("`b.out` is `nan`", "finite")),
}
"""One override of a good scenario, and what the message must say."""
