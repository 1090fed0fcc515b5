"""Writing of files: texts, and large files that appear only when they are complete."""

from __future__ import annotations

import contextlib
import errno
import os
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from cosim.errors import CosimError

JSON = re.compile(rb"\s*(\{|\[\s*[{\]])")
"""Start of a JSON file of a command; `[` alone also starts a TOML table."""
LOOKED_AT = 4096
"""Number of bytes that identify the kind of a file."""
PART = re.compile(r"\.(.+)\.[0-9a-f]{8}\.partial(\.\w+)?")
"""Name of the part of a file that is being written, see `whole`."""


def write(text: str, file: str | Path) -> None:
    """Write a text to a file, or to stdout for `-`."""
    if file == "-":
        print(text, end="", flush=True)
        return
    with whole(Path(file)) as part:
        part.write_text(text, encoding="utf-8")


def check_text(option: str, file: str | Path, kind: str, beginning: re.Pattern[bytes]) -> None:
    """Check before a long run that a text can be written and replaces only a text that begins as its kind.

    `option` names the file in messages; `-` is stdout.
    """
    path = Path(file)
    if file == "-":
        return
    check_folder(path)
    if not path.is_file():
        return
    with naming(path), path.open("rb") as stream:
        there = stream.read(LOOKED_AT)
    if there and not beginning.match(there):
        problem = f"`{option}` `{file}` would overwrite a file that is not {kind}"
        raise CosimError(problem, "Choose another name, or remove the file.")


def check_folder(file: Path) -> None:
    """Check before a long run that the folder of a file exists."""
    if not file.absolute().parent.is_dir():
        raise CosimError(f"cannot write `{file}`: the folder `{file.absolute().parent}` does not exist")


def check_apart(files: Mapping[str, Path | None]) -> None:
    """Check that the files of different options are different."""
    seen: dict[str, str] = {}
    for option, file in files.items():
        if file is None:
            continue
        other = seen.setdefault(os.path.realpath(file), option)
        if other != option and not is_device(file):
            problem = f"`{other}` and `{option}` name the same file `{file}`"
            raise CosimError(problem, "Give each option its own file.")


def is_device(file: Path) -> bool:
    """Whether a path is a device, such as `/dev/null`."""
    return file.exists() and not file.is_file()


@contextlib.contextmanager
def whole(file: Path) -> Iterator[Path]:
    """Temporary path that becomes `file` at the end, so that `file` is always complete.

    Its name is unique and keeps the ending. A process that starts another one to write the file passes it the
    temporary path, which is then written directly: whatever becomes of the other process, no partial file
    remains. A link stays a link: its target is written. A device is written directly. After any exception no
    partial file remains.
    """
    target = Path(os.path.realpath(file))
    part = target.with_name(f".{target.stem}.{os.urandom(4).hex()}.partial{target.suffix}")
    with naming(file):
        if is_device(target) or PART.fullmatch(target.name):
            yield file
            return
        if target.exists() and not os.access(target, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
        part.touch(exist_ok=False)
        try:
            with contextlib.suppress(OSError):
                shutil.copymode(target, part)
            yield part
            part.replace(target)
        finally:
            part.unlink(missing_ok=True)


@contextlib.contextmanager
def whole_if(file: Path | None) -> Iterator[Path | None]:
    """As `whole`; nothing for None."""
    with contextlib.nullcontext() if file is None else whole(file) as part:
        yield part


def refused(file: str | Path, error: OSError, hint: str = "") -> CosimError:
    """Error of a file that cannot be written; a part is named as the file that it becomes."""
    path = Path(file)
    file = path.with_name(PART.sub(r"\1\2", path.name)) if PART.fullmatch(path.name) else file
    return CosimError(f"cannot write `{file}`: {error.strerror or error}", hint)


@contextlib.contextmanager
def naming(file: str | Path, hint: str = "") -> Iterator[None]:
    """Convert a system error into one that names the file."""
    try:
        yield
    except OSError as error:
        raise refused(file, error, hint) from None
