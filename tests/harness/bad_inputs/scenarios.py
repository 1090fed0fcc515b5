"""Scenario files with one mistake each."""

from __future__ import annotations

from ..conftest import END, SCENARIO, entry

CRITERION = '[[criterion]]\nid = "end"\nclaim = "ends"\nmetric = "end"\nmaximum = 1.0\n'
WHOLE = SCENARIO + END + CRITERION
SIGNAL = '[[signal]]\nto = "controller.count"\ntimes = [0.0, 0.01]\nvalues = [1, 2]\n'
FAULT = '[[inject]]\nto = "controller.in"\nfrom_time = 0.0\nto_time = 0.01\nvalue = 1.0\n'
FILE = "`bad.toml`"
DIGITS = "9" * 5000


def edited(old: str, new: str, text: str = WHOLE) -> str:
    """Scenario with one text replaced, which must be there."""
    assert old in text, old
    return text.replace(old, new, 1)


def metric(value: str) -> str:
    """Scenario whose metric is computed by another expression."""
    return edited('"last(plant.x)"', f"'{value}'")


CSV = {"twice.csv": "u,u\n0,1\n0.01,2\n"}
"""Courses that the signals speak of."""
FILES: dict[str, tuple[str | bytes, tuple[str, ...]]] = {
    # bytes and syntax
    "latin 1": (WHOLE.replace("Lag", "L\xe4g").encode("latin-1"), (FILE, "not a text file in UTF-8")),
    "UTF-16": (WHOLE.encode("utf-16"), (FILE, "not a text file in UTF-8")),
    "NUL": (edited("Lag", "L\0g"), (FILE, "not valid TOML", "line 2")),
    "empty": ("", (FILE, "`title` is missing")),
    "no value": ("title = ", (FILE, "not valid TOML", "end of document")),
    "no quotes": (edited('"probe"', "probe"), (FILE, "not valid TOML", "line 10")),
    "bare point": (edited("0.001", ".001"), (FILE, "not valid TOML", "line 6")),
    "table twice": (WHOLE + "[loop]\n", (FILE, "not valid TOML")),
    # types
    "title is a number": (edited('"Lag with a probe"', "5"), (FILE, "`title` is `5`", "a text")),
    "title is a table": (edited('"Lag with a probe"', "{a = 1}"), (FILE, "`title`", "a text")),
    "loop is an array": (edited("[loop]", "[[loop]]"), (FILE, "`loop`", "a table")),
    "loop is missing": (edited("[loop]\nstep = 0.001\nduration = 0.05\n", ""), (FILE, "`loop` is missing")),
    "wire is a table": (WHOLE.replace("[[wire]]", "[wire]", 1), ("not valid TOML",)),
    "wire is a text": (
        'wire = "a"\n'
        + edited('[[wire]]\nfrom = "plant.x"\nto = "controller.in"\n', "").replace(
            '[[wire]]\nfrom = "controller.out"\nto = "plant.u"\n', ""
        ),
        ("`wire`", "an array"),
    ),
    "step is a text": (edited("0.001", '"1 ms"'), ("`loop.step` is `'1 ms'`", "a number")),
    "step is true": (edited("0.001", "true"), ("`loop.step` is `true`", "a number")),
    "step is a date": (edited("0.001", "2020-01-01"), ("`loop.step` is `2020-01-01` (a date)", "a number")),
    "parameter holds a date": (
        WHOLE + "[controller.parameters]\ncount = [2020-01-01]\n",
        ("`controller.count` is `[2020-01-01]`",),
    ),
    "parameter is a date": (WHOLE + "[controller.parameters]\ngain = 2020-01-01\n", ("`controller.gain`",)),
    "old key": (edited("undriven", "idle"), ("`idle` was renamed", "Use `undriven`.")),
    "a list as text": (
        'undriven = "plant.extra"\n'
        + WHOLE.replace("undriven", "description", 1).replace(
            '["controller.count", "controller.mode", "controller.flag", "plant.extra"]', '"x"'
        ),
        ("`undriven`",),
    ),
    "seed is a number": (edited("[loop]", "[loop]\nseed = 1.5"), ("`loop.seed`", "an integer")),
    "drops without extends": ('drop = ["wire"]\n' + WHOLE, ("`drop`", "needs `extends`")),
    "parameter twice": (
        WHOLE + '[controller.parameters]\nbias = [1, 2]\n"bias[1]" = 3\n',
        (FILE, "parameters `bias` and `bias[1]`"),
    ),
    "metric without a name": (WHOLE + entry("metric", name="", value="1"), ("`metric..name` is empty",)),
    "criterion without an id": (
        edited('id = "end"', 'id = ""'),
        ("`criterion..id` is empty",),
    ),
    "drop is a text": ('drop = "wire"\n' + WHOLE, ("`drop` is `'wire'`", "array of texts")),
    # names
    "unknown table": (WHOLE + "[looop]\n", ("`looop` is not a known key", "`loop`")),
    "unknown key": (edited("duration", "dration"), ("`loop.dration`", "Use `duration`")),
    "unknown key of a wire": (
        edited('to = "plant.u"', 'to = "plant.u"\ndealy = 1'),
        ("`wire.plant.u.dealy`",),
    ),
    "unknown reading": (edited('"plant.x"', '"plant.y"'), ("no measurement `y`", "`x`")),
    "unknown command": (edited('"plant.u"', '"plant.v"'), ("no command `v`",)),
    "unknown input": (edited('"controller.in"', '"controller.inn"'), ("no variable `inn`", "`in`")),
    "unknown output": (edited('"controller.out"', '"controller.otu"'), ("no variable `otu`", "`out`")),
    "wire to an output": (edited('"controller.in"', '"controller.sum"'), ("`controller.sum`", "an input")),
    "wire from an input": (
        edited('"controller.out"', '"controller.in"'),
        ("`controller.in`", "not a numeric output"),
    ),
    "wire from a text": (edited('"controller.out"', '"controller.label_out"'), ("not a numeric output",)),
    "wire without a side": (edited('"plant.x"', '"x"'), ("`from` = `x`",)),
    "wire from plant to plant": (edited('"controller.out"', '"plant.x"'), ("`from` = `plant.x`",)),
    "wire to a parameter": (edited('"controller.in"', '"controller.bias[1]"'), ("tunable parameter",)),
    "wire twice": (
        WHOLE + '[[wire]]\nfrom = "plant.x"\nto = "controller.in"\n',
        ("`wire.controller.in`", "twice"),
    ),
    "two wires with one stream": (
        WHOLE.replace('to = "plant.u"\n', 'to = "plant.u"\nstream = "controller.in"\n'),
        ("`wire.plant.u.stream` is `controller.in`", "`wire.controller.in`", "its own stream"),
    ),
    "wire and signal": (WHOLE + SIGNAL.replace("count", "in"), ("controller.in", "twice")),
    "metric twice": (WHOLE + END, ("`metric.end`", "twice")),
    "criterion twice": (WHOLE + CRITERION, ("`criterion.end`", "twice")),
    "no such plant": (edited("probe_plants:Lag", "slied"), ("no plant `slied`", "`slide`")),
    "no such module": (edited("probe_plants:Lag", "nowhere:Lag"), ("`nowhere:Lag`", "No module named")),
    "no such class": (edited("probe_plants:Lag", "probe_plants:Lga"), ("no class `Lga`", "`Lag`")),
    "no module name": (edited("probe_plants:Lag", ":"), ("cannot import the plant `:`",)),
    "relative module": (edited("probe_plants:Lag", "..x:Y"), ("cannot import the plant `..x:Y`",)),
    "module with a mistake": (
        edited("probe_plants:Lag", "torn:X"),
        ("cannot import the plant `torn:X`", "line 1"),
    ),
    "plant that rejects": (
        edited("probe_plants:Lag", "probe_plants:Refusing"),
        ("pole and label do not go",),
    ),
    "no such FMU": (edited('"probe"', '"prob"'), ("the FMU `prob.fmu` does not exist",)),
    "no such FMU file": (edited('"probe"', '"a/prob.fmu"'), ("`a/prob.fmu` does not exist",)),
    "FMU is a folder": (edited('"probe"', '"./"'), ("the FMU file `./` is not a regular file",)),
    "FMU without a name": (edited('"probe"', '""'), ("the FMU `.fmu` does not exist",)),
    "FMU of no user": (edited('"probe"', '"~nobody_here/x.fmu"'), ("`~nobody_here/x.fmu` does not exist",)),
    "FMU of a long name": (edited('"probe"', f'"{"a" * 300}"'), ("aaaa...", "does not exist")),
    "FMU file of a long name": (edited('"probe"', f'"{"a" * 5000}.fmu"'), ("aaaa...", "does not exist")),
    "FMU with NUL": (edited('"probe"', '"a\\u0000.fmu"'), ("the FMU file", "does not exist")),
    "MJCF of no user": (edited("probe_plants:Lag", "~nobody_here/x.xml"), ("`~nobody_here/x.xml`",)),
    "MJCF of a long name": (edited("probe_plants:Lag", f"{'a' * 300}.xml"), ("aaaa...", "does not exist")),
    # ranges
    "step 0": (edited("0.001", "0.0"), ("`loop.step` is `0.0`", "positive")),
    "step negative": (edited("0.001", "-0.1"), ("`loop.step` is `-0.1`", "positive")),
    "step nan": (edited("0.001", "nan"), ("`loop.step` is `nan`", "finite")),
    "step tiny": (edited("0.001", "1e-300"), ("`loop.duration`", "steps")),
    "duration inf": (edited("0.05", "inf"), ("`loop.duration` is `inf`", "finite")),
    "duration off the grid": (edited("0.05", "0.0505"), ("`loop.duration` is `0.0505`", "multiple")),
    "substeps 0": (edited("[loop]", "[loop]\nsubsteps = 0"), ("`loop.substeps` is `0`", "at least 1")),
    "substeps do not fit": (
        edited("[loop]", "[loop]\nsubsteps = 3"),
        ("`loop.substeps` = `3`", "Set `loop.substeps = 1`"),
    ),
    "record beyond the end": (
        edited("[loop]", "[loop]\nrecord_every = 51"),
        ("`loop.record_every` is `51`", "50 steps of the run"),
    ),
    "record 0": (edited("[loop]", "[loop]\nrecord_every = 0"), ("`loop.record_every` is `0`",)),
    "seed negative": (edited("[loop]", "[loop]\nseed = -1"), ("`loop.seed` is `-1`",)),
    "delay 2": (edited("[loop]", "[loop]\ncompute_delay = 2"), ("`loop.compute_delay` is `2`", "`0` or `1`")),
    "order": (edited("[loop]", '[loop]\norder = "plant_first"'), ("`loop.order`", "controller_first")),
    "delay of a wire": (
        edited('to = "plant.u"', 'to = "plant.u"\ndelay = -1'),
        ("`wire.plant.u.delay` is `-1`",),
    ),
    "noise of a wire": (edited('to = "plant.u"', 'to = "plant.u"\nnoise = -1.0'), ("`wire.plant.u.noise`",)),
    "scale of a wire": (
        edited('to = "plant.u"', 'to = "plant.u"\nscale = inf'),
        ("`wire.plant.u.scale`", "finite"),
    ),
    "parameter of the plant": (
        WHOLE + "[plant.parameters]\npole = 2.0\n",
        ("`plant.pole` is `2.0`", "0 .. 1"),
    ),
    "parameter of the FMU": (
        WHOLE + "[controller.parameters]\ngain = 99.0\n",
        ("`controller.gain` = `99.0`", "limit"),
    ),
    "output as a parameter": (
        WHOLE + "[controller.parameters]\nout = 1.0\n",
        ("`controller.out`", "cannot be set"),
    ),
    "item of an enumeration": (
        WHOLE + '[controller.parameters]\nmode = "Fst"\n',
        ("`controller.mode`", "`Fast`"),
    ),
    "integer too big": (
        WHOLE + "[controller.parameters]\ncount = 99999999999\n",
        ("`controller.count`", "32 bits"),
    ),
    "array too short": (
        WHOLE + "[controller.parameters]\nbias = [1.0]\n",
        ("`controller.bias` has 1 values", "2"),
    ),
    # signals and faults
    "signal from later": (
        WHOLE + edited("[0.0,", "[0.5,", SIGNAL),
        ("`signal.controller.count.times`", "0.0"),
    ),
    "signal backwards": (
        WHOLE + edited("0.01]", "-1.0]", SIGNAL),
        ("`signal.controller.count.times`", "increase"),
    ),
    "signal too short": (
        WHOLE + edited("[1, 2]", "[1]", SIGNAL),
        ("`signal.controller.count`", "1 `values`"),
    ),
    "signal of texts": (WHOLE + edited("[1, 2]", '["a", "b"]', SIGNAL), ("`controller.count`", "`'a'`")),
    "signal to nowhere": (WHOLE + edited("controller.count", "nowhere", SIGNAL), ("`nowhere`",)),
    "signal of a long name": (
        WHOLE + f'[[signal]]\nto = "controller.count"\nfile = "{"a" * 300}.csv"\n',
        (FILE, "the file `aaaa", "does not exist"),
    ),
    "signal with a column twice": (
        WHOLE + '[[signal]]\nto = "controller.count"\nfile = "twice.csv"\n',
        ("`twice.csv` has two columns `u`",),
    ),
    "fault backwards": (WHOLE + edited("0.01", "-1.0", FAULT), ("`inject.controller.in.to_time`", "later")),
    "fault at nothing": (WHOLE + edited("controller.in", "plant.nothing", FAULT), ("no command `nothing`",)),
    # metrics and criteria
    "metric is no expression": (metric("last(plant.x"), ("`metric.end.value`", "is not an expression")),
    "metric of nothing": (metric("last(plant.y)"), ("`metric.end.value`", "`plant.y`")),
    "metric is a column": (metric("plant.x"), ("`metric.end.value`", "50 values, not one")),
    "metric calls": (metric('__import__("os").system("true")'), ("`metric.end.value`",)),
    "metric has attributes": (metric("plant.x.__class__"), ("`metric.end.value`",)),
    "metric is too long": (metric("1+" * 1500 + "1"), ("longer than 2000 characters",)),
    "metric is nested": (metric("(" * 900 + "1" + ")" * 900), ("`metric.end.value`",)),
    "metric is a text": (metric('"a"'), ("`metric.end.value`", "text")),
    "stop is not a condition": (
        edited("[loop]", '[loop]\nstop_when = "plant.x"'),
        ("`loop.stop_when` = `plant.x` is not a condition", "`plant.x > 0`"),
    ),
    "stop is a constant": (
        edited("[loop]", '[loop]\nstop_when = "where(plant.x > 1, 2, 3)"'),
        ("`loop.stop_when`", "is not a condition"),
    ),
    "stop is a mistake": (
        edited("[loop]", '[loop]\nstop_when = "plant.y > 1"'),
        ("`loop.stop_when`", "`plant.y`"),
    ),
    "criterion of nothing": (edited('metric = "end"', 'metric = "ned"'), ("`criterion.end.metric`", "`end`")),
    "criterion without limit": (edited("maximum = 1.0\n", ""), ("`criterion.end` has no limit",)),
    "criterion with two demands": (
        WHOLE + "equals = 0.5\n",
        ("`criterion.end.equals`", "cannot be combined with `maximum`"),
    ),
    "metric in another unit of its kind": (
        WHOLE + entry("metric", name="far", unit="um", value="max(plant.x)"),
        ("`metric.far.unit` is `um`", "`max(plant.x)` is in `m`", "criterion"),
    ),
    "metric of a metric in another unit": (
        WHOLE + entry("metric", name="far", unit="mm", value="metric.end + 1"),
        ("`metric.far.unit` is `mm`", "is in `m`"),
    ),
    "time in another unit": (
        WHOLE + entry("metric", name="when", unit="ms", value="first_time(plant.x > 0)"),
        ("`metric.when.unit` is `ms`", "is in `s`"),
    ),
    "criterion in a unit beyond all numbers": (
        WHOLE.replace("maximum = 1.0", 'maximum = 1.0\nunit = "nm^-99"'),
        ("`criterion.end.unit` is `nm^-99`", "does not convert"),
    ),
    "criterion in another unit": (WHOLE + 'unit = "s"\n', ("`criterion.end.unit` is `s`", "`m`", "convert")),
    # inheritance
    "extends itself": ('extends = "bad.toml"\n', (FILE, "leads back to `bad.toml`")),
    "extends nothing": ('extends = "nothing"\n', ("there is no scenario `nothing`",)),
    "extends a number": ("extends = 5\n", (FILE, "`extends` is `5`")),
    "extends a system file": ('extends = "/etc/passwd"\n', ("there is no scenario `/etc/passwd`",)),
    "extends a long name": (f'extends = "{"a" * 300}"\n', ("there is no scenario `aaaa",)),
    "extends NUL": ('extends = "a\\u0000.toml"\n', ("the scenario file", "does not exist")),
    "drops nothing": ('extends = "lag.toml"\ndrop = ["wire.plant.z"]\n', ("`drop` holds `wire.plant.z`",)),
    "drops what is unknown": ('extends = "lag.toml"\ndrop = ["wires"]\n', ("`drop` holds `wires`", "`wire`")),
    # depth, and numbers that are too large
    "deep array": ("x = " + "[" * 2000 + "]" * 2000, ("`bad.toml`", "nested")),
    "deep table": ("x = " + "{a = " * 2000 + "1" + "}" * 2000, ("`bad.toml`", "nested")),
    "deep key": (".".join("a" * 2000) + " = 1", ("`bad.toml`",)),
    "deep parameters": (
        WHOLE + "[plant.parameters]\n" + ".".join("a" * 2000) + " = 1",
        ("`bad.toml`",),
    ),
    "integer of 5000 digits": (edited("0.001", DIGITS), ("`bad.toml`",)),
    "integer above 1e308": (edited("0.001", DIGITS[:400]), ("`loop.step`",)),
    "limit above 1e308": (
        edited("maximum = 1.0", f"maximum = {DIGITS[:400]}"),
        ("`criterion[0].maximum`",),
    ),
    "parameter above 1e308": (
        WHOLE + f"[controller.parameters]\ngain = {DIGITS[:400]}\n",
        ("`controller.parameters.gain`",),
    ),
    "delay is a number": (
        edited("[loop]", "[loop]\ncompute_delay = 1.0"),
        ("`loop.compute_delay`", "1.0"),
    ),
    "delay is 0.0": (
        edited("[loop]", "[loop]\ncompute_delay = 0.0"),
        ("`loop.compute_delay`", "0.0"),
    ),
    "minimum nan": (
        edited('to = "plant.u"', 'to = "plant.u"\nminimum = nan'),
        ("`wire.plant.u.minimum`",),
    ),
    "minimum above maximum": (
        edited('to = "plant.u"', 'to = "plant.u"\nminimum = 2.0\nmaximum = 1.0'),
        ("`wire.plant.u.minimum`", "2"),
    ),
    "plant is a module": (edited("probe_plants:Lag", "os:path"), ("path` is not a class",)),
    "plant is a function": (edited("probe_plants:Lag", "os:_exit"), ("_exit` is not a class",)),
    "plant is a dict": (edited("probe_plants:Lag", "builtins:dict"), ("`builtins:dict`",)),
}
"""Content of `bad.toml`, and what the message must say."""
