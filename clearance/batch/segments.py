"""A segment: the rows of some cases as one file, whose name says what is in it.

The name is the generation and the sha256 of the content, so that two writers never write different things in one
place, and what is damaged is found. Not for: the folder of all (`store`).
"""

from __future__ import annotations

import hashlib
import io
import re
from collections.abc import Sequence
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq

from clearance.batch.rows import STORED

_NAME = re.compile(r"^(\d{6})-([0-9a-f]{64})\.parquet$")


def segment_of(rows: Sequence[dict[str, Any]]) -> bytes:
    """The rows as a parquet file."""
    buffer = io.BytesIO()
    table = pa.Table.from_pylist(list(rows), schema=STORED)
    pq.write_table(
        table,
        buffer,
        compression="zstd",  # which finds what is said again, so that dictionaries only add to it
        use_dictionary=False,
        write_statistics=False,
        store_schema=False,
    )
    return buffer.getvalue()


def rows_in(content: bytes, columns: Sequence[str] | None = None) -> pa.Table:
    """The rows of a segment, or some columns of them."""
    wanted = None if columns is None else [*columns]
    return pq.ParquetFile(pa.BufferReader(content)).read(wanted, use_threads=False)


def name_of(content: bytes, generation: int) -> str:
    """The file's name."""
    return f"{generation:06d}-{hashlib.sha256(content).hexdigest()}.parquet"


def generation_of(name: str) -> int | None:
    """The generation of a segment by its name; None for what is no segment."""
    found = _NAME.match(name)
    return None if found is None else int(found[1])


def is_whole(name: str, content: bytes) -> bool:
    """True if the content is what the name says."""
    found = _NAME.match(name)
    return found is not None and hashlib.sha256(content).hexdigest() == found[2]
