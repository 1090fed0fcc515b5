"""Record the results of the scenarios, or compare them with the recording, column by column."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterator, Sequence
from itertools import groupby

from cosim.errors import CosimError

from . import compare, record
from .compare import Difference
from .record import Recorded, Recording

SHOWN = 6
"""Columns named of a scenario."""


def main() -> int:
    """Run the command; 0 without a difference, 1 with one, 2 after an error."""
    parser = argparse.ArgumentParser(prog="python -m tests.recording", description=__doc__)
    parser.add_argument(
        "names", metavar="NAME", nargs="*", help="`dob`: a scenario with its variants, `dob/pa*`: some"
    )
    parser.add_argument("--write", action="store_true", help="record instead of comparing")
    parser.add_argument("--all", action="store_true", help="name all columns that differ")
    parser.add_argument("-j", "--jobs", type=int, help="processes; default: number of cores")
    given = parser.parse_args()
    begin = time.perf_counter()
    try:
        names = chosen(given.names)
        runs = dict(record.record_all(names, given.jobs))
        failed = {name: run for name, run in runs.items() if isinstance(run, str)}
        done = {name: run for name, run in runs.items() if isinstance(run, Recorded)}
        for name, problem in failed.items():
            print(f"{name:30} failed    {problem}")
        faults = store(done, given.names) if given.write else report(done, given.names, given.all)
    except CosimError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{len(done)} scenarios, {len(failed)} failed, {time.perf_counter() - begin:.0f} s")
    return 1 if faults or failed else 0


def chosen(patterns: Sequence[str]) -> list[str]:
    """Names of the chosen scenarios; every pattern must match one."""
    names = record.scenario_names()
    for pattern in patterns:
        if not record.selected(names, [pattern]):
            raise CosimError(f"no scenario matches `{pattern}`", "`cosim list` shows the names")
    return record.selected(names, patterns)


def store(done: dict[str, Recorded], patterns: Sequence[str]) -> int:
    """Write the recording, or only the lines of some scenarios."""
    made_with, kept = record.made_with(), {}
    if patterns:
        before = record.read()
        if before.made_with != made_with:
            raise CosimError(
                f"the recording was made with {before.made_with}, this is {made_with}",
                "record all scenarios, `--write` without names",
            )
        kept = before.scenarios
    record.write(Recording(made_with, {**kept, **done}))
    return 0


def report(done: dict[str, Recorded], patterns: Sequence[str], every: bool) -> int:
    """Print the differences from the recording; return the number of errors."""
    recording, changes = record.read(), compare.read()
    here = record.made_with()
    if recording.made_with != here:
        print(f"the recording was made with {recording.made_with}, this is {here}: bits may differ")
    gone = [n for n in record.selected(recording.scenarios, patterns) if n not in record.scenario_names()]
    for name in gone:
        print(f"{name:30} missing   recorded, but the scenario does not exist")
    faults = len(gone)
    for name, now in done.items():
        if name not in recording.scenarios:
            print(f"{name:30} new       not recorded")
            continue
        found = compare.compare(name, recording.scenarios[name], now, changes)
        faults += sum(one.fault for one in found)
        for line in lines(found, every):
            print(line)
    print(f"{faults} errors" if faults else "bit-identical")
    return faults


def lines(found: Sequence[Difference], every: bool) -> Iterator[str]:
    """Lines of one scenario: a kind of difference each, with its columns and notes."""
    for kind, group in groupby(sorted(found, key=lambda one: one.kind), key=lambda one: one.kind):
        entries = [f"{one.column} ({one.note})" if one.note else one.column for one in group]
        shown = entries if every else entries[:SHOWN]
        more = f" and {len(entries) - len(shown)} more" if len(entries) > len(shown) else ""
        yield f"{found[0].scenario:30} {kind:9} {', '.join(shown)}{more}"


if __name__ == "__main__":
    sys.exit(main())
