"""Selects the columns of a table that a case names, and writes notes on column names.

Not for: how a header is written (`csv_table`), nor units (`column_units`).
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from clearance.errors import MissingKey, nearest_name
from clearance.formats.table.column_units import Column, columns_in, in_kind, with_time
from clearance.formats.table.csv_table import EMPTY, TIME
from clearance.world.notice import listed


def chosen_columns(
    header: Sequence[str],
    chosen: Mapping[str, str],
    turns: Mapping[str, bool],
    units: tuple[str, str] | None,
) -> list[Column]:
    """The columns of a header that a case names, with the case's names, in its order.

    Args:
        chosen: the column of the header for `time`, a joint, or a joint and `/velocity`; one that stands for
            itself is what its header says. turns, units: as `columns_in`.

    Raises:
        MissingKey: a column that is not in the header. BadInput, DuplicateName: as `columns_in`.
    """
    for name in chosen.values():
        if name not in header:
            raise MissingKey(
                f"there is no column {name!r}, which `columns` names",
                valid=nearest_name(name, header),
            )
    own = [name for name, given in chosen.items() if name == given]
    found = {one.header: one for one in with_time(columns_in(own, turns, units), turns)}
    for name, given in chosen.items():
        if name != given:
            found[name] = in_kind(given, name, turns, units)
    return [found[name] for name in chosen]


def notes_on_names(header: Sequence[str], columns: Sequence[Column]) -> list[str]:
    """Notes on the column read as time, and on columns that are not read."""
    notes = [
        f"column {one.header!r} is taken for time"
        for one in columns
        if one.name == TIME and not re.match(r"time\b|time_", one.header.lower())
    ]
    used = {one.header for one in columns}
    left = [repr(name) for name in header if name not in used and name != EMPTY]
    notes += [f"columns not read: {listed(left, 8)}"] if left else []
    notes += ["the empty column at the end is left out"] if EMPTY in header else []
    return notes
