"""A row as SQLite keeps it: figures as columns, lists as JSON, and a digest of all, by which damage is seen.

Not for: what a row says (`rows`), nor the database (`store`).
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from typing import Any

import pyarrow as pa

from clearance.batch.rows import VERDICT

_KINDS: dict[pa.DataType, tuple[str, type]] = {
    pa.string(): ("TEXT", str),
    pa.int8(): ("INTEGER", int),
    pa.int64(): ("INTEGER", int),
    pa.float64(): ("REAL", float),
}
"""Of a figure: the type of its column, and of its values."""

COLUMNS = ", ".join(
    f'"{field.name}" {_KINDS[field.type][0] if field.type in _KINDS else "TEXT"}'
    for field in VERDICT
)
"""The columns between the key and the digest, as SQL."""

N_VALUES = len(VERDICT) + 2

Stored = Sequence[Any]
"""Key, columns, digest."""


def stored(key: str, row: dict[str, Any]) -> Stored:
    """A row with the columns of `VERDICT` as it is stored."""
    return sealed((key, *(_value(field, row[field.name]) for field in VERDICT)))


def sealed(values: tuple[Any, ...]) -> Stored:
    """The values, and a digest of them."""
    return (*values, _digest(values))


def is_whole(row: Stored) -> bool:
    """True if values and digest are what was stored."""
    return bool(_digest(tuple(row[:-1])) == row[-1])


def read_row(row: Stored) -> dict[str, Any]:
    """The columns of a stored row, and its key."""
    values = {"key": row[0]}
    for field, value in zip(VERDICT, row[1:-1], strict=True):
        is_list = value is not None and field.type not in _KINDS
        values[field.name] = json.loads(value) if is_list else value
    return values


def _value(field: pa.Field, value: Any) -> Any:
    if value is None or value != value:  # SQLite has no NaN
        return None
    if field.type not in _KINDS:
        return json.dumps(value)
    read = _KINDS[field.type][1](value)
    return read or 0.0 if isinstance(read, float) else read  # nor a zero below zero


def _digest(values: tuple[Any, ...]) -> bytes:
    return hashlib.blake2b(repr(values).encode(), digest_size=16).digest()
