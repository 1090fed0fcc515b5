"""The files in an FMU, checked before extraction because the zip file may be malicious."""

from __future__ import annotations

import stat
import zipfile
from pathlib import Path, PurePosixPath

from cosim import paths
from cosim.errors import FmuError

DESCRIPTION = "modelDescription.xml"
METHODS = {zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED, zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA}
ENCRYPTED = 0x1
MAX_FILES = 100_000
SMALL = 200_000_000
"""Unpacked size in bytes up to which any compression ratio is allowed."""
MAX_RATIO = 100.0
"""Maximum ratio of unpacked to packed size of a large FMU; libraries reach 5, tables 30."""
AGAIN = "Build or copy it again."


def sizes(path: Path) -> dict[str, int]:
    """Files of an FMU and their unpacked sizes in bytes; each is checked."""
    shown = paths.shown(path)
    with zipped(path, shown) as archive:
        infos = archive.infolist()
    if len(infos) > MAX_FILES:
        raise FmuError(f"`{shown}` holds {len(infos)} files, more than {MAX_FILES}", AGAIN)
    for info in infos:
        if problem := problem_of(info):
            raise FmuError(f"`{shown}`: the file `{paths.brief(info.filename)}` in it {problem}", AGAIN)
    files = {info.filename: info.file_size for info in infos if not info.is_dir()}
    if DESCRIPTION not in files:
        names = ", ".join(f"`{paths.brief(name)}`" for name in sorted(files)[:5])
        holds = f"It holds {names}." if files else "it is empty"
        raise FmuError(f"`{shown}` is not an FMU: it holds no `{DESCRIPTION}`", f"{holds}; {AGAIN}")
    check_size(shown, sum(files.values()), path.stat().st_size)
    for name in files:
        for above in PurePosixPath(name).parents:
            if str(above) in files:
                raise FmuError(f"`{shown}`: `{above}` in it is both a file and a folder", AGAIN)
    return files


def zipped(path: Path, shown: str) -> zipfile.ZipFile:
    """Open a zip file."""
    try:
        return zipfile.ZipFile(path)
    except (zipfile.BadZipFile, ValueError, NotImplementedError) as error:
        with path.open("rb") as file:
            start = file.read(4)
        if not start:
            problem = "it is empty"
        elif start == b"PK\x03\x04":
            problem = f"it is a truncated or damaged zip file ({error})"
        else:
            problem = "it is not a zip file"
        raise FmuError(f"`{shown}` is not an FMU: {problem}", AGAIN) from None


def problem_of(info: zipfile.ZipInfo) -> str:
    """Problem of one file in an FMU; empty if there is none."""
    name = info.orig_filename
    if "\\" in name:
        return "has a backslash in its name; FMI requires forward slashes"
    if name.startswith("/") or ":" in name:
        return "has an absolute path"
    if ".." in PurePosixPath(name).parts:
        return "leaves the folder of the FMU"
    if not all(character.isprintable() for character in name):
        return "has a control character in its name"
    if stat.S_ISLNK(info.external_attr >> 16):
        return "is a symbolic link"
    if info.flag_bits & ENCRYPTED:
        return "is encrypted"
    if info.compress_type not in METHODS:
        return f"is compressed by method {info.compress_type}; FMI requires 8 (deflate)"
    return ""


def check_size(shown: str, unpacked: int, packed: int) -> None:
    """Check that an FMU does not unpack to many times its size."""
    if unpacked > SMALL and unpacked > MAX_RATIO * packed:
        raise FmuError(
            f"`{shown}` of {packed / 1e6:.3g} MB unpacks to {unpacked / 1e6:.0f} MB, "
            f"{unpacked / packed:.0f} times as much; the limit is {MAX_RATIO:g} times",
            "Pack it without compression if the size is intended.",
        )
