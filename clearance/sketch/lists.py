"""The flat lists behind a sketch: numbers of entities, rows of equations, ends of lines.

Typed arrays, so that a solve starts without walking over objects. Not for: names and checks.
"""

from __future__ import annotations

import math
from array import array
from collections.abc import Iterable

import numpy as np

from clearance.sketch.constraints import Constraint
from clearance.sketch.rows import Row

DRAWN, TOGETHER, ALONE, AGAIN = 0, 1, 2, 3
"""Ranks of rows: how an entity is drawn; of a constraint with several rows; with one; what often follows from
others."""


class FlatLists:
    """What the solver reads: one entry a variable, a line, a row or a constraint."""

    def __init__(self) -> None:
        self._numbers: list[float] = []
        self._origin: tuple[float, float] | None = None
        self._roles = array("q")
        self._line_ends = array("q")
        self._codes = array("q")
        self._vars = array("q")
        self._coefs = array("d")
        self._scales = array("d")
        self._offsets = array("d")
        self._grounds = array("q")
        self._owners = array("q")
        self._ranks = array("q")
        self._ordered: list[Constraint] = []
        self._together: list[tuple[int, int]] = []

    @property
    def origin(self) -> np.ndarray:
        """(2,) [m] what the numbers are counted from: the first place that was drawn."""
        return np.array(self._origin or (0.0, 0.0))

    def _local(self, x: float, y: float) -> tuple[float, float]:
        """A drawn place as counted from the origin, so that no digits go to where a sketch lies."""
        if self._origin is None:
            self._origin = (x, y)
        return x - self._origin[0], y - self._origin[1]

    def _grow(self, *pairs: tuple[float, int]) -> int:
        """Takes in numbers with their roles; the first one's place."""
        first = len(self._numbers)
        for number, role in pairs:
            self._numbers.append(float(number))
            self._roles.append(role)
        return first

    def _append(self, constraint: Constraint, rows: Iterable[Row]) -> None:
        """Takes in a constraint's equations; coincident points are listed apart."""
        first, rows = len(self._codes), list(rows)
        for row in rows:
            self._codes.append(row.code)
            self._vars.extend(row.var + (-1,) * (8 - len(row.var)))
            self._coefs.extend(row.coef + (0.0,) * (4 - len(row.coef)))
            self._scales.append(row.scale)
            self._offsets.append(row.offset)
            self._grounds.append(row.ground)
            self._owners.append(constraint.index)
            rank = ALONE if len(rows) == 1 else TOGETHER
            self._ranks.append(DRAWN if constraint.built_in else (AGAIN if row.again else rank))
        constraint.n_rows = len(self._codes) - first
        points = constraint.kind == "coincident" and constraint.entities[0].what == "point"
        if constraint.n_rows and (points or constraint.kind == "concentric"):
            self._together.append((constraint.index, first))

    def _dimensions(self) -> list[float]:
        """The dimension of every constraint; 0 for those without."""
        return [0.0 if math.isnan(c.number) else c.number for c in self._ordered]
