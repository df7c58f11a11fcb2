"""The freedoms of some vertices as columns: equations by them, their derivatives, and steps.

A body's members share three columns, a shift and a turn about the mean of its points. They move rigidly, so that
equations that are true inside it stay true. Places may be given several at once: numbers (..., n).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import coo_array, csc_array

from clearance.sketch.graph.graph import POINT, SLIDE, TURN
from clearance.sketch.solve.system import System


class Columns:
    """Some vertices, and some equations, by the vertices' freedoms.

    Args:
        system: equations and vertices.
        vertices: those that may move.
        rows: (m,) the equations; all by default.
        body_of: (v,) the body that a vertex is moved with, -1 for none.

    Attributes:
        first: (v,) the first column of every vertex (of its body, if it has one), -1 for those that stay.
        n: how many columns there are.
        single: the vertices outside bodies. turns: the columns of the bodies' turns.
        points, merged: the numbers of single points, and the merged ones of other single vertices; `at_points`,
            `at_merged`: their columns; `root`: the number that stands for each merged one.
    """

    def __init__(
        self,
        system: System,
        vertices: np.ndarray,
        rows: np.ndarray,
        body_of: np.ndarray | None = None,
    ) -> None:
        self.system, self.vertices, self.rows = system, np.asarray(vertices), np.asarray(rows)
        self.equations = system.rows(self.rows)
        mine = np.full(self.vertices.size, -1) if body_of is None else body_of[self.vertices]
        single = self.vertices[mine < 0]
        widths = np.where(system.kind[single] == POINT, 2, 1)
        self.first = np.full(system.kind.size, -1)
        self.first[single] = np.cumsum(widths) - widths
        self.n = int(widths.sum())
        self._bodies = _Bodies(system, self.vertices[mine >= 0], mine[mine >= 0], self.n)
        self.first[self._bodies.vertices] = self._bodies.first
        self.n += 3 * self._bodies.count
        self.single = single
        self.turns = self._bodies.begin + 3 * np.arange(self._bodies.count) + 2
        self._number(single)

    def _number(self, single: np.ndarray) -> None:
        """The columns and factors of the single vertices' numbers, and of all equations' entries."""
        s = self.system
        points = s.root[single[s.kind[single] == POINT]]
        self.points = np.concatenate([points, points + 1])
        own = np.zeros(s.kind.size, bool)
        own[single] = True
        own &= s.kind != POINT
        self.merged = s.member[own[s.vertex_of[s.member]]]
        column = np.full((s.vertex_of.size, 3), -1)
        factor = np.zeros((s.vertex_of.size, 3))
        at = self.first[s.vertex_of[points]]
        column[points, 0], column[points + 1, 0] = at, at + 1
        column[self.merged, 0] = self.first[s.vertex_of[self.merged]]
        factor[self.points, 0] = 1.0
        factor[self.merged, 0] = s.scale[self.merged]
        column[self._bodies.variables] = self._bodies.columns
        self._column, self._factor = column, factor
        self.at_points, self.at_merged = column[self.points, 0], column[self.merged, 0]
        self.root = s.root[s.vertex_of[self.merged]]

    @cached_property
    def _entries(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """(flat slots, their numbers, which of three factors) of every entry of the derivative."""
        var = self.system.var[self.rows].ravel()
        known = np.flatnonzero(var >= 0)
        slot, which = np.nonzero(self._column[var[known]] >= 0)
        return known[slot], var[known][slot], which

    @cached_property
    def pattern(self) -> tuple[np.ndarray, np.ndarray]:
        """(rows, columns) of the entries of the derivative; repeated entries add up."""
        slot, number, which = self._entries
        return slot // 8, self._column[number, which]

    @cached_property
    def pairs(self) -> tuple[np.ndarray, np.ndarray]:
        """Every two entries of one equation, in both orders."""
        count = np.bincount(self.pattern[0], minlength=self.rows.size)
        begin, many = np.cumsum(count) - count, count**2
        within = np.arange(many.sum()) - np.repeat(np.cumsum(many) - many, many)
        width, start = np.repeat(count, many), np.repeat(begin, many)
        return start + within // width, start + within % width

    def errors(self, x: np.ndarray) -> np.ndarray:
        """(..., m) the residuals."""
        return self.equations.errors(x)

    def entries(self, x: np.ndarray) -> np.ndarray:
        """(..., entries) the values of the derivative's entries; see `pattern`."""
        slot, number, which = self._entries
        slopes = self.equations.slopes(x)
        slopes = slopes.reshape(*x.shape[:-1], -1)[..., slot]
        if not self._bodies.count:
            return slopes * self._factor[number, which]
        return slopes * self._bodies.factors(self._factor, x)[..., number, which]

    def matrix(self, x: np.ndarray) -> np.ndarray:
        """(..., m, n) the derivative."""
        row, column = self.pattern
        m, value = self.rows.size, self.entries(x)
        count = int(np.prod(x.shape[:-1]))
        at = (np.arange(count)[:, None] * (m * self.n) + (row * self.n + column)).ravel()
        out = np.bincount(at, value.ravel(), count * m * self.n)
        return out.reshape(*x.shape[:-1], m, self.n)

    def sparse(self, x: np.ndarray) -> csc_array:
        """(m, n) the derivative as a sparse matrix."""
        return coo_array((self.entries(x), self.pattern), (self.rows.size, self.n)).tocsc()

    def bent(self, x: np.ndarray, weights: np.ndarray) -> np.ndarray:
        """The second derivative of the weighted equations at numbers (n,), by pairs of entries; see `pairs`.

        For columns of single vertices only.
        """
        curved, (place, factor) = self.equations.curvatures(x), self._bends
        curved = (curved + curved.transpose(0, 2, 1)) * (0.5 * weights[:, None, None])
        return curved.ravel()[place] * factor

    @cached_property
    def _bends(self) -> tuple[np.ndarray, np.ndarray]:
        """(place among the second derivatives by slots, factor) of every pair."""
        (p, q), (slot, number, _) = self.pairs, self._entries
        factor = self._factor[number, 0]
        return slot[p] * 8 + slot[q] % 8, factor[p] * factor[q]

    def bend(self, x: np.ndarray, weights: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """The same as (rows, columns, values) of a matrix; repeated entries add up."""
        (p, q), (_, column) = self.pairs, self.pattern
        return column[p], column[q], self.bent(x, weights)

    def moved(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The numbers (..., n) after a step (..., columns)."""
        out, s = x.copy(), self.system
        out[..., self.points] += step[..., self.at_points]
        if self.merged.size:
            number = x[..., self.root] + step[..., self.at_merged]
            out[..., self.merged] = s.scale[self.merged] * number + s.shift[self.merged]
        if self._bodies.count:
            self._bodies.move(x, step, out)
        return out


class _Bodies:
    """Rigid bodies: their columns, the derivatives of their members' numbers by them, and their moves."""

    def __init__(self, s: System, vertices: np.ndarray, body: np.ndarray, begin: int) -> None:
        self.system, self.vertices = s, vertices
        known, place = np.unique(body, return_inverse=True)
        self.count = known.size
        self.first = begin + 3 * place
        of_vertex = np.full(s.kind.size, -1)
        of_vertex[vertices] = place
        chosen = vertices[s.kind[vertices] == POINT]
        self.x, self.of_x = s.root[chosen], of_vertex[chosen]
        mine = self.of_x == np.arange(self.count)[:, None]
        self._mean = mine / np.maximum(mine.sum(axis=1, keepdims=True), 1)
        mine = s.member[of_vertex[s.vertex_of[s.member]] >= 0]
        kind = s.kind[s.vertex_of[mine]]
        self.theta, self.d = mine[kind == TURN], mine[kind == SLIDE]
        self.of_theta, self.of_d = (of_vertex[s.vertex_of[i]] for i in (self.theta, self.d))
        self.variables = np.concatenate([self.x, self.x + 1, self.theta, self.d])
        of = np.concatenate([self.of_x, self.of_x, self.of_theta, self.of_d])
        self.columns = begin + 3 * of[:, None] + np.arange(3)
        self.begin = begin

    def pivots(self, x: np.ndarray) -> np.ndarray:
        """(..., bodies, 2) the mean of every body's points."""
        places = np.stack([x[..., self.x], x[..., self.x + 1]], axis=-1)
        return self._mean @ places

    def factors(self, plain: np.ndarray, x: np.ndarray) -> np.ndarray:
        """(..., n, 3) the derivatives of all numbers by their columns; `plain` are those of single vertices."""
        out = np.broadcast_to(plain, (*x.shape[:-1], *plain.shape)).copy()
        pivot, i = self.pivots(x), self.x
        away = x[..., i] - pivot[..., self.of_x, 0], x[..., i + 1] - pivot[..., self.of_x, 1]
        out[..., i, 0] = out[..., i + 1, 1] = 1.0
        out[..., i, 2], out[..., i + 1, 2] = -away[1], away[0]
        out[..., self.theta, 2] = 1.0
        s, c = np.sin(x[..., self.d - 1]), np.cos(x[..., self.d - 1])
        at = pivot[..., self.of_d, :]
        out[..., self.d, 0], out[..., self.d, 1] = -s, c
        out[..., self.d, 2] = -c * at[..., 0] - s * at[..., 1]
        return out

    def move(self, x: np.ndarray, step: np.ndarray, out: np.ndarray) -> None:
        """Turns and shifts the bodies exactly, from x into `out`."""
        s = self.system
        mine = step[..., self.begin :].reshape(*step.shape[:-1], self.count, 3)
        pivot, turn = self.pivots(x), mine[..., 2]
        goal = pivot + mine[..., :2]
        c, si = np.cos(turn)[..., self.of_x], np.sin(turn)[..., self.of_x]
        away = [x[..., self.x + k] - pivot[..., self.of_x, k] for k in (0, 1)]
        out[..., self.x] = goal[..., self.of_x, 0] + c * away[0] - si * away[1]
        out[..., self.x + 1] = goal[..., self.of_x, 1] + si * away[0] + c * away[1]
        number = x[..., s.root[s.vertex_of[self.theta]]] + turn[..., self.of_theta]
        out[..., self.theta] = s.scale[self.theta] * number + s.shift[self.theta]
        root = s.root[s.vertex_of[self.d]]
        before, at, to = x[..., root - 1], pivot[..., self.of_d, :], goal[..., self.of_d, :]
        after = before + turn[..., self.of_d]
        number = x[..., root] + np.sin(before) * at[..., 0] - np.cos(before) * at[..., 1]
        number = number + np.cos(after) * to[..., 1] - np.sin(after) * to[..., 0]
        out[..., self.d] = s.scale[self.d] * number + s.shift[self.d]
