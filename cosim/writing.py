"""Files that are written: texts, and large ones that are there only when they are whole."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from pathlib import Path

from cosim.errors import CosimError


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


@contextlib.contextmanager
def whole(file: Path) -> Iterator[Path]:
    """Path to write to that becomes `file` at the end: a file that is there is whole.

    A link stays one, what it leads to is written; so is a device at once, nothing can take its place.

    Raises
    ------
    CosimError
        The file cannot be written; as after any other exception, nothing of it stays.
    """
    target = file.resolve()
    try:
        if target.exists() and not target.is_file():
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
    return file.with_name(f".{file.name}.partial")


def discard(file: Path) -> None:
    """Remove what a process that died has left of a file."""
    with contextlib.suppress(OSError):
        partial(file.resolve()).unlink(missing_ok=True)


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
