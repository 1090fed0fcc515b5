"""`python -m handbook`: the site in `target/site/`, which opens without a server or a network.

`python -m handbook notebooks` instead executes the notebooks of `examples/` and keeps what they give.
"""

from __future__ import annotations

import subprocess
import sys

from handbook import notebooks
from handbook.pages import ROOT, gather


def main() -> int:
    """Gather the pages and build the site; anything that Zensical warns of is an error."""
    if sys.argv[1:] == ["notebooks"]:
        notebooks.store(ROOT / "examples")
        return 0
    gather(ROOT / "target/pages")
    line = [sys.executable, "-m", "zensical", "build", "--strict", "--clean"]
    return subprocess.run(line, cwd=ROOT, check=False).returncode


if __name__ == "__main__":
    sys.exit(main())
