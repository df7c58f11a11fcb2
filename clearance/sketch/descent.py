"""A whole part solved from the drawing: least squares with exact second derivatives, sparse, any size.

The sum of squared errors goes down by Newton's method in a trust region. Two things distinguish it from the damped
descent of numeric clusters (`solve.search`): the second derivatives of the equations, which
lead away from where slivers lie flat, and corrections of second order, which follow the curved valleys that
slivers make, with the factors that are at hand. Not for: the other minima that it may end in (`folds`).
Sources: Conn, Gould, Toint 2000 (trust regions); Transtrum, Sethna 2012 (corrections of second order).
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
from scipy.sparse import csc_array
from scipy.sparse.linalg import splu

from clearance.sketch.effort import OutOfTime
from clearance.sketch.problem import FLOOR, Problem
from clearance.sketch.solve.columns import Columns

LONGEST = 200
"""Steps of a descent; patches of 1000 slivered triangles need 30 to 140."""

CORRECTIONS = 3
"""Corrections of second order for a step: with none 3 to 5 times the steps, beyond 3 no more is gained."""

FIRST, LEAST = 1e-2, 1e-16
"""[-] Damping at the size 1: at first, and at least."""

FLAT = 1e-5
"""[-] Share of the sum that an undamped step must promise; less is a minimum."""


class Iterate:
    """Numbers (n,) of a part, the equations' errors (m,) there, and the sum of squared errors."""

    def __init__(self, columns: Columns, x: np.ndarray) -> None:
        self.columns, self.x, self.error = columns, x, columns.errors(x)
        self.total = float(self.error @ self.error)

    @cached_property
    def entries(self) -> np.ndarray:
        """The entries of the derivative; see `Columns.pattern`."""
        return self.columns.entries(self.x)

    def ahead(self, step: np.ndarray) -> np.ndarray:
        """(m,) how the errors change along a step (columns,) to the first order."""
        row, column = self.columns.pattern
        return np.bincount(row, self.entries * step[column], self.error.size)

    def slope(self, error: np.ndarray) -> np.ndarray:
        """(columns,) the derivative's transpose times some errors (m,)."""
        row, column = self.columns.pattern
        return np.bincount(column, self.entries * error[row], self.columns.n)


class ProblemPart:
    """The columns and equations of one part of a problem of a size near 1, in an order that factors well."""

    def __init__(self, problem: Problem, part: int) -> None:
        self.system, self.limit = problem.system, problem.limit
        self.rows, vertices = problem.independent_rows(part), problem.vertices_of(part)
        self.columns = Columns(problem.system, vertices, self.rows)
        if self.rows.size and self.columns.n:
            unit = self._matrix(np.zeros(self.columns.pairs[0].size), 1.0)
            place = splu(unit, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).perm_c
            order = np.argsort(place[self.columns.first[vertices]])
            del self._pattern
            self.columns = Columns(problem.system, vertices[order], self.rows)
        self.first, self.n = self.columns.first, self.columns.n
        self.enough = self.rows.size * (FLOOR * problem.size) ** 2

    @cached_property
    def _pattern(self) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """(place of every pair, indices and starts of columns, places of the diagonal) of the sparse matrix."""
        (p, q), (_, column), n = self.columns.pairs, self.columns.pattern, self.columns.n
        known, place = np.unique(
            np.append(column[q] * n + column[p], np.arange(n) * (n + 1)), return_inverse=True
        )
        starts = np.searchsorted(known, np.arange(n + 1) * n)
        return place[:-n], known % n, starts, place[-n:]

    def at(self, x: np.ndarray) -> Iterate:
        """The equations at some numbers."""
        return Iterate(self.columns, x)

    def moved(self, x: np.ndarray, step: np.ndarray) -> Iterate:
        """The equations after a step (n,) of the columns."""
        return self.at(self.columns.moved(x, step))

    def curvature(self, place: Iterate) -> np.ndarray:
        """Half the second derivative of the sum of squares, by pairs of entries."""
        p, q = self.columns.pairs
        return place.entries[p] * place.entries[q] + self.columns.bent(place.x, place.error)

    def factored(self, curvature: np.ndarray, damping: float):
        """The factors of a curvature with damping on its diagonal, None when it is not positive definite."""
        try:
            factor = splu(
                self._matrix(curvature, damping),
                permc_spec="NATURAL",
                diag_pivot_thresh=0.0,
                relax=4,
                options={"SymmetricMode": True},
            )
        except RuntimeError:
            return None
        straight = np.array_equal(factor.perm_r, factor.perm_c)
        return factor if straight and (factor.U.diagonal() > 0.0).all() else None

    def _matrix(self, curvature: np.ndarray, damping: float) -> csc_array:
        place, indices, starts, diagonal = self._pattern
        data = np.bincount(place, curvature, indices.size)
        data[diagonal] += damping
        return csc_array((data, indices, starts), (self.columns.n, self.columns.n))


def descend(
    part: ProblemPart,
    x: np.ndarray,
    damping: float = FIRST,
    longest: int = LONGEST,
    corrections: int = CORRECTIONS,
) -> Iterate:
    """The end of a descent of the sum of squares from x: a root, or another minimum.

    Raises:
        OutOfTime: with the numbers that it had come to.
    """
    place = part.at(x)
    for _ in range(longest):
        if place.total <= part.enough:
            break
        if part.limit.is_over():
            raise OutOfTime(place.x)
        lower, damping, last = _step(part, place, damping, corrections)
        place = lower if lower.total < place.total else place
        if last:
            break
    return place


def _step(
    part: ProblemPart, place: Iterate, damping: float, corrections: int
) -> tuple[Iterate, float, bool]:
    """(a place that is lower, damping for the next step, whether this was the last one)."""
    curved, slope = part.curvature(place), place.slope(place.error)
    for _ in range(40):
        factor = part.factored(curved, damping)
        if factor is None:
            damping = max(4.0 * damping, 1e-12)
            continue
        step = -factor.solve(slope)
        promised = -float(slope @ step) + damping * float(step @ step)
        least = promised < FLAT * place.total and damping < 1e-13
        lower = _corrected(part, place, step, factor, corrections)
        if lower.total < place.total or least:
            return lower, _eased(damping, place.total - lower.total, promised, place.total), least
        damping = max(4.0 * damping, 1e-12)
    return place, damping, True


def _eased(damping: float, gained: float, promised: float, total: float) -> float:
    """The next damping, by how much of what a step promised it gained."""
    if gained < 0.25 * promised:
        return 2.0 * damping
    if gained <= 0.75 * promised:
        return damping
    return max(damping * (0.2 if promised > 0.01 * total else 0.05), LEAST)


def _corrected(
    part: ProblemPart, place: Iterate, step: np.ndarray, factor, corrections: int
) -> Iterate:
    """The place after a step, corrected for what the equations' curvature adds to it while that helps."""
    goal, length = place.error + place.ahead(step), float(np.linalg.norm(step))
    best = part.moved(place.x, step)
    for _ in range(corrections):
        more = -factor.solve(place.slope(best.error - goal))
        if not np.linalg.norm(more) <= length:
            break
        nearer = part.moved(best.x, more)
        if not nearer.total < best.total:
            break
        best = nearer
    return best
