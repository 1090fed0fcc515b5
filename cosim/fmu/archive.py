"""FMU files: checked, described and extracted once into a cache keyed by the file's hash."""

from __future__ import annotations

import functools
import hashlib
import os
import shutil
import tempfile
import time
import zipfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import fmpy

from cosim import paths
from cosim.errors import FmuError

UNUSED_DAYS = 7
"""An extracted FMU that was not used for so long is removed."""
MOST_PROBLEMS = 20
"""Problems of a model description that are told; one mistake in a tool repeats for every variable."""


@dataclass(frozen=True)
class DisplayUnit:
    """Unit that people read: `factor` times the value in the unit of the variable, plus `offset`.

    A variable that is a difference (`relativeQuantity` of its declared type) has no offset.
    """

    name: str
    factor: float = 1.0
    offset: float = 0.0


@dataclass(frozen=True)
class Variable:
    """One scalar variable of an FMU.

    Parameters
    ----------
    kind
        FMI type: Real, Integer, Boolean, String or Enumeration.
    start, minimum, maximum, unit
        As in the model description; empty where not given.
    items
        Names and numbers of an enumeration, empty otherwise.
    display
        Its display unit, where the description gives one.
    """

    name: str
    reference: int
    kind: str
    causality: str
    variability: str
    description: str
    start: str
    unit: str
    minimum: str
    maximum: str
    items: tuple[tuple[str, int], ...] = ()
    display: DisplayUnit | None = None


@dataclass(frozen=True)
class FmuFile:
    """An FMU that was found to be an FMI 2.0 co-simulation FMU for this platform."""

    path: Path
    folder: Path
    guid: str
    identifier: str
    name: str
    description: str
    variables: dict[str, Variable]

    def named(self, causality: str) -> list[Variable]:
        """Return the variables of one causality in the order of the model description."""
        return [variable for variable in self.variables.values() if variable.causality == causality]


def open_fmu(path: Path) -> FmuFile:
    """Check an FMU file, read its description and extract it.

    Raises
    ------
    FmuError
        Not a zip file, no or broken model description, not FMI 2.0, not co-simulation, no binary for this
        platform.
    """
    try:
        stat = path.stat()
    except OSError as error:
        raise unreadable(path, error) from None
    file = opened(path, stat.st_mtime_ns, stat.st_size, paths.cache_folder())
    if not file.folder.is_dir():
        opened.cache_clear()
        return open_fmu(path)
    return file


@functools.lru_cache(16)
def opened(path: Path, changed: int, size: int, cache: Path) -> FmuFile:
    """Open an FMU; the same file is opened once in a process."""
    shown = paths.shown(path)
    try:
        version, kinds, platforms = inspect(path)
        if version != "2.0":
            raise FmuError(f"`{shown}` is an FMI {version} FMU, only FMI 2.0 is supported")
        if "CoSimulation" not in kinds:
            raise FmuError(
                f"`{shown}` offers only {' and '.join(kinds) or 'nothing'}, not co-simulation",
                "export it as a co-simulation FMU",
            )
        check_platform(shown, platforms)
        description = fmpy.read_model_description(str(path))
        return describe(path, extract(path), description)
    except FmuError:
        raise
    except zipfile.BadZipFile:
        raise FmuError(f"`{shown}` is not an FMU: it is not a zip file", "build or copy it again") from None
    except KeyError:
        raise FmuError(f"`{shown}` is not an FMU: it holds no `modelDescription.xml`") from None
    except OSError as error:
        raise unreadable(path, error) from None
    except Exception as error:  # FMPy raises bare exceptions for a broken model description
        found = "".join(f"\n  {problem}" for problem in problems(error))
        raise FmuError(
            f"the model description of `{shown}` is not valid:{found}",
            f"`fmpy validate {shown}` lists all problems",
        ) from None


def unreadable(path: Path, error: OSError) -> FmuError:
    """Error of a file that cannot be read."""
    return FmuError(f"cannot read the FMU `{paths.shown(path)}`: {error.strerror or error}")


def inspect(path: Path) -> tuple[str, list[str], list[str]]:
    """FMI version, interface types and platforms of an FMU, without extracting it."""
    from lxml import etree

    with zipfile.ZipFile(path) as archive, archive.open("modelDescription.xml") as file:
        root = etree.parse(file).getroot()
    kinds = [kind for kind in ("CoSimulation", "ModelExchange") if root.find(kind) is not None]
    return root.get("fmiVersion", "without a version"), kinds, fmpy.supported_platforms(str(path))


def check_platform(shown: str, platforms: list[str]) -> None:
    """Check that there is a binary for this machine."""
    if fmpy.platform not in platforms:
        has = ", ".join(f"`{name}`" for name in platforms) or "none at all"
        raise FmuError(
            f"`{shown}` has no binary for this platform, `{fmpy.platform}`; it has {has}",
            "build it on this machine, or ask for an FMU with this platform",
        )


def describe(path: Path, folder: Path, description: Any) -> FmuFile:
    """Keep what the harness needs from FMPy's model description."""
    displays = {
        (unit.name, display.name): DisplayUnit(display.name, float(display.factor), float(display.offset))
        for unit in description.unitDefinitions
        for display in unit.displayUnits
    }
    variables = {variable.name: scalar(variable, displays) for variable in description.modelVariables}
    return FmuFile(
        path=path,
        folder=folder,
        guid=description.guid,
        identifier=description.coSimulation.modelIdentifier,
        name=description.modelName,
        description=description.description or "",
        variables=variables,
    )


def scalar(variable: Any, displays: dict[tuple[str, str], DisplayUnit]) -> Variable:
    """Variable from FMPy's, whose type may come from its declared type."""
    declared = variable.declaredType

    def attribute(name: str) -> str:
        own = getattr(variable, name)
        return str(own or (getattr(declared, name, None) if declared else None) or "")

    display = displays.get((attribute("unit"), attribute("displayUnit")))
    if display and attribute("relativeQuantity"):
        display = replace(display, offset=0.0)
    return Variable(
        name=variable.name,
        reference=variable.valueReference,
        kind=variable.type,
        causality=variable.causality or "local",
        variability=variable.variability or "continuous",
        description=variable.description or "",
        start=variable.start or "",
        unit=attribute("unit"),
        minimum=attribute("min"),
        maximum=attribute("max"),
        items=tuple((item.name, int(item.value)) for item in (declared.items if declared else ())),
        display=display,
    )


def extract(path: Path) -> Path:
    """Extract an FMU into the cache, or find it there; returns the folder.

    The folder is named by the SHA-256 of the file, so a rebuilt FMU is never mixed up with an older one.
    Several processes may extract the same FMU at once: the first to finish wins.
    """
    cache = writable_cache()
    digest = hashlib.sha256(path.read_bytes()).hexdigest()[:32]
    folder = cache / digest
    if not folder.is_dir():
        remove_unused(cache)
        partial = Path(tempfile.mkdtemp(prefix=".partial-", dir=cache))
        try:
            fmpy.extract(str(path), str(partial))
            partial.rename(folder)
        except OSError:
            if not folder.is_dir():
                raise
        finally:
            shutil.rmtree(partial, ignore_errors=True)
    os.utime(folder)
    return folder


def writable_cache() -> Path:
    """Cache folder, or one in the system's temporary folder where the user has no writable home."""
    cache = paths.cache_folder()
    try:
        cache.mkdir(parents=True, exist_ok=True)
        if os.access(cache, os.W_OK):
            return cache
    except OSError:
        pass
    fallback = (
        Path(tempfile.gettempdir()) / f"machining-fmus-{os.getuid() if hasattr(os, 'getuid') else 'user'}"
    )
    fallback.mkdir(mode=0o700, parents=True, exist_ok=True)
    return fallback


def remove_unused(cache: Path) -> None:
    """Remove what was extracted but not used for `UNUSED_DAYS` days."""
    oldest = time.time() - UNUSED_DAYS * 86400.0
    for folder in cache.iterdir():
        if folder.is_dir() and folder.stat().st_mtime < oldest:
            shutil.rmtree(folder, ignore_errors=True)


def problems(error: Exception) -> list[str]:
    """List what FMPy found in a model description, one line each; the first `MOST_PROBLEMS` of them."""
    found = [str(problem) for problem in getattr(error, "problems", [])]
    found = found or str(error).splitlines()[:1] or [type(error).__name__]
    more = len(found) - MOST_PROBLEMS
    return found[:MOST_PROBLEMS] + ([f"and {more} more"] if more > 0 else [])
