"""Address and credentials of a Dask scheduler, checked before the connection."""

from __future__ import annotations

import json
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from cosim import paths
from cosim.errors import CosimError, closest

ADDRESS = re.compile(r"((tcp|tls|ws|wss)://)?([\w.-]+|\[[\da-fA-F:.%]+\]):\d{1,5}")
KEYS = ("address", "ca", "certificate", "key")
"""Keys of a security file: the scheduler address and PEM files."""


@dataclass(frozen=True)
class Scheduler:
    """Address of a scheduler, and its TLS files; empty without TLS."""

    address: str
    tls: Mapping[str, str]


def scheduler(text: str) -> Scheduler:
    """Scheduler from the argument of the user.

    Parameters
    ----------
    text
        `tls://HOST:PORT`, `tcp://HOST:PORT` or `HOST:PORT`; a scheduler file (`*.json`), as `dask scheduler
        --scheduler-file` writes it; or a security file (`*.toml`) with `address`, `ca`, `certificate` and
        `key`, the last three being PEM files relative to it.

    Raises
    ------
    CosimError
        It is not one of these.
    """
    if text.endswith(".json"):
        found = str(read(text, json.loads).get("address", ""))
        return Scheduler(checked(found, f"`address` in `{text}`"), {})
    if text.endswith(".toml"):
        return secured(text, read(text, tomllib.loads))
    return Scheduler(checked(text, "the Dask scheduler"), {})


def checked(address: str, what: str) -> str:
    """Address in valid form."""
    if not ADDRESS.fullmatch(address):
        hint = "Give `tcp://HOST:8786`, a scheduler file `*.json` or a security file `*.toml`."
        raise CosimError(f"{what} is `{address}`, which is not an address", hint)
    return address


def read(name: str, parse: Any) -> dict[str, Any]:
    """Table in a file."""
    try:
        found = parse(Path(name).read_text(encoding="utf-8"))
    except OSError as error:
        raise CosimError(f"cannot read `{name}`: {error.strerror or error}") from None
    except ValueError as error:
        raise CosimError(f"`{name}` is not a file of a Dask scheduler: {error}") from None
    if not isinstance(found, dict):
        raise CosimError(f"`{name}` is not a file of a Dask scheduler: it is not a JSON object")
    return found


def secured(name: str, table: dict[str, Any]) -> Scheduler:
    """Scheduler of a security file."""
    for key in table:
        if key not in KEYS:
            raise CosimError(f"`{name}`: `{key}` is not a known key", closest(key, KEYS))
    for key in KEYS:
        if not isinstance(table.get(key), str):
            raise CosimError(f"`{name}`: `{key}` is missing or not a text", f"Give {', '.join(KEYS)}.")
    address = checked(table["address"], f"`address` in `{name}`")
    if not address.startswith(("tls://", "wss://")):
        raise CosimError(
            f"`{name}`: `address` is `{address}`, which is not encrypted", "Use `tls://HOST:8786`."
        )
    files = {key: Path(name).absolute().parent / table[key] for key in KEYS[1:]}
    for key, file in files.items():
        if not file.is_file():
            raise CosimError(f"`{name}`: `{key}` is `{paths.shown(file)}`, which does not exist")
    return Scheduler(address, {key: str(file) for key, file in files.items()})
