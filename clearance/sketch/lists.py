"""The flat lists behind a sketch: numbers of entities, rows of equations, ends of lines.

The tables that a solve works on are made of them (`problem`). Not for: names and checks.
"""

from __future__ import annotations

from array import array
from collections.abc import Set

import numpy as np

from clearance.sketch.constraints import Constraint
from clearance.sketch.entities import Line
from clearance.sketch.rows import Row, runs_along

DRAWN, TOGETHER, ALONE, AGAIN = 0, 1, 2, 3
"""Ranks of rows: how an entity is drawn; of a constraint with several rows; with one; what often follows from
others."""


class FlatLists:
    """The solver's input: one entry a variable, a line, a row or a constraint.

    Attributes:
        numbers: the value of every variable, counted from the origin.
        roles: the role of every variable (`clearance.sketch.graph.graph`).
        line_ends: three numbers a line: its variable and those of its two points (-1: none).
        rows: the equations.
        owners, ranks: the constraint (by index) and the rank of every row.
        constraints: every constraint by its index.
        together: the constraint (by index) of every pair of points that coincide.
    """

    def __init__(self) -> None:
        self.numbers: list[float] = []
        self.roles = array("q")
        self.line_ends = array("q")
        self.rows: list[Row] = []
        self.owners = array("q")
        self.ranks = array("q")
        self.constraints: list[Constraint] = []
        self.together: list[int] = []
        self._origin: tuple[float, float] | None = None

    @property
    def origin(self) -> np.ndarray:
        """(2,) [m] what the numbers are counted from: the first place that was drawn."""
        return np.array(self._origin or (0.0, 0.0))

    def local(self, x: float, y: float) -> tuple[float, float]:
        """A drawn place as counted from the origin, so that no digits go to where a sketch lies."""
        if self._origin is None:
            self._origin = (x, y)
        return x - self._origin[0], y - self._origin[1]

    def append_numbers(self, *pairs: tuple[float, int]) -> int:
        """Appends numbers with their roles; the first one's place."""
        first = len(self.numbers)
        for number, role in pairs:
            self.numbers.append(float(number))
            self.roles.append(role)
        return first

    def append_rows(self, constraint: Constraint, rows: list[Row]) -> None:
        """Appends a constraint's equations; coincident points are listed apart."""
        self.rows += rows
        for row in rows:
            self.owners.append(constraint.index)
            rank = ALONE if len(rows) == 1 else TOGETHER
            self.ranks.append(DRAWN if constraint.built_in else (AGAIN if row.again else rank))
        constraint.valency = len(rows)
        points = constraint.kind == "coincident" and constraint.entities[0].what == "point"
        if points or constraint.kind == "concentric":
            self.together.append(constraint.index)

    def dimensions(self) -> np.ndarray:
        """(constraints,) the dimension of every constraint; 0 for those without."""
        return np.nan_to_num([c.number for c in self.constraints])

    def sides(self, chosen: Set[int] | None = None) -> list[tuple[int, int, int]]:
        """The variables of every `same_side` (of the chosen constraints by index): two points, a line."""
        return [
            (p.variable, q.variable, line.variable)
            for p, q, line in (
                c.entities
                for c in self.constraints
                if c.kind == "same_side" and not c.driven and (chosen is None or c.index in chosen)
            )
        ]

    def angles(self) -> list[Constraint]:
        """The constraints that give an angle."""
        return [c for c in self.constraints if c.kind == "angle" and not c.driven]

    def reversed_angles(self, before: np.ndarray, after: np.ndarray) -> list[int]:
        """The angles (by index) of a line whose points are in the opposite order along it, (n,) against (n,)."""
        x, y = before.tolist(), after.tolist()
        return [
            angle.index
            for angle in self.angles()
            if any(
                runs_along(x, line) != runs_along(y, line)
                for line in angle.entities
                if isinstance(line, Line)
            )
        ]
