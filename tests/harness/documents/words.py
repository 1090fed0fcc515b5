"""Texts and commands of the pages of the site."""

from __future__ import annotations

import re
import tomllib

from handbook.pages import ROOT, paths

NAV = tomllib.loads((ROOT / "zensical.toml").read_text("utf-8"))["project"]["nav"]
PAGES = [page for page in paths(NAV) if (ROOT / page).is_file()]
"""Hand-written pages."""


def text(page: str) -> str:
    return (ROOT / page).read_text("utf-8")


SHELL = ("", "sh")
"""Languages of the code blocks with commands; a block that is only to be read has `text`."""


def shell(page: str) -> list[str]:
    """Command lines of a page, without remarks."""
    fences = re.findall(r"^```([^\n]*)\n(.*?)^```$", text(page), re.MULTILINE | re.DOTALL)
    found = [line for language, fence in fences if language in SHELL for line in fence.splitlines()]
    # two blanks separate a command and its remark
    return [re.split(r"\s{2,}|\s# | \| ", line.strip())[0].strip() for line in found if line.strip()]


def lines(page: str, program: str) -> list[str]:
    """Command lines of a page that start with a program."""
    return [line for line in shell(page) if line.split()[0] == program]


def listed(program: str) -> list[str]:
    """Command lines of all pages, each once."""
    return list(dict.fromkeys(line for page in PAGES for line in lines(page, program)))


def mentioned(program: str) -> list[str]:
    """Commands in the sentences and tables of all pages, each once; not of CHANGELOG.md."""
    pages = (page for page in PAGES if page != "CHANGELOG.md")
    found = (one for page in pages for one in re.findall(r"`([^`\n]+)`", text(page)))
    return list(dict.fromkeys(one for one in found if one.startswith(f"{program} ")))
