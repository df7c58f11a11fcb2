"""Rows of steps written down by hand, in lists."""

from __future__ import annotations

import numpy as np

from clearance.record.table import Names, Table


def rows_of(columns: dict[str, list]) -> Table:
    """The table with these columns, of numbers or of names."""
    return Table({name: _column(values) for name, values in columns.items()})


def _column(values: list) -> np.ndarray | Names:
    if not isinstance(values[0], str):
        return np.array(values)
    names = list(dict.fromkeys(values))
    return Names(np.array([names.index(value) for value in values]), names)
