"""Tables too long for memory: batches written to a file as they come, and mapped to be read as a table."""

from __future__ import annotations

import mmap
from collections.abc import Iterable
from pathlib import Path

import pyarrow as pa

from clearance.errors import unwritable


def mapped_table(batches: Iterable[pa.Table], path: Path) -> tuple[pa.Table, mmap.mmap]:
    """The batches as one table in the file `path`, and the mapping that it lies in.

    The file may be removed while the table is in use.

    Raises:
        Unwritable: there is no room for it.
    """
    with unwritable(path), pa.OSFile(str(path), "wb") as file:
        writer = None
        for batch in batches:
            writer = writer or pa.ipc.new_file(file, batch.schema)
            writer.write_table(batch)
        assert writer is not None  # a run has steps
        writer.close()
    with path.open("rb") as file:
        mapped = mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ)
    reader = pa.ipc.open_file(pa.BufferReader(pa.py_buffer(mapped)))
    return reader.read_all(), mapped
