"""A whole part solved from the drawing: least squares with exact second derivatives, sparse, any size.

The sum of squared errors goes down by Newton's method in a trust region. Two things set it apart from the damped
descent of numeric clusters (`solve.damped`): the second derivatives of the equations, which
lead away from where slivers lie flat, and corrections of second order, which follow the curved valleys that
slivers make, with the factors that are at hand. Not for: the other minima that it may end in (`folds`).
Sources: Conn, Gould, Toint 2000 (trust regions); Transtrum, Sethna 2012 (corrections of second order).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.sparse import coo_array, csc_array, eye_array
from scipy.sparse.linalg import splu

from clearance.sketch.problem import Problem
from clearance.sketch.solve.columns import Columns
from clearance.sketch.steps import FLOOR

LONGEST = 200
"""Steps of a descent; patches of 1000 slivered triangles take 30 to 140."""

CORRECTIONS = 3
"""Corrections of second order for a step: with none 3 to 5 times the steps, beyond 3 no more is gained."""

FIRST, LEAST = 1e-2, 1e-16
"""[-] Damping at the size 1: at first, and at least."""

FLAT = 1e-5
"""[-] Share of the sum that an undamped step must promise; less is a minimum."""


class Iterate(NamedTuple):
    """Numbers (n,), the equations' errors (m,) there, their derivative, and the sum of squared errors."""

    x: np.ndarray
    error: np.ndarray
    matrix: csc_array
    total: float


class ProblemPart:
    """The columns and equations of one part of a problem of a size near 1."""

    def __init__(self, problem: Problem, part: int) -> None:
        self.system, self.limit = problem.system, problem.limit
        self.vertices = np.flatnonzero(problem.part == part)
        chosen = (problem.row_part == part) & (problem.fate == 0)
        chosen[problem.plan.dependent] = False
        self.rows = np.flatnonzero(chosen)
        self.columns = Columns(problem.system, self.vertices, self.rows)
        self.first, self.n = self.columns.first, self.columns.n
        self.enough = self.rows.size * (FLOOR * problem.size) ** 2

    def at(self, x: np.ndarray) -> Iterate:
        """The equations at some numbers."""
        f = self.columns.errors(x)
        return Iterate(x, f, self.columns.sparse(x), float(f @ f))

    def moved(self, x: np.ndarray, step: np.ndarray) -> Iterate:
        """The equations after a step (n,) of the columns."""
        return self.at(self.columns.moved(x, step))

    def curvature(self, place: Iterate) -> csc_array:
        """(n, n) half the second derivative of the sum of squares."""
        i, j, value = self.columns.bend(place.x, place.error)
        bent = coo_array((value, (i, j)), (self.n, self.n)).tocsc()
        return (place.matrix.T @ place.matrix + 0.5 * (bent + bent.T)).tocsc()


def descend(
    part: ProblemPart,
    x: np.ndarray,
    damping: float = FIRST,
    longest: int = LONGEST,
    corrections: int = CORRECTIONS,
) -> Iterate:
    """Where the sum of squares ends that goes down from x: a root, or another minimum."""
    place = part.at(x)
    for _ in range(longest):
        if place.total <= part.enough:
            break
        part.limit.require_left()
        lower, damping, last = _step(part, place, damping, corrections)
        place = lower if lower.total < place.total else place
        if last:
            break
    return place


def _step(
    part: ProblemPart, place: Iterate, damping: float, corrections: int
) -> tuple[Iterate, float, bool]:
    """(a place that is lower, damping for the next step, whether this was the last one)."""
    curved, unit = part.curvature(place), eye_array(part.n, format="csc")
    slope = place.matrix.T @ place.error
    for _ in range(40):
        factor = _factored(curved + damping * unit)
        if factor is None:
            damping = max(4.0 * damping, 1e-12)
            continue
        step = -factor.solve(slope)
        promised = -float(2.0 * slope @ step + step @ (curved @ step))
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


def _factored(matrix):
    """The factors of a symmetric matrix, None when it is not positive definite: then a pivot is not."""
    try:
        factor = splu(
            matrix.tocsc(),
            permc_spec="MMD_AT_PLUS_A",
            diag_pivot_thresh=0.0,
            options={"SymmetricMode": True},
        )
    except RuntimeError:
        return None
    straight = np.array_equal(factor.perm_r, factor.perm_c)
    return factor if straight and (factor.U.diagonal() > 0.0).all() else None


def _corrected(
    part: ProblemPart, place: Iterate, step: np.ndarray, factor, corrections: int
) -> Iterate:
    """The place after a step, corrected for what the equations' curvature adds to it while that helps."""
    goal, length = place.error + place.matrix @ step, float(np.linalg.norm(step))
    best = part.moved(place.x, step)
    for _ in range(corrections):
        more = -factor.solve(place.matrix.T @ (best.error - goal))
        if not np.linalg.norm(more) <= length:
            break
        nearer = part.moved(best.x, more)
        if not nearer.total < best.total:
            break
        best = nearer
    return best
