"""What the table of steps says of overlaps: how deep and how much, where all of a step have been worked out."""

from __future__ import annotations

from typing import Any

import numpy as np
import pyarrow as pa

NAMES = ("penetration", "volume")


def no_contact_columns(n_steps: int) -> dict[str, pa.Array]:
    """The columns where nothing has been worked out."""
    return {name: pa.nulls(n_steps, pa.float64()) for name in NAMES}


def contact_columns(contacts: Any, block: slice) -> dict[str, pa.Array]:
    """Of each step the penetration of the deepest pair and the volume of all; null unless all are worked out.

    Args:
        contacts: a `ContactRows`.
    """
    n_steps = block.stop - block.start
    depth, volume = np.zeros((2, n_steps))
    n_open = np.zeros(n_steps, dtype=np.int64)
    steps, numbers = contacts.numbers_between(block.start, block.stop)
    at = steps - block.start
    np.add.at(n_open, at, 1)
    known = ~np.isnan(numbers["penetration"])
    np.subtract.at(n_open, at[known], 1)
    np.maximum.at(depth, at[known], numbers["penetration"][known])
    np.add.at(volume, at[known], numbers["volume"][known])
    none = n_open > 0
    none[np.setdiff1d(np.arange(n_steps), at)] = True
    return {"penetration": pa.array(depth, mask=none), "volume": pa.array(volume, mask=none)}


def with_contact_columns(steps: pa.Table, contacts: Any, first: int = 0) -> pa.Table:
    """A table of steps, its row 0 the step `first`, with these columns filled in."""
    if not len(contacts):
        return steps
    for name, column in contact_columns(contacts, slice(first, first + steps.num_rows)).items():
        at = steps.schema.get_field_index(name)
        steps = steps.append_column(name, column) if at < 0 else steps.set_column(at, name, column)
    return steps
