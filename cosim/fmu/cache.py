"""The cache of extracted FMUs: a folder for each file, named by its hash and complete before use."""

from __future__ import annotations

import atexit
import contextlib
import functools
import hashlib
import logging
import os
import re
import shutil
import stat
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from cosim import paths
from cosim.errors import FmuError
from cosim.warned import warn_once

log = logging.getLogger("cosim")

UNUSED_DAYS = 7
"""Days without use after which an extracted FMU is removed."""
PARTIAL = ".partial-"
OWN = re.compile(rf"[0-9a-f]{{32}}|{re.escape(PARTIAL)}\w+")
"""Names of the folders of the cache; other folders are never removed."""
LOCK = ".lock"
PATIENCE = 300.0
"""Maximum wait for the extraction by another process, s."""
FOREIGN = stat.S_IWGRP | stat.S_IWOTH


def extracted(path: Path, sizes: dict[str, int], unpack: Callable[[Path], None]) -> Path:
    """Folder with the content of an FMU; extracted unless it exists and is complete.

    The folder is named by the SHA-256 of the file, so a rebuilt FMU has a new folder.
    Missing or truncated files are extracted again. `sizes` are its files and their sizes in bytes; `unpack`
    extracts it into a folder.
    """
    with path.open("rb") as file:
        digest = hashlib.file_digest(file, "sha256").hexdigest()[:32]
    cache = usable(paths.cache_folder())
    folder = cache / digest
    try:
        if not is_whole(folder, sizes):
            with locked(cache):
                if not is_whole(folder, sizes):
                    remove_unused(cache)
                    make(folder, sizes, unpack)
        os.utime(folder)
    except OSError as error:
        problem = f"cannot extract the FMU into `{cache}`: {error.strerror or error}"
        raise FmuError(problem, f"Set {paths.CACHE_ENV} to another folder.") from None
    return folder


def make(folder: Path, sizes: dict[str, int], unpack: Callable[[Path], None]) -> None:
    """Extract next to `folder` and rename, so that no process sees a partial folder."""
    free, needed = shutil.disk_usage(folder.parent).free, sum(sizes.values())
    if needed > free:
        raise FmuError(
            f"the FMU unpacks to {needed / 1e6:.0f} MB, but `{folder.parent}` has {free / 1e6:.0f} MB free",
            f"Set {paths.CACHE_ENV} to a folder on a larger disk.",
        )
    partial = Path(tempfile.mkdtemp(prefix=PARTIAL, dir=folder.parent))
    try:
        unpack(partial)
        if folder.exists():
            log.warning("`%s` was damaged, the FMU is extracted again", folder)
            discard(folder)
        partial.rename(folder)
    finally:
        shutil.rmtree(partial, ignore_errors=True)


def is_whole(folder: Path, sizes: dict[str, int]) -> bool:
    """Whether every file of an FMU is complete in its folder; an FMU may add files."""
    try:
        return owned(folder.lstat()) and all(
            (folder / name).stat().st_size >= size for name, size in sizes.items()
        )
    except OSError:
        return False


def remove_unused(cache: Path, days: float = UNUSED_DAYS) -> int:
    """Remove folders of the cache that were not used for some days; return their number."""
    oldest, removed = time.time() - days * 86400.0, 0
    for folder in cache.iterdir():
        with contextlib.suppress(OSError):
            found = folder.lstat()
            if OWN.fullmatch(folder.name) and stat.S_ISDIR(found.st_mode) and found.st_mtime < oldest:
                discard(folder)
                removed += 1
    return removed


def discard(folder: Path) -> None:
    """Remove a folder; it is renamed first, so that its name disappears atomically."""
    aside = folder.with_name(f"{PARTIAL}{os.getpid()}_{time.monotonic_ns()}")
    folder.rename(aside)
    if aside.is_dir():
        shutil.rmtree(aside, ignore_errors=True)
    else:
        aside.unlink()


@contextlib.contextmanager
def locked(cache: Path) -> Iterator[None]:
    """Lock the cache for writing by one process; the lock ends with the process."""
    import filelock

    try:
        with filelock.FileLock(cache / LOCK, timeout=PATIENCE):
            yield
    except filelock.Timeout:
        problem = f"another process has been writing to `{cache}` for {PATIENCE:g} s"
        raise FmuError(problem, f"End it, or remove `{cache / LOCK}`.") from None


def usable(wanted: Path) -> Path:
    """Return the requested folder if only this user owns and can write it; otherwise a temporary folder.

    The next session runs code from the cache, so another user must not be able to write it.
    """
    problem = refusal(wanted)
    if not problem:
        return wanted
    user = os.getuid() if hasattr(os, "getuid") else "user"
    fallback = Path(tempfile.gettempdir()) / f"{paths.CACHE_NAME}-{user}"
    if refusal(fallback):
        fallback = of_this_process()
    warn_once(f"the cache `{wanted}` {problem}: FMUs are extracted to `{fallback}`")
    return fallback


@functools.cache
def of_this_process() -> Path:
    """Make a folder that is removed when this process ends."""
    folder = Path(tempfile.mkdtemp(prefix=f"{paths.CACHE_NAME}-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def refusal(cache: Path) -> str:
    """Reason why a folder cannot be the cache, empty if it can; makes a missing folder."""
    try:
        cache.parent.mkdir(parents=True, exist_ok=True)
        with contextlib.suppress(FileExistsError):
            cache.mkdir(mode=0o700)
        found = cache.lstat()
        if not stat.S_ISDIR(found.st_mode):
            return "is not a folder"
        if not os.access(cache, os.W_OK | os.X_OK):
            return "cannot be written"
        if not owned(found):
            return "belongs to another user"
        if hasattr(os, "getuid") and found.st_mode & FOREIGN:
            cache.chmod(stat.S_IMODE(found.st_mode) & ~FOREIGN)
            if cache.lstat().st_mode & FOREIGN:
                return "can be written by other users"
    except OSError as error:
        return f"cannot be used ({error.strerror or error})"
    return ""


def owned(found: os.stat_result) -> bool:
    """Whether a file belongs to this user."""
    return not hasattr(os, "getuid") or found.st_uid == os.getuid()
