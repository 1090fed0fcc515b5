"""FMUs of a checkout that are older than their sources."""

from __future__ import annotations

import tomllib
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.fmu.named import NamedFmu
from cosim.warned import warn_once

PARTS = ("Cargo.toml", "build.rs", "src", "resources")
"""Sources of a library in the folder of its crate."""


def warn_of(fmus: Iterable[NamedFmu], folder: Path) -> None:
    """Warn as `warn` does of every FMU; its file may be relative to a folder."""
    for choice in fmus:
        warn(choice.fmu, paths.find_fmu(choice.fmu, folder))


def warn(name: str, file: Path) -> None:
    """Warn that an FMU found by name is older than its sources.

    FMUs given by path, from other folders or without sources are not checked.
    """
    folder = paths.OWN_FMUS
    if file.name != f"{name}.fmu" or file.parent != folder.resolve():
        return
    checkout = folder.parent.parent
    times = ((source, source.stat().st_mtime) for source in sources(checkout, name))
    if changed := changed_after(file.stat().st_mtime, times):
        shown, command = paths.shown(changed), f"cargo xtask fmu {name.removeprefix('fmu-')}"
        warn_once(f"`{paths.shown(file)}` is older than `{shown}`: build it again with `{command}`")


def changed_after(built: float, times: Iterable[tuple[Path, float]]) -> Path | None:
    """File of the last change after `built`, None if there is no change."""
    changed = [(time, path) for path, time in times if time > built]
    return max(changed)[1] if changed else None


def sources(checkout: Path, name: str) -> list[Path]:
    """Source files of the library of a crate, including its path dependencies."""
    found: list[Path] = []
    for folder in crates(checkout, name):
        for part in PARTS:
            found += [folder / part, *(folder / part).rglob("*")]
    return [path for path in found if path.is_file()]


def crates(checkout: Path, name: str) -> list[Path]:
    """Folders of a crate of a cargo workspace and of its dependencies; none for a missing crate."""
    if not (checkout / name / "Cargo.toml").is_file() or not (checkout / "Cargo.toml").is_file():
        return []
    shared = manifest(checkout).get("workspace", {}).get("dependencies", {})
    places = {
        key: entry["path"] for key, entry in shared.items() if isinstance(entry, dict) and "path" in entry
    }
    found: list[Path] = []
    waiting = [name]
    while waiting:
        folder = checkout / waiting.pop()
        if folder not in found and (folder / "Cargo.toml").is_file():
            found.append(folder)
            waiting += [places[key] for key in manifest(folder).get("dependencies", {}) if key in places]
    return found


def manifest(folder: Path) -> dict[str, Any]:
    """`Cargo.toml` of a folder; empty if it is invalid, which cargo reports."""
    try:
        return tomllib.loads((folder / "Cargo.toml").read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError):
        return {}
