"""The pages of the site, gathered from the repository."""

from __future__ import annotations

import re
import shutil
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from handbook import diagrams, notebooks, reference

HERE = Path(__file__).resolve().parent
ROOT = HERE.parent
LINK = re.compile(r"(!?)\[((?:[^\[\]]|\[[^\]]*\])*)\]\(([^)\s]+)\)")
FENCE = re.compile(r"^( *)(```|~~~).*?^\1\2\s*$", re.MULTILINE | re.DOTALL)
GLUED = re.compile(r"^((?![-*] |\d+\. |\s|#|\||>).+\n)(?=(?:[-*]|1\.) )", re.MULTILINE)


def paths(nav: list[dict[str, Any]]) -> Iterator[str]:
    """Pages of a navigation, in its order."""
    for entry in nav:
        for value in entry.values():
            if isinstance(value, str):
                yield value
            else:
                yield from paths(value)


def gather(folder: Path) -> None:
    """Write every page of the navigation, and the pictures on it, into an empty folder."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    project = tomllib.loads((ROOT / "zensical.toml").read_text("utf-8"))["project"]
    for name in (*project["extra_css"], *project["extra"]["polyfills"]):
        shutil.copy(HERE / name, folder / name)
    pages = list(paths(project["nav"]))
    for page in pages:
        place = folder / page
        place.parent.mkdir(parents=True, exist_ok=True)
        if page in reference.PAGES:
            place.write_text(reference.PAGES[page](), "utf-8")
        elif (notebook := (ROOT / page).with_suffix(".ipynb")).is_file():
            notebooks.write(notebook, place)
        else:
            text = (ROOT / page).read_text("utf-8")
            place.write_text(adapted(text, page, pages, folder), "utf-8")


def adapted(text: str, page: str, pages: list[str], folder: Path) -> str:
    """Text of a page for Zensical; links to files outside of the site are removed."""

    def link(found: re.Match[str]) -> str:
        picture, words, target = found.groups()
        place, _, anchor = target.partition("#")
        if not place or re.match(r"[a-z]+:", target):
            return found[0]
        path = ((ROOT / page).parent / place).resolve().relative_to(ROOT)
        if picture:
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy(ROOT / path, folder / path)
        elif (ROOT / path).is_dir() and f"{path}/README.md" in pages:
            return f"[{words}]({place.rstrip('/')}/README.md{'#' + anchor if anchor else ''})"
        elif path.suffix == ".ipynb" and str(path.with_suffix(".md")) in pages:
            return f"[{words}]({place.removesuffix('.ipynb')}.md)"
        elif str(path) not in pages:
            return words
        return found[0]

    def prose(part: str) -> str:
        # where the repository is read a list needs no empty line before it
        return GLUED.sub(r"\1\n", LINK.sub(link, part))

    parts: list[str] = []
    end = 0
    for fence in FENCE.finditer(text):
        parts += [prose(text[end : fence.start()]), diagrams.shown(fence[0])]
        end = fence.end()
    return "".join([*parts, prose(text[end:])])
