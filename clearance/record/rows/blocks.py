"""Rows gone through a block at a time, so that memory does not grow with their number."""

from __future__ import annotations

from collections.abc import Iterator

BLOCK = 2**16
"""Rows that are looked at together where all rows are gone through: 0.5 MB of each number."""


def blocks(n_rows: int) -> Iterator[slice]:
    """The rows in blocks of `BLOCK`; the last one is shorter."""
    for start in range(0, n_rows, BLOCK):
        yield slice(start, min(start + BLOCK, n_rows))
