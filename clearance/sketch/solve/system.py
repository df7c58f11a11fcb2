"""Equations and graph of a problem as flat arrays, and the same as lists for steps that go one by one."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.sketch.equations import KINDS, Rows


@dataclass(frozen=True, eq=False)
class System:
    """Equations (m,) and the vertices (v,) that their numbers (n,) belong to.

    Attributes:
        code, var, coef, value: the equations: kind, numbers (m, 8), coefficients (m, 4) and value.
        kind, root: kind and first number of every vertex.
        parent, scale, shift: (n + 1,) the merged numbers, see `graph.Merged`.
        member_start, member: the merged numbers of every vertex.
        vertex_of: the vertex of every number, -1 for none.
        ends: (m, 5) the vertices of every equation that is an edge, -1 pads.
    """

    code: np.ndarray
    var: np.ndarray
    coef: np.ndarray
    value: np.ndarray
    kind: np.ndarray
    root: np.ndarray
    parent: np.ndarray
    scale: np.ndarray
    shift: np.ndarray
    member_start: np.ndarray
    member: np.ndarray
    vertex_of: np.ndarray
    ends: np.ndarray

    def replaced(self, **arrays: np.ndarray) -> System:
        """The system with other arrays."""
        return replace(self, **arrays)

    def rows(self, chosen: np.ndarray) -> Rows:
        """Some equations, to be evaluated at once."""
        return Rows(self.code[chosen], self.var[chosen], self.coef[chosen], self.value[chosen])

    @cached_property
    def all_rows(self) -> Rows:
        """All equations."""
        return Rows(self.code, self.var, self.coef, self.value)

    @cached_property
    def plain(self) -> PlainSystem:
        """The same as lists."""
        return PlainSystem(self)


class PlainSystem:
    """A system as lists: single numbers are read and written ten times faster than in arrays.

    Attributes:
        equations: every equation, of the places of its numbers. coef, value: theirs.
        kind, root: kind and first number of every vertex. members: its merged numbers.
        scale, shift: the merged numbers, see `graph.Merged`.
    """

    def __init__(self, system: System) -> None:
        kinds = [KINDS[code] for code in system.code.tolist()]
        self.equations = [
            kind(*var[: len(kind._fields)])
            for kind, var in zip(kinds, system.var.tolist(), strict=True)
        ]
        self.coef, self.value = system.coef.tolist(), system.value.tolist()
        self.kind, self.root = system.kind.tolist(), system.root.tolist()
        self.scale, self.shift = system.scale.tolist(), system.shift.tolist()
        start, member = system.member_start.tolist(), system.member.tolist()
        self.members = [member[a:b] for a, b in zip(start[:-1], start[1:], strict=True)]

    def residual(self, row: int, x: list[float]) -> float:
        """The error of one equation."""
        places = self.equations[row]
        numbers = places._make([x[i] for i in places])
        return numbers.residual(math, self.coef[row], self.value[row])

    def holds(self, rows, x: list[float], tolerance: float) -> bool:
        """Whether some equations hold."""
        return all(abs(self.residual(row, x)) <= tolerance for row in rows)

    def assign(self, v: int, number: float, x: list[float]) -> None:
        """Sets a class of directions, offsets or radii: its root and every merged number."""
        for i in self.members[v]:
            x[i] = self.scale[i] * number + self.shift[i]
