"""Command lines and environments with one mistake each."""

from __future__ import annotations

from .calling import Case, given

RUN = given("run", "lag.toml")
LONG = "a" * 300

NOWHERE = {"--trace": "no/a.csv", "--json": "no/a.json", "--plot": "no/a.svg"}
"""Options with a file in a folder that does not exist."""
FULL = {"full.csv": "--trace", "full.npz": "--trace", "/dev/full": "--json", "full.svg": "--plot"}
"""Files on a full disk, and the option that writes such files."""

LINES: dict[str, Case] = {
    "unknown command": Case(given("rnu"), ("rnu", "--help")),
    "unknown option": Case((*RUN, "--sede", "1"), ("--sede", "--help")),
    "no scenario": Case(given("run"), ("SCENARIO", "--help")),
    "two scenarios": Case((*RUN, "lag.toml"), ("lag.toml",)),
    "missing name": Case(given("run", "lagg"), ("there is no scenario `lagg`",)),
    "missing file": Case(given("run", "lagg.toml"), ("the scenario file `lagg.toml` does not exist",)),
    "empty name": Case(given("run", ""), ("there is no scenario ``",)),
    "long name": Case(given("run", LONG), ("there is no scenario `aaaa",)),
    "very long name": Case(given("run", "a" * 5000), ("there is no scenario `aaaa",)),
    "long file name": Case(given("run", f"{LONG}.toml"), ("the scenario file `aaaa", "does not exist")),
    "name of a folder": Case(given("run", "cache"), ("there is no scenario `cache`",)),
    "name upwards": Case(given("run", "../../../../etc/passwd"), ("there is no scenario `../../../../etc",)),
    "a device": Case(given("run", "/dev/zero.toml"), ("`/dev/zero.toml` does not exist",)),
    "bytes": Case(given("run", "\udcff\udcfe.toml"), ("does not exist",)),
    "terminal codes": Case(given("run", "\x1b[31mx"), ("there is no scenario",)),
    "show a missing one": Case(given("show", "lagg"), ("there is no scenario `lagg`",)),
    "show a missing FMU": Case(
        given("show", "lag.toml", "--set", "controller.fmu=no"), ("`no.fmu` does not exist",)
    ),
    "show a torn FMU": Case(
        given("show", "lag.toml", "--set", "controller.fmu=torn.fmu"), ("`torn.fmu`", "truncated")
    ),
    "seed is a word": Case((*RUN, "--seed", "one"), ("--seed", "valid int")),
    "seed negative": Case((*RUN, "--seed", "-1"), ("--seed",)),
    "delay 2": Case((*RUN, "--delay", "2"), ("`loop.compute_delay` is `2`",)),
    "duration nan": Case((*RUN, "--duration", "nan"), ("`loop.duration` is `nan`",)),
    "duration 0": Case((*RUN, "--duration", "0"), ("`loop.duration` is `0.0`",)),
    "duration endless": Case((*RUN, "--duration", "1e8"), ("`loop.duration`", "shorter runs")),
    "duration negative": Case((*RUN, "--duration", "-1"), ("`loop.duration` is `-1.0`",)),
    "duration is a word": Case((*RUN, "--duration", "long"), ("--duration", "float")),
    "unknown engine": Case((*RUN, "--engine", "nativ"), ("`nativ`", "Use `native`")),
    "trace of another kind": Case((*RUN, "--trace", "a.xls"), ("`a.xls`", "`.npz`")),
    "trace without a kind": Case((*RUN, "--trace", "a"), ("`a`", "`.csv`")),
    "trace is a folder": Case((*RUN, "--trace", "folder.csv"), ("cannot write `folder.csv`",)),
    "JSON is a folder": Case((*RUN, "--json", "cache"), ("cannot write `cache`",)),
    "plot of another kind": Case((*RUN, "--plot", "a.gif"), ("`a.gif`", "`.svg`")),
    "JSON over the scenario": Case((*RUN, "--json", "lag.toml"), ("`--json` `lag.toml`", "is not JSON")),
    "JSON over the FMU": Case((*RUN, "--json", "probe.fmu"), ("`--json` `probe.fmu`", "is not JSON")),
    "two outputs in one file": Case(
        (*RUN, "--json", "x.svg", "--plot", "./x.svg"), ("`--json` and `--plot`", "`x.svg`")
    ),
    "seeds over the scenario": Case((*RUN, "--seeds", "1..2", "--json", "lag.toml"), ("is not JSON",)),
    "JUnit over a model": Case(given("test", "lag.toml", "--junit", "model.xml"), ("is not JUnit XML",)),
    "trace over a signal": Case(
        given("run", "driven.toml", "--trace", "in.csv"), ("`--trace` `in.csv`", "`signal.controller.flag`")
    ),
    "result over the trace": Case(
        given("evaluate", "in.csv", "lag.toml", "--json", "in.csv"), ("`--json` `in.csv`", "is not JSON")
    ),
    "memory beyond all": Case((*RUN, "--memory", "1e300"), ("`--memory` = `1e+300`", "1e+12")),
    "timeout beyond all": Case((*RUN, "--timeout", "inf"), ("`--timeout` = `inf`",)),
    "evaluate a pipe": Case(
        given("evaluate", "pipe.csv", "lag.toml"), ("cannot read `pipe.csv`", "not a regular file")
    ),
    "evaluate a device": Case(
        given("evaluate", "zero.npz", "lag.toml"), ("cannot read `zero.npz`", "not a regular file")
    ),
    "compare a pipe": Case(given("compare", "pipe.csv", "in.csv"), ("`pipe.csv`", "regular file")),
    "evaluate an endless trace": Case(
        given("evaluate", "vast.npz", "lag.toml"), ("`vast.npz` is not a valid trace",)
    ),
    "evaluate an empty trace": Case(
        given("evaluate", "empty.csv", "lag.toml"), ("`empty.csv` is not a valid trace", "names of the")
    ),
    "evaluate half a trace": Case(
        given("evaluate", "half.npz", "lag.toml"),
        ("`half.npz` is not a valid trace", "not an npz file, or it is truncated"),
    ),
    "evaluate swapped arguments": Case(
        given("evaluate", "lag.toml", "in.csv"), ("`lag.toml` is not a trace", "Give the trace first")
    ),
    "baseline is a folder": Case(
        given("compare", "lag.toml", "--update"), ("cannot write `lag.baseline.npz`", "folder")
    ),
    "new the other way round": Case(
        given("new", "model.xml", "probe.fmu"), ("`model.xml` is not an FMU", "Give the FMU first")
    ),
    "new of a scenario": Case(given("new", "lag.toml"), ("`lag.toml` is not an FMU", "ends in `.fmu`")),
    "seed beyond all": Case((*RUN, "--seed", "9" * 23), ("`--seed`", "integers have 64 bits")),
    "report a device": Case(
        given("report", "lag.toml", "--document", "/dev/zero"), ("cannot read `/dev/zero`", "regular file")
    ),
    "run a study": Case(given("run", "study.toml"), ("`study.toml` is a study", "`cosim sweep study.toml`")),
    "run an optimization": Case(
        given("run", "best.toml"), ("`best.toml` is an optimization", "`cosim optimize best.toml`")
    ),
    "optimize a study": Case(given("optimize", "study.toml"), ("`study.toml` is a study", "cosim sweep")),
    **{
        f"{option} into nothing": Case((*RUN, option, file), (f"`{file}`", "does not exist"))
        for option, file in NOWHERE.items()
    },
    **{
        f"{option} to a full disk: {file}": Case((*RUN, option, file), (f"cannot write `{file}`", "No space"))
        for file, option in FULL.items()
    },
    "sweep of nothing": Case(given("sweep", "no.toml"), ("the study file `no.toml` does not exist",)),
    "sweep of a folder": Case(given("sweep", "cache"), ("the study file `cache` is not a regular file",)),
    "sweep of a long name": Case(given("sweep", f"{LONG}.toml"), ("the study file `aaaa",)),
    "sweep of a scenario": Case(
        given("sweep", "lag.toml"), ("`lag.toml` is a scenario", "`cosim run lag.toml`")
    ),
    "sweep into a file": Case(
        given("sweep", "study.toml", "--out", "lag.toml"), ("cannot write", "`lag.toml`")
    ),
    "sweep into a device": Case(
        given("sweep", "study.toml", "--out", "/proc/x"), ("cannot write", "/proc/x")
    ),
    **{
        f"sweep into a folder with a {kind} for its rows": Case(
            given("sweep", "study.toml", "--out", kind),
            (f"cannot write results: `{kind}/results.jsonl` is not a file",),
        )
        for kind in ("pipe", "zero", "full")
    },
    "traces are a file": Case(
        given("sweep", "failing.toml", "--out", "taken", "--workers", "1", "--no-plots"),
        ("cannot write traces: `taken/traces` is not a folder",),
    ),
    "sweep into an empty name": Case(given("sweep", "study.toml", "--out", ""), ("`--out` is empty",)),
    "optimize into an empty name": Case(given("optimize", "search.toml", "--out", ""), ("`--out` is empty",)),
    "optimize a pipe": Case(given("optimize", "pipe/results.jsonl"), ("is not a regular file",)),
    "new of a folder": Case(given("new", "./"), ("the FMU file `./` is not a regular file",)),
    "JSON without a name": Case((*RUN, "--json", ""), ("`--json` is empty", "`-` for stdout")),
    "trace without a name": Case((*RUN, "--trace", ""), ("cannot save a trace",)),
    "size of a video": Case(
        given("video", "lag.toml", "--size", "640"), ("`--size` is `640`", "Give width and height")
    ),
    "test into a file": Case(given("test", "lag.toml", "--out", "lag.toml"), ("`--out` `lag.toml` is not",)),
    "SSP into nothing": Case(
        given("ssp", "lag.toml", "--out", "no/x.ssp"), ("`no/x.ssp`", "the folder", "does not exist")
    ),
    "compare a name and a file": Case(
        given("compare", "lag", "in.csv"), ("`lag` does not exist", "hint: Give traces")
    ),
    "baseline with a trace": Case(given("compare", "in.csv"), ("needs a second file", "Give a second file")),
    "no action for the cache": Case(given("cache"), ("'dir|clean'. Choose from: dir, clean\n",)),
    "seeds backwards": Case((*RUN, "--seeds", "5..1"), ("`5..1` ends before", "Use `1..5`.")),
    "sweep of a scenario by name": Case(
        given("sweep", "dob/paper"), ("`dob/paper` is a scenario", "Use `cosim run dob/paper`.")
    ),
    "optimize a scenario by name": Case(
        given("optimize", "dob"), ("`dob` is a scenario", "Use `cosim run dob`.")
    ),
    "no workers": Case(given("sweep", "study.toml", "--workers", "0"), ("--workers",)),
    "sweep with an unknown engine": Case(given("sweep", "study.toml", "--engine", "x"), ("`x`",)),
}
"""Command lines in a folder with a scenario, a study, a torn FMU, and files on a full disk."""
ENVIRONMENTS: dict[str, tuple[dict[str, str], Case]] = {
    "scenarios in a file": ({"COSIM_SCENARIOS": "lag.toml"}, Case(given("run", "no"), ("no scenario `no`",))),
    "scenarios in a loop": ({"COSIM_SCENARIOS": "loop"}, Case(given("run", "no"), ("no scenario `no`",))),
    "FMUs nowhere": (
        {"COSIM_FMU_PATH": "/no/where"},
        Case((*RUN, "--set", "controller.fmu=no"), ("`no.fmu` does not exist", "/no/where")),
    ),
    "home of no user": (
        {"HOME": "/no/where", "COSIM_CACHE": ""},
        Case((*RUN, "--set", "controller.fmu=~/x.fmu"), ("`~/x.fmu` does not exist",)),
    ),
}
"""Variables, and a command line that fails with them."""
