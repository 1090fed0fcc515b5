"""Locations of scenarios, FMUs and the extraction cache."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator
from pathlib import Path

import platformdirs

from cosim.errors import CosimError, FmuError, PlantError, ScenarioError, closest, readable
from cosim.warned import warn_once

PACKED = Path(__file__).resolve().parent / "packed"
"""Scenarios and FMUs in the wheel."""
ROOT = PACKED.parent.parent
"""Project root of an editable install."""
OWN_SCENARIOS = PACKED / "scenarios" if PACKED.is_dir() else ROOT / "scenarios"
OWN_STUDIES = PACKED / "studies" if PACKED.is_dir() else ROOT / "studies"
OWN_FMUS = PACKED / "fmu" if PACKED.is_dir() else ROOT / "target" / "fmu"
SCENARIOS_ENV = "COSIM_SCENARIOS"
FMU_PATH_ENV = "COSIM_FMU_PATH"
CACHE_ENV = "COSIM_CACHE"
CACHE_NAME = "machining-fmus"
LONGEST = 100
"""Maximum length of a name in a message."""
is_file, is_there = os.path.isfile, os.path.exists
"""False for invalid names, for which the methods of `Path` raise errors."""


def scenario_folders() -> list[Path]:
    """Folders searched for scenario names: `COSIM_SCENARIOS`, `./scenarios`, the project's own."""
    return unique([*from_env(SCENARIOS_ENV), working_folder() / "scenarios", OWN_SCENARIOS])


def fmu_folders() -> list[Path]:
    """Folders searched for FMU names: `COSIM_FMU_PATH`, `./target/fmu`, the project's own."""
    return unique([*from_env(FMU_PATH_ENV), working_folder() / "target" / "fmu", OWN_FMUS])


def find_scenario(name: str, near: Path | None = None) -> Path:
    """File of a scenario given by name (`dob`, `dob/paper`) or by path (`*.toml`).

    A path is relative to `near`, the folder of the file that names it, or to the working directory.
    """
    bases = [near] if near else []
    if name.endswith(".toml"):
        # a study of the project is named by its kind
        places = [*bases, working_folder(), OWN_STUDIES.parent]
        if file := existing(name, places):
            return file
        problem = f"the scenario file `{brief(name)}` {missing(name, places)}"
        raise ScenarioError(problem, "List the known names with `cosim list`.")
    for folder in [*bases, *scenario_folders()]:
        if is_file(file := folder / f"{name}.toml"):
            return file
    if set(name) & set("*?"):
        hint = f"Run all matching scenarios with `cosim test '{brief(name)}'`."
        raise ScenarioError(f"`{brief(name)}` is a pattern, not a scenario", hint)
    hint = closest(name, dict(list_scenarios()))
    nothing = f"no scenario files in {folders_text()}"
    raise ScenarioError(f"there is no scenario `{brief(name)}`", hint or nothing)


def list_scenarios() -> Iterator[tuple[str, Path]]:
    """Name and file of every scenario in the folders, sorted; the first of two equal names is used."""
    seen: set[str] = set()
    for folder in scenario_folders():
        files = folder.glob("**/*.toml")
        names = {file.relative_to(folder).with_suffix("").as_posix(): file for file in files}
        for name, file in sorted(names.items()):
            if name not in seen:
                seen.add(name)
                yield name, file


def find_study(name: str) -> Path:
    """File of a study given by path, or of one of the project's own (`studies/dob-contact.toml`)."""
    places = [working_folder(), OWN_STUDIES.parent]
    if file := existing(name, places):
        return file
    if name in dict(list_scenarios()):
        raise ScenarioError(f"`{name}` is a scenario, not a study", f"Use `cosim run {name}`.")
    hint = closest(name, list_studies())
    raise ScenarioError(f"the study file `{brief(name)}` {missing(name, places)}", hint)


def list_studies() -> dict[str, Path]:
    """Names and files of the project's own studies, sorted."""
    return {f"{OWN_STUDIES.name}/{file.name}": file for file in sorted(OWN_STUDIES.glob("*.toml"))}


def scenario_name(file: Path) -> str:
    """Name of a scenario file: relative to its scenario folder, otherwise its stem."""
    for folder in scenario_folders():
        if resolved(file).is_relative_to(folder):
            return resolved(file).relative_to(folder).with_suffix("").as_posix()
    return file.stem


def find_fmu(name: str, near: Path) -> Path:
    """File of an FMU given by path or by name (`fmu-dob` is `fmu-dob.fmu` in one of the FMU folders)."""
    places = [near, working_folder()]
    if name.endswith(".fmu") or "/" in name or os.sep in name:
        if file := existing(name, places):
            return file
        raise FmuError(f"the FMU file `{brief(name)}` {missing(name, places)}", looked_in(near))
    folders = [near, *fmu_folders()]
    for folder in folders:
        if is_file(file := folder / f"{name}.fmu"):
            return file
    if existing(name, places):
        raise FmuError(f"`{brief(name)}` is not an FMU", "Use a file that ends in `.fmu`.")
    searched = ", ".join(f"`{shown(folder)}`" for folder in unique(folders))
    build = f"Build it with `cargo xtask fmu {brief(name.removeprefix('fmu-'))}`, or set {FMU_PATH_ENV}."
    raise FmuError(f"the FMU `{brief(name)}.fmu` does not exist", f"{build} Searched: {searched}.")


def find_mjcf(name: str, near: Path) -> Path:
    """MJCF file given by its path, relative to `near` or to the working directory."""
    places = [near, working_folder()]
    if file := existing(name, places):
        return file.resolve()
    beside = [file.name for file in sorted(near.glob("*.xml"))]
    hint = closest(name, beside) or looked_in(near)
    raise PlantError(f"the MJCF file `{brief(name)}` {missing(name, places)}", hint)


def existing(name: str, places: Iterable[Path]) -> Path | None:
    """First file of a name, or of a path, in some folders."""
    return next((file for place in places if is_file(file := place / expanded(name))), None)


def missing(name: str, places: Iterable[Path]) -> str:
    """Reason why a path is not a regular file."""
    there = any(is_there(place / expanded(name)) for place in places)
    return "is not a regular file" if there else "does not exist"


def looked_in(near: Path) -> str:
    """Hint with the searched folders: that of the file that names it, and the working directory."""
    return "Searched: " + " and ".join(f"`{folder}`" for folder in unique([near, working_folder()]))


def cache_folder() -> Path:
    """Folder of the cache: in `COSIM_CACHE`, or in the user's cache folder."""
    given = os.environ.get(CACHE_ENV)
    if given:
        return working_folder() / given / CACHE_NAME
    return platformdirs.user_cache_path(CACHE_NAME, appauthor=False) / "extracted"


def working_folder() -> Path:
    """Working directory; raises CosimError if it was removed."""
    try:
        return Path.cwd()
    except OSError as error:
        problem = f"the working directory cannot be used: {error.strerror or error}"
        raise CosimError(problem, "Change to an existing folder.") from None


def resolved(path: Path) -> Path:
    """Path without symbolic links; a circular link stays unchanged."""
    return Path(os.path.realpath(path))


def expanded(name: str) -> Path:
    """Path with `~` replaced by the home folder, if there is one."""
    return Path(os.path.expanduser(name))  # noqa: PTH111 - without an error if there is none


def brief(name: str) -> str:
    """Name for a message: shortened, without control codes."""
    shown = readable(name[:LONGEST]).replace("\n", "\ufffd")
    return shown if len(name) <= LONGEST else f"{shown}..."


def shown(path: Path) -> str:
    """Path for display: relative to the working directory if that is shorter."""
    try:
        return str(resolved(path).relative_to(Path.cwd())) or "."
    except (ValueError, OSError):
        return str(path)


def folders_text() -> str:
    """Scenario folders as text."""
    return ", ".join(f"`{shown(folder)}`" for folder in scenario_folders())


def from_env(name: str) -> list[Path]:
    """Folders in an environment variable, separated as in PATH."""
    found = [Path(part) for part in os.environ.get(name, "").split(os.pathsep) if part]
    for folder in found:
        if not folder.is_dir():
            warn_once(f"`{name}` names `{folder}`, which is not a folder")
    return found


def unique(folders: list[Path]) -> list[Path]:
    """Remove repeated folders."""
    return list(dict.fromkeys(map(resolved, folders)))
