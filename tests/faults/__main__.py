"""Write the pages of the fault matrices into `docs/faults`."""

from __future__ import annotations

import argparse
import sys

from cosim.errors import CosimError

from . import matrix, page
from .outcome import running


def main() -> int:
    """Run the command; 0 if every row passes, 1 if one fails, 2 if one could not run."""
    parser = argparse.ArgumentParser(prog="python -m tests.faults", description=__doc__)
    parser.add_argument("names", metavar="NAME", nargs="*", help="controller; default: all")
    bad = 0
    try:
        for name in parser.parse_args().names or matrix.names():
            bad += write(name)
    except CosimError as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 1 if bad else 0


def write(name: str) -> int:
    """Write the page of a controller and print its problems; return the number of failed rows."""
    found = matrix.load(name)
    with running(found) as runner:
        outcomes = runner.outcomes()
    page.file(name).parent.mkdir(exist_ok=True)
    page.file(name).write_text(page.page(name, found, outcomes), encoding="utf-8")
    bad = [one for one in outcomes if one.problems]
    for one in bad:
        print(f"{name}: {one.row.name}: {'; '.join(one.problems)}")
    print(f"{name}: {len(outcomes)} rows, {len(bad)} failed")
    return len(bad)


if __name__ == "__main__":
    sys.exit(main())
