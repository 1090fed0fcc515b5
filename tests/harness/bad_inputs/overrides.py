"""Overrides with one mistake each."""

from __future__ import annotations

from .scenarios import DIGITS

SETS: dict[str, tuple[str, tuple[str, ...]]] = {
    "no key": ("=1", ("`--set =1`", "KEY=VALUE")),
    "no value": ("loop.step", ("`--set loop.step`", "KEY=VALUE")),
    "dots": ("...=1", ("`--set ...`", "not a key")),
    "no wire": ("wire.=1", ("`--set wire.`: there is no name after", "Known names: `wire.controller.in`")),
    "wire without key": ("wire.plant.u=1", ("`--set wire.plant.u`",)),
    "plot": ("plot.zoom=1", ("`--set plot.zoom`", "not a key")),
    "text with NUL": ('controller.label="a\\u0000b"', ("`controller.label`", "a text without NUL")),
    "list": ("controller.gain=[1, 2]", ("`controller.gain` is `[1, 2]`", "a number")),
    "table": ("controller.gain={a = 1}", ("`controller.gain`", "a number")),
    "two lines": ("controller.gain=1\nfoo=2", ("`controller.gain`", "a number")),
    "infinity": ("controller.gain=-inf", ("`controller.out` is `-inf`", "finite")),
    "not a number": ("controller.bias=[nan, 0]", ("`controller.out` is `nan`", "finite")),
    "delay": ("loop.compute_delay=true", ("`loop.compute_delay` is `true`", "`0` or `1`")),
    "long delay": ("wire.plant.u.delay=51", ("`wire.plant.u.delay` is `51`", "0 .. 50")),
    "very long": ("loop.duration=1e9", ("`loop.duration`", "memory")),
    "FMU is a table": ("controller.fmu={a = 1}", ("`controller.fmu`", "a text")),
    "FMU is a device": ("controller.fmu=/dev/zero", ("`/dev/zero` is not a regular file",)),
    "plant is a module": ("plant.name=os", ("no plant `os`",)),
    "plant fails": ("plant.fail_at=3", ("step 3", "failed on request", "Show the origin with `-v`.")),
    "plant gives NaN": ("plant.nan_at=3", ("`plant.x` is `nan`", "step 3")),
    "FMU fails": ("controller.fail_at=3", ("step 3", "failed on request at 0.003 s", "fmi2DoStep")),
    "deep value": ("controller.gain=" + "[" * 2000 + "]" * 2000, ("controller.gain",)),
    "integer above 1e308": (f"controller.gain={DIGITS[:400]}", ("`controller.gain`",)),
    "integer of 5000 digits": (f"controller.gain={DIGITS}", ("controller.gain",)),
    "unknown section": ("controler.gain=1", ("not a key of a scenario", "Use `controller.`")),
    "unknown key": ("loop.dration=1", ("`--set loop.dration`", "not a known key", "Use `duration`")),
    "unknown parameter": ("plant.ploe=1", ("`plant.ploe`", "Use `pole`")),
    "unknown variable": ("controller.gian=1", ("no variable `gian`", "Use `gain`")),
    "unknown wire": (
        "wire.controller.on.noise=1",
        ("no wire `controller.on`", "Use `wire.controller.in`"),
    ),
    "unknown wire key": ("wire.controller.in.nose=1", ("not a known key", "Use `noise`")),
    # types and ranges
    "fraction": ("loop.substeps=1.5", ("`--set loop.substeps`", "`1.5` (a number), it must be an integer")),
    "text": ("loop.step=fast", ("`--set loop.step`", "`'fast'` (a text), it must be a number")),
    "Boolean": ("loop.step=true", ("`true` (true or false), it must be a number",)),
    "off the grid": (
        "loop.duration=0.0505",
        ("a multiple of `loop.step` = `0.001` s", "Use 0.05 s."),
    ),
    "step nan": ("loop.step=nan", ("it must be positive and finite",)),
    "duration negative": ("loop.duration=-1", ("it must be positive and finite",)),
    "delay 2": ("loop.compute_delay=2", ("is `2`, it must be `0` or `1`",)),
    "order": ("loop.order=plant_first", ("it must be `controller_first`",)),
    "noise negative": ("wire.controller.in.noise=-1", ("it must be finite and not negative",)),
    "delay negative": ("wire.controller.in.delay=-1", ("it must be in 0 .. 50",)),
    "seed negative": ("loop.seed=-1", ("it must not be negative",)),
    "substeps": ("loop.substeps=2", ("do not fill `loop.step` = `0.001` s", "Set `loop.substeps = 1`")),
    # wires
    "wire from": ("wire.controller.in.from=plant.y", ("no measurement `y`",)),
    "wire from the wrong side": ("wire.controller.in.from=controller.out", ("needs a `plant.` measurement",)),
    "command from the plant": ("wire.plant.u.from=plant.x", ("needs a `controller.` output",)),
    "wire to": ("wire.controller.in.to=controller.inn", ("no variable `inn`", "Use `in`")),
    "wire to an output": (
        "wire.controller.in.to=controller.out",
        ("not an input or tunable parameter",),
    ),
    "wire to a command": ("wire.plant.u.to=plant.v", ("no command `v`",)),
    "wire from a text": ("wire.plant.u.from=controller.label_out", ("is not a numeric output",)),
    "wire to nowhere": (
        "wire.plant.u.to=nowhere",
        ("`to` = `nowhere`, it must be `controller.<input>` or",),
    ),
    "stop_when": ("loop.stop_when=plant.y > 1", ("`plant.y`, which is not a known column",)),
    # parameters of the FMU
    "above its limit": (
        "controller.gain=20",
        ("rejected `controller.gain` = `20.0`: `gain` = 20 is above its limit (fmi2SetReal",),
    ),
    "sum above its limit": (
        "controller.bias=[90, 20]",
        ("the FMU rejected its parameters: the sum of `bias` is 110, its limit is 100",),
    ),
    "text for a Real": ("controller.gain=big", ("`controller.gain` is `'big'`, it must be a number",)),
    "Boolean for a Real": ("controller.gain=true", ("`controller.gain` is `true`, it must be a number",)),
    "fraction for an Integer": (
        "controller.count=1.5",
        ("`controller.count` is `1.5`, it must be an integer of 32 bits",),
    ),
    "number for a Boolean": (
        "controller.flag=2",
        ("`controller.flag` is `2`, it must be true or false",),
    ),
    "number for a String": ("controller.label=2", ("`controller.label` is `2`, it must be a text",)),
    "item": (
        "controller.mode=Fst",
        ("`controller.mode` is `'Fst'`, it must be one of `Off`, `Slow`, `Fast`", "Use `Fast`"),
    ),
    "item number": ("controller.mode=3", ("`controller.mode` is `3`, it must be one of",)),
    "short array": ("controller.bias=[1]", ("`controller.bias` has 1 values instead of 2",)),
    "output": (
        "controller.out=1",
        ("`controller.out` of causality `output` is calculated and cannot be set",),
    ),
}
"""One override, and what the message must say."""
