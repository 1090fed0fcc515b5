"""Files that are written: texts, and large ones that are there only when they are whole."""

from __future__ import annotations

import contextlib
import os
import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from cosim.errors import CosimError

JSON = re.compile(rb"\s*(\{|\[\s*[{\]])")
"""How a JSON file begins that a command wrote; `[` alone begins a table of TOML as well."""
LOOKED_AT = 4096
"""Bytes of a file by which its kind is told."""


def write(text: str, file: str | Path) -> None:
    """Write a text to a file, or to stdout where it is `-`.

    Raises
    ------
    CosimError
        The file cannot be written.
    """
    if file == "-":
        print(text, end="", flush=True)
        return
    with naming(file):
        Path(file).write_text(text, encoding="utf-8")


def check_text(option: str, file: str | Path, kind: str, beginning: re.Pattern[bytes]) -> None:
    """Check before a long run that a text can be written to a file, over nothing but a text of its kind.

    Parameters
    ----------
    option
        What names the file, for messages.
    file
        The file; `-` is stdout.
    kind, beginning
        What is written, and how texts of that kind begin.

    Raises
    ------
    CosimError
        There is no such folder, or a file of another kind.
    """
    path = Path(file)
    if file == "-":
        return
    check_folder(path)
    there = beginning_of(path)
    if there and not beginning.match(there):
        problem = f"`{option}` `{file}` would be written over a file that is no {kind}"
        raise CosimError(problem, "choose another name, or remove the file")


def beginning_of(file: Path) -> bytes:
    """First bytes of a file; none of one that is not there, or a device, which loses nothing."""
    if not file.is_file():
        return b""
    try:
        with file.open("rb") as stream:
            return stream.read(LOOKED_AT)
    except OSError as error:
        raise refused(file, error) from None


def check_folder(file: Path) -> None:
    """Check before a long run that the folder of a file is there.

    Raises
    ------
    CosimError
        It is not.
    """
    if not file.absolute().parent.is_dir():
        raise CosimError(f"cannot write `{file}`: the folder `{file.absolute().parent}` does not exist")


def check_apart(files: Mapping[str, Path | None]) -> None:
    """Check that files, by the options that name them, are not one and the same.

    Raises
    ------
    CosimError
        Two are.
    """
    seen: dict[str, str] = {}
    for option, file in files.items():
        if file is None:
            continue
        other = seen.setdefault(os.path.realpath(file), option)
        if other != option and not is_device(file):
            raise CosimError(
                f"`{other}` and `{option}` are one file: `{file}`", "give each a file of its own"
            )


def is_device(file: Path) -> bool:
    """Whether what is there is no file that holds something, such as `/dev/null`."""
    return file.exists() and not file.is_file()


@contextlib.contextmanager
def whole(file: Path) -> Iterator[Path]:
    """Path to write to that becomes `file` at the end: a file that is there is whole.

    A link stays one, what it leads to is written; a device is written to itself.

    Raises
    ------
    CosimError
        The file cannot be written; as after any other exception, nothing of it stays.
    """
    target = Path(os.path.realpath(file))
    try:
        if is_device(target):
            yield target
        else:
            yield partial(target)
            partial(target).replace(target)
    except BaseException as error:
        discard(target)
        if isinstance(error, OSError):
            raise refused(file, error) from None
        raise


def partial(file: Path) -> Path:
    """Path of a file that is being written."""
    target = Path(os.path.realpath(file))
    return target.with_name(f".{target.name}.partial")


def discard(file: Path) -> None:
    """Remove what a process that died has left of a file."""
    with contextlib.suppress(OSError):
        partial(Path(os.path.realpath(file))).unlink(missing_ok=True)


def refused(file: str | Path, error: OSError, hint: str = "") -> CosimError:
    """Error of a file that cannot be written."""
    return CosimError(f"cannot write `{file}`: {error.strerror or error}", hint)


@contextlib.contextmanager
def naming(file: str | Path, hint: str = "") -> Iterator[None]:
    """Make an error of the system one of the file that is written."""
    try:
        yield
    except OSError as error:
        raise refused(file, error, hint) from None
