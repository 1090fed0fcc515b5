"""What stands on the pages of the site."""

from __future__ import annotations

import re
import tomllib

from handbook.pages import ROOT, paths

NAV = tomllib.loads((ROOT / "zensical.toml").read_text("utf-8"))["project"]["nav"]
PAGES = [page for page in paths(NAV) if (ROOT / page).is_file()]
"""Pages that somebody wrote."""


def text(page: str) -> str:
    return (ROOT / page).read_text("utf-8")


def lines(page: str, program: str) -> list[str]:
    """Command lines of a page that begin with a program, without what is said of them."""
    fences = re.findall(r"^```(\w*)\n(.*?)^```$", text(page), re.MULTILINE | re.DOTALL)
    shell = [line for language, fence in fences if not language for line in fence.splitlines()]
    found = [line for line in shell if line.split()[:1] == [program]]
    # two blanks part a command from what it does
    return [re.split(r"\s{2,}|\s# | \| ", line)[0].strip() for line in found]


def listed(program: str) -> list[str]:
    """Command lines of all pages, each once."""
    return list(dict.fromkeys(line for page in PAGES for line in lines(page, program)))
