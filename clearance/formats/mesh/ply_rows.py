"""What a PLY header announces, and what is read for it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np


class Property(NamedTuple):
    """A number of each row, or a list of them: the type of its length is then given as well."""

    name: str
    kind: np.dtype
    length_kind: np.dtype | None


class Element(NamedTuple):
    """One kind of row, as the header announces it."""

    name: str
    n_rows: int
    properties: list[Property]


class PlyRows(NamedTuple):
    """All rows of one element.

    Attributes:
        n_rows: how many there are.
        columns: (n,) the values of each property.
        lists: for each list property all values, one row after the other, and (n,) how many each row has.
    """

    n_rows: int
    columns: dict[str, np.ndarray]
    lists: dict[str, tuple[np.ndarray, np.ndarray]]
