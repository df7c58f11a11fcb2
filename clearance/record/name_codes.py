"""Columns of names as codes, and back.

Few rows are gone through one by one: pyarrow's own functions for it take longer to be imported.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import repeat

import numpy as np
import pyarrow as pa

FEW = 100_000
"""Rows that take less time one by one than the import of `pyarrow.compute` does."""

_AT_ONCE = 4096
"""Rows whose names are in memory at a time."""


def names_of(codes: np.ndarray, names: Sequence[str]) -> pa.Array:
    """(n,) the name of each code, null where that is negative."""
    if len(codes) < FEW:
        known = [*names, None]  # of which -1 is the last
        places = np.maximum(codes, -1).tolist()
        return pa.array([*map(known.__getitem__, places)], type=pa.string())
    return pa.array(names, type=pa.string()).take(pa.array(codes, mask=codes < 0))


def codes_of(column: pa.Array | pa.ChunkedArray, names: Sequence[str]) -> np.ndarray:
    """(n,) int64 which of the names each is; -1 where it is none of them or null."""
    if len(column) < FEW:
        place = {name: code for code, name in enumerate(names)}
        found = np.empty(len(column), dtype=np.int64)
        for start in range(0, len(column), _AT_ONCE):
            part = column.slice(start, _AT_ONCE).to_numpy(zero_copy_only=False).tolist()
            found[start : start + _AT_ONCE] = [*map(place.get, part, repeat(-1))]
        return found
    import pyarrow.compute

    places = pyarrow.compute.index_in(column, pa.array(names, type=pa.string())).fill_null(-1)
    return places.to_numpy().astype(np.int64)
