"""`python -m handbook`: builds the site in `target/site/`, which needs no server or network.

`python -m handbook notebooks` executes the notebooks of `examples/` and stores their output,
`python -m handbook stills` draws the pictures of the machines again.
"""

from __future__ import annotations

import subprocess
import sys

from handbook import notebooks, stills
from handbook.pages import ROOT, gather


def main() -> int:
    """Gather the pages and build the site; every warning of Zensical is an error."""
    if sys.argv[1:] == ["notebooks"]:
        notebooks.store(ROOT / "examples")
        return 0
    if sys.argv[1:] == ["stills"]:
        stills.store(ROOT / "docs/pictures")
        return 0
    gather(ROOT / "target/pages")
    line = [sys.executable, "-m", "zensical", "build", "--strict", "--clean"]
    return subprocess.run(line, cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
