"""Results of a scenario as hashes: one of each column of the trace and one of the end state of the plant."""

from __future__ import annotations

import json
import logging
import platform
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass
from fnmatch import fnmatchcase
from hashlib import blake2b
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

import cosim
from cosim.errors import CosimError
from cosim.paths import list_scenarios

FILE = Path(__file__).with_name("recording.json")
FORMAT = 1


@dataclass(frozen=True)
class Recorded:
    """Hashes of one run: of MuJoCo's integration state after the last step and of every column of the trace.

    A column of an enumeration is `<hash>:<item>,<item>`, see `enumeration`.
    """

    state: str
    columns: dict[str, str]


@dataclass(frozen=True)
class Recording:
    """Hashes of many scenarios by name, and versions of other software that affects the bits."""

    made_with: dict[str, str]
    scenarios: dict[str, Recorded]


def digest(values: NDArray[Any]) -> str:
    """Hash of type and bytes of an array: -0.0 is not 0.0."""
    values = np.ascontiguousarray(values)
    return blake2b(values.dtype.str.encode() + values.tobytes(), digest_size=8).hexdigest()


def enumeration(values: NDArray[Any], items: dict[str, int]) -> str:
    """Hash of a column of items, each numbered by its first appearance, then their names in that order.

    So the numbers of the items may change, and their names under a map; the sequence may not.
    """
    found, first, inverse = np.unique(values, return_index=True, return_inverse=True)
    order = np.argsort(first)
    appearance = np.argsort(order)
    names = {float(number): name for name, number in items.items()}
    seen = ",".join(names.get(number, str(number)) for number in found[order].tolist())
    return f"{digest(appearance[inverse].astype(np.int64))}:{seen}"


def record(name: str) -> Recorded:
    """Run a scenario by the native engine.

    Raises
    ------
    CosimError
        The run failed.
    """
    with cosim.Session(cosim.load(name), engine="native") as session:
        result = session.run()
        plant: Any = session.plant
    if result.trace is None or result.engine != "native":
        raise CosimError(f"`{name}` did not run in the native engine")
    kind = mujoco.mjtState.mjSTATE_INTEGRATION
    state = np.zeros(mujoco.mj_stateSize(plant.model, kind))
    mujoco.mj_getState(plant.model, plant.data, state, kind)
    columns = {
        column: enumeration(result.trace[column], result.items[column])
        if column in result.items
        else digest(result.trace[column])
        for column in result.trace.dtype.names or ()
    }
    return Recorded(digest(state), columns)


def record_or_error(name: str) -> Recorded | str:
    """Run a scenario; return the text of an error."""
    try:
        return record(name)
    except CosimError as error:
        return str(error)


def record_all(names: Sequence[str], jobs: int | None) -> Iterator[tuple[str, Recorded | str]]:
    """Record scenarios in parallel processes, in the order of their names."""
    # many scenarios simulate faults, with many messages
    with ProcessPoolExecutor(jobs, initializer=logging.disable) as pool:
        yield from zip(names, pool.map(record_or_error, names), strict=True)


def selected(names: Iterable[str], patterns: Sequence[str]) -> list[str]:
    """Names that match one of the patterns, all without a pattern."""
    return [name for name in names if not patterns or any(fits(name, pattern) for pattern in patterns)]


def fits(name: str, pattern: str) -> bool:
    """Whether a scenario matches a pattern: `dob` has all variants, `dob/pa*` some of them."""
    return fnmatchcase(name if "/" in pattern else name.partition("/")[0], pattern)


def scenario_names() -> list[str]:
    """Names of all scenario files."""
    return [name for name, _ in list_scenarios()]


def made_with() -> dict[str, str]:
    """Versions of other software that affects the bits: libm computes sines and powers."""
    return {
        "machine": f"{platform.system()} {platform.machine()}",
        "libm": " ".join(platform.libc_ver()),
        "mujoco": mujoco.mj_versionString(),
        "numpy": np.__version__,
    }


def read(file: Path = FILE) -> Recording:
    """Read a recording of the current format."""
    content = json.loads(file.read_text(encoding="utf-8"))
    if content["format"] != FORMAT:
        raise CosimError(
            f"`{file}` is of format {content['format']}, not {FORMAT}", "record again with `--write`"
        )
    scenarios = {name: Recorded(**recorded) for name, recorded in content["scenarios"].items()}
    return Recording(content["made_with"], scenarios)


def write(recording: Recording, file: Path = FILE) -> None:
    """Write a recording, one line per scenario."""
    lines = [
        f"{json.dumps(name)}: {json.dumps(asdict(recorded))}"
        for name, recorded in sorted(recording.scenarios.items())
    ]
    head = f'{{\n"format": {FORMAT},\n"made_with": {json.dumps(recording.made_with)},\n"scenarios": {{\n'
    file.write_text(head + ",\n".join(lines) + "\n}\n}\n", encoding="utf-8")
