"""What the table of steps says of overlaps: how deep and how much, where all of a step have been worked out."""

from __future__ import annotations

from typing import Any

import numpy as np

from clearance.record.table import Table


def contact_columns(contacts: Any, block: slice) -> dict[str, np.ndarray]:
    """Of each step the penetration of the deepest pair and the volume of all; NaN unless all are worked out.

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
    depth[none] = volume[none] = np.nan
    return {"penetration": depth, "volume": volume}


def with_contact_columns(steps: Table, contacts: Any, first: int = 0) -> Table:
    """A table of steps, its row 0 the step `first`, with these columns filled in."""
    if not len(contacts):
        return steps
    return steps.with_columns(contact_columns(contacts, slice(first, first + steps.n_rows)))
