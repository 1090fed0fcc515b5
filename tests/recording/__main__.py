"""Record what the scenarios give, or compare it with the recording, column by column."""

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
    """Run the command; 0 if nothing differs, 1 if something does, 2 if it could not be found out."""
    parser = argparse.ArgumentParser(prog="python -m tests.recording", description=__doc__)
    parser.add_argument(
        "names", metavar="NAME", nargs="*", help="`dob` is a loop with its variants, `dob/pa*` some"
    )
    parser.add_argument("--write", action="store_true", help="record instead of comparing")
    parser.add_argument("--all", action="store_true", help="name all columns that differ")
    parser.add_argument("-j", "--jobs", type=int, help="processes, as many as cores by default")
    given = parser.parse_args()
    begin = time.perf_counter()
    try:
        names = chosen(given.names)
        runs = dict(record.record_all(names, given.jobs))
        failed = {name: run for name, run in runs.items() if isinstance(run, str)}
        done = {name: run for name, run in runs.items() if isinstance(run, Recorded)}
        for name, problem in failed.items():
            print(f"{name:30} failed    {problem}")
        faults = store(done, given.names) if given.write else judge(done, given.names, given.all)
    except CosimError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    print(f"{len(done)} scenarios, {len(failed)} failed, {time.perf_counter() - begin:.0f} s")
    return 1 if faults or failed else 0


def chosen(patterns: Sequence[str]) -> list[str]:
    """Names of the scenarios that are meant; every pattern must fit one."""
    names = record.scenario_names()
    for pattern in patterns:
        if not record.selected(names, [pattern]):
            raise CosimError(f"no scenario fits `{pattern}`", "`cosim list` shows the names")
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


def judge(done: dict[str, Recorded], patterns: Sequence[str], every: bool) -> int:
    """Print what differs from the recording; number of faults."""
    recording, changes = record.read(), compare.read()
    here = record.made_with()
    if recording.made_with != here:
        print(f"the recording was made with {recording.made_with}, this is {here}: bits may differ")
    gone = [n for n in record.selected(recording.scenarios, patterns) if n not in record.scenario_names()]
    for name in gone:
        print(f"{name:30} missing   recorded, but there is no such scenario")
    faults = len(gone)
    for name, now in done.items():
        if name not in recording.scenarios:
            print(f"{name:30} new       not recorded")
            continue
        found = compare.compare(name, recording.scenarios[name], now, changes)
        faults += sum(one.fault for one in found)
        for line in lines(found, every):
            print(line)
    print(f"{faults} faults" if faults else "bit-identical")
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
