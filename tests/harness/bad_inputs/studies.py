"""Studies with one mistake each, of kinds that the tests of studies do not have."""

from __future__ import annotations

HEAD = 'scenario = "lag.toml"\n[design]\n'
LIST = HEAD + 'kind = "list"\n'
GRID = HEAD + 'kind = "grid"\n'
DRAWN = HEAD + 'kind = "monte-carlo"\nsamples = 4\n'
VARY = '[[vary]]\nkey = "plant.pole"\n'
RANGE = VARY + "minimum = 0.1\nmaximum = 0.9\n"

FILES: dict[str, tuple[str | bytes, tuple[str, ...]]] = {
    "empty": ("", ("`study.toml`", "is missing")),
    "latin 1": ("title = '\xe4'\n".encode("latin-1"), ("study.toml", "UTF-8")),
    "a scenario": (
        'title = "x"\n[loop]\nstep = 1.0\n',
        ("`study.toml` is a scenario, not a study", "`cosim run study.toml`"),
    ),
    "scenario is a number": (DRAWN.replace('"lag.toml"', "5") + RANGE, ("`scenario` is `5`", "a text")),
    "design is a text": ('scenario = "lag.toml"\ndesign = "grid"\n', ("`design` is `'grid'`", "a table")),
    "vary is a table": (DRAWN + RANGE.replace("[[vary]]", "[vary]"), ("`vary`", "an array")),
    "samples is a text": (DRAWN.replace("4", '"many"') + RANGE, ("`design.samples` is `'many'`",)),
    "too many runs": (DRAWN.replace("4", "1000000001") + RANGE, ("1000000001 runs",)),
    "a date": (LIST + "[[case]]\ntitle = 2020-01-01\n", ("`title`", "a text")),
    "a list for a number": (LIST + "[[case]]\ncontroller.gain = [1.0]\n", ("`controller.gain` is `[1.0]`",)),
    "a text for a number": (LIST + '[[case]]\ncontroller.gain = "big"\n', ("`controller.gain` is `'big'`",)),
    "a key that is no key": (LIST + "[[case]]\nnowhere = 1\n", ("`nowhere`",)),
    "values of two kinds": (GRID + VARY + 'values = [0.1, "a"]\n', ("`plant.pole` is `'a'`",)),
    "values is a number": (GRID + VARY + "values = 0.1\n", ("`vary[0].values`", "an array")),
    "no values": (GRID + VARY + "values = []\n", ("vary[0]",)),
    "unknown distribution": (DRAWN + RANGE + 'distribution = "nromal"\n', ("`'nromal'`", "`normal`")),
    "deviation negative": (
        DRAWN + VARY + 'mean = 0.5\ndeviation = -1.0\ndistribution = "normal"\n',
        ("`vary[0]", "-1.0"),
    ),
    "end is infinite": (
        DRAWN + VARY + "minimum = 0.1\nmaximum = inf\n",
        ("`vary[0]`", "`plant.pole`", "both finite"),
    ),
    "range without width": (
        DRAWN + '[[vary]]\nkey = "wire.plant.u.scale"\nminimum = -1.7e308\nmaximum = 1.7e308\n',
        ("`vary[0]`", "`-1.7e+308` .. `1.7e+308`", "width is too large"),
    ),
    "integers beyond all": (
        DRAWN + VARY + "minimum = 0\nmaximum = 1e300\ninteger = true\n",
        ("`vary[0].integer`", "9007199254740992", "`1e+300`"),
    ),
    "end is not a number": (
        DRAWN + VARY + "minimum = nan\nmaximum = 1.0\n",
        ("`vary[0].minimum` is `nan`",),
    ),
    "timeout is a text": (DRAWN + RANGE + '[limits]\ntimeout = "1 s"\n', ("`limits.timeout` is `'1 s'`",)),
    "memory negative": (DRAWN + RANGE + "[limits]\nmemory = -5\n", ("`limits.memory`", "-5")),
    "traces negative": (DRAWN + RANGE + "[traces]\nfailed = -1\n", ("`traces.failed` is `-1`",)),
    "CSV is a folder": (LIST + 'file = "cache"\n', ("`design.file`", "cache`", "is not a file")),
    "CSV is a device": (LIST + 'file = "zero.csv"\n', ("`design.file`", "zero.csv`", "is not a file")),
    "CSV is a pipe": (LIST + 'file = "pipe.csv"\n', ("`design.file`", "pipe.csv`", "is not a file")),
    "CSV is missing": (LIST + 'file = "no.csv"\n', ("`design.file`", "no.csv`", "does not exist")),
    "CSV of bytes": (LIST + 'file = "bytes.csv"\n', ("`design.file`", "bytes.csv`", "cannot be read")),
    "CSV is empty": (LIST + 'file = "empty.csv"\n', ("`case` is empty",)),
    "CSV with NUL": (LIST + 'file = "nul.csv"\n', ("`plant.pole`",)),
    "CSV with an unknown key": (LIST + 'file = "unknown.csv"\n', ("`plant.ploe`",)),
    "too many dimensions": (
        HEAD
        + 'kind = "sobol"\nsamples = 4\n'
        + "".join(f'[[vary]]\nkey = "wire.w{i}.noise"\nminimum = 0.0\nmaximum = 1.0\n' for i in range(21300)),
        ("21300",),
    ),
}
"""Content of `study.toml`, and what the message must say."""
CSV = {
    "bytes.csv": b"plant.pole\n\xff\xfe\n",
    "empty.csv": b"",
    "nul.csv": b"plant.pole\n\x00\n",
    "unknown.csv": b"plant.ploe\n0.5\n",
}
"""Lists of cases that the studies speak of."""
