"""Traces as Parquet: written in blocks during a run, read column by column.

A column is a field of 64-bit numbers whose metadata holds `units`, `descriptions` and, as JSON, `items`. The
metadata of the file hold the facts of the run as JSON, `cosim`, and `simulated_s`.
"""

from __future__ import annotations

import contextlib
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np
import pyarrow
from pyarrow import parquet

from cosim import paths
from cosim.closing import Closing
from cosim.errors import CosimError
from cosim.formatting import strict
from cosim.trace.columns import Array, Columns
from cosim.trace.stored import LABELS, StoredTrace, facts, with_labels
from cosim.writing import whole

BLOCK = 1 << 25
"""Maximum bytes of a block of rows, which a run holds in memory."""
ROWS = 65_536
"""Maximum rows of a block."""
FACTS, END = "cosim", "simulated_s"


class Writer(Closing):
    """Parquet file that is written in blocks; `about` is the metadata of columns and run."""

    def __init__(self, stream: BinaryIO, names: Sequence[str], about: dict[str, Any]) -> None:
        self.rows = max(1, min(ROWS, BLOCK // (8 * len(names))))
        known = {FACTS: strict.line({name: fact for name, fact in facts(about).items() if name != END})}
        self.schema = pyarrow.schema([field(name, about) for name in names], known)
        options = {"compression": "zstd", "use_dictionary": False, "use_byte_stream_split": True}
        self.writer = parquet.ParquetWriter(stream, self.schema, **options)

    def write(self, columns: Sequence[Array]) -> None:
        """Write rows, given by their columns."""
        arrays = [values(np.ascontiguousarray(column, dtype=np.float64)) for column in columns]
        self.writer.write_table(pyarrow.Table.from_arrays(arrays, schema=self.schema), self.rows)

    def finish(self, simulated: float) -> None:
        """Write the simulated time, s, and end the file."""
        self.writer.add_key_value_metadata({END: repr(simulated)})
        self.close()

    def close(self) -> None:
        """End the file without the simulated time."""
        self.writer.close()


@contextlib.contextmanager
def streaming(file: Path, names: Sequence[str], about: dict[str, Any]) -> Iterator[Writer]:
    """Writer of a file that exists only after all rows were written without an error."""
    with whole(file) as part, part.open("wb") as stream, Writer(stream, names, about) as writer:
        yield writer


def field(name: str, about: dict[str, Any]) -> Any:
    """Field of a column with its metadata."""
    of_it = {label: about[label][name] for label in LABELS if about.get(label, {}).get(name)}
    texts = {label: value if isinstance(value, str) else strict.line(value) for label, value in of_it.items()}
    return pyarrow.field(name, pyarrow.float64(), nullable=False, metadata=texts)


def values(column: Array) -> Any:
    """Column from its memory, because `pyarrow.array` would import pandas, which takes as long as a run."""
    return pyarrow.Array.from_buffers(pyarrow.float64(), len(column), [None, pyarrow.py_buffer(column)])


class FileColumns(Mapping[str, Array]):
    """Columns of a file, each read on access and not cached."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.file = parquet.ParquetFile(path)
        self.names = list(self.file.schema_arrow.names)

    def __getitem__(self, name: str) -> Array:
        if name not in self.names:
            raise KeyError(name)
        column = np.empty(self.file.metadata.num_rows)
        row = 0
        try:
            for group in range(self.file.num_row_groups):
                values = self.file.read_row_group(group, [name])[name].cast(pyarrow.float64())
                column[row : row + len(values)] = values.to_numpy()
                row += len(values)
        except (pyarrow.ArrowException, OSError) as error:
            problem = " ".join(str(error).split())
            raise CosimError(f"cannot read `{name}` in `{paths.shown(self.path)}`: {problem}") from None
        return column

    def __iter__(self) -> Iterator[str]:
        return iter(self.names)

    def __len__(self) -> int:
        return len(self.names)


def write(columns: Columns, about: dict[str, Any], stream: BinaryIO) -> None:
    """Write a complete trace."""
    with Writer(stream, list(columns), about) as writer:
        writer.write(list(columns.values()))
        writer.finish(about[END])


def read(path: Path) -> StoredTrace:
    """Open a file."""
    data = FileColumns(path)
    names = data.names
    if not all(names) or len(set(names)) != len(names):
        raise ValueError("its columns must have names, each once")
    known = {key.decode(): value.decode() for key, value in (data.file.metadata.metadata or {}).items()}
    about: Any = json.loads(known.get(FACTS, "{}"))
    if not isinstance(about, dict):
        raise ValueError(f"its metadata `{FACTS}` is not a table")
    if END in known:
        about[END] = float(known[END])
    labels = {one.name: one.metadata or {} for one in data.file.schema_arrow}
    for label in LABELS:
        texts = {name: known[label.encode()] for name, known in labels.items() if label.encode() in known}
        read_text: Any = json.loads if label == "items" else bytes.decode
        about[label] = {name: read_text(text) for name, text in texts.items()}
    return with_labels(path, data, about)
