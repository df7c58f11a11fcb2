"""Least movement: the sketch nearest to the one drawn among all that satisfy the constraints.

Movement is the root of the summed squares of the points' shifts, the radii's changes and, for a
line drawn without points, its shift and turn at its foot (a turn counted as an arc at the sketch's
size). The optimum is found by Newton's method on the Lagrangian (sequential quadratic programming)
with a line search.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.linalg import splu

from clearance.sketch.graph.graph import DIRECTION, RADIUS
from clearance.sketch.problem import RESIDUAL, Problem
from clearance.sketch.solve.columns import Columns

DENSE = 160
"""Unknowns up to which the dense factorisation of the optimality system is the faster one
(measured)."""

WEAK = 1e-7
"""[-] Weight of lines that points carry: their own numbers do not count as movement."""


def least_movement(problem: Problem, part: int, x, target, weight, start=None) -> np.ndarray | None:
    """The numbers (n,) nearest to `target` with all equations of one part true; None when none was
    found.

    Args:
        x: numbers that satisfy the equations (or nearly); `start`, the sketch, is tried first.
        weight: (n,) how much each variable of a point counts.
    """
    best = _best(_Work(problem, part, target, weight), x, start)
    if best is None and problem.contacts is not None:  # it may lead to a line's other side
        plain = replace(problem, contacts=None)
        return _best(_Work(plain, part, target, weight), x, start)
    return best


def _best(work: _Work, x: np.ndarray, start: np.ndarray | None) -> np.ndarray | None:
    """The nearest of the optima that are found from x and from the sketch."""
    best, least = None, math.inf
    for origin in (x, start):
        if origin is None or (best is not None and work.n > DENSE // 2):
            continue
        found = work.optimum(origin.copy())
        if found is None or not work.holds(found):
            continue
        moved = work.movement(found)
        if moved < least * (1.0 - 1e-9):
            best, least = found, moved
    return best


def closed(problem: Problem, part: int, x: np.ndarray) -> np.ndarray | None:
    """The numbers (n,) next to a solution x at which the equations of a part hold to rounding, points of
    contact with them; None when there are none."""
    work = _Work(problem, part, x, problem.weight)
    found = work.restored(x)
    return found if found is not None and work.holds(found) else None


class _Work:
    """One part's columns and equations, and the movement's second derivative (n,), which is diagonal."""

    def __init__(self, problem: Problem, part: int, target: np.ndarray, weight: np.ndarray) -> None:
        self.system, self.problem, self.target = problem.regular, problem, target
        self.rows = problem.independent_rows(part)
        self.columns = Columns(self.system, problem.vertices_of(part), self.rows)
        self.n = self.columns.n
        self.bending = self._bending(weight)

    def _bending(self, weight: np.ndarray) -> np.ndarray:
        """(n,) how much the square of every column counts."""
        s, tables, columns, out = self.system, self.problem.tables, self.columns, np.zeros(self.n)
        share = np.where(tables.role == DIRECTION, self.problem.size**2, 1.0)
        share[tables.role == RADIUS] = self.problem.weight_of_radii
        theta = tables.line_ends[tables.line_ends[:, 1] >= 0, 0]
        share[theta] *= WEAK
        share[theta + 1] *= WEAK
        out[columns.at_points] = weight[s.root[s.vertex_of[columns.points]]]
        counted = share[columns.merged] * s.scale[columns.merged] ** 2
        return out + np.bincount(columns.at_merged, counted, self.n)

    def holds(self, x: np.ndarray) -> bool:
        """Whether the equations hold as they are counted: a contact may be regular on a line's other side."""
        if self.problem.contacts is None:
            return True
        error = self.problem.system.rows(self.rows).errors(x)
        return bool(np.abs(error).max(initial=0.0) <= RESIDUAL * self.problem.size)

    def offsets(self, x: np.ndarray) -> np.ndarray:
        """(n,) how far every column is from its target: merged numbers from their targets' mean."""
        s, columns, out = self.system, self.columns, np.empty(self.n)
        out[columns.at_points] = x[columns.points] - self.target[columns.points]
        merged, at = columns.merged, columns.at_merged
        goals = (self.target[merged] - s.shift[merged]) / s.scale[merged]
        count = np.maximum(np.bincount(at, minlength=self.n), 1)
        goal = np.bincount(at, goals, self.n) / count
        out[at] = x[columns.root] - goal[at]
        return out

    def movement(self, x: np.ndarray) -> float:
        """The movement squared."""
        return float(np.sum(self.bending * self.offsets(x) ** 2))

    def optimum(self, x: np.ndarray) -> np.ndarray | None:
        """Sequential quadratic programming from x; None when the equations could not be
        satisfied."""
        multipliers = np.zeros(self.rows.size)
        for k in range(30):
            self.problem.limit.require_time()
            found = self._step(x, [self.columns.bend(x, multipliers)] if k > 1 else [])
            if found is None:
                return None
            step, multipliers = found
            x, share = self._search(x, step, multipliers)
            if share * np.abs(step).max() <= 1e-9 * self.problem.size:
                break
        return self.restored(x)

    def _step(self, x: np.ndarray, bent: list) -> tuple[np.ndarray, np.ndarray] | None:
        """(step, multipliers) of the optimality system, with the equations' curvature if that bends upwards."""
        entries = self.columns.entries(x)
        right = np.append(-self.bending * self.offsets(x), -self.columns.errors(x))
        solution = self._solved(entries, bent, right)
        if bent and solution is not None:
            step, (i, j, value) = solution[: self.n], bent[0]
            plain = np.sum(self.bending * step**2)
            if np.sum(value * step[i] * step[j]) + plain <= 1e-3 * plain:
                solution = None
        if bent and solution is None:
            solution = self._solved(entries, [], right)
        return None if solution is None else (solution[: self.n], solution[self.n :])

    def _solved(self, entries: np.ndarray, bent: list, right: np.ndarray) -> np.ndarray | None:
        """(n + m,) the solution of the optimality system; None where it is singular."""
        row, column = self.columns.pattern
        n, whole = self.n, right.size
        own, diagonal = np.arange(whole), np.append(self.bending, np.full(whole - n, -1e-13))
        blocks = [(own, own, diagonal), (n + row, column, entries), (column, n + row, entries)]
        i, j, value = (np.concatenate(mine) for mine in zip(*blocks, *bent, strict=True))
        try:
            if whole <= 2 * DENSE:
                flat = np.bincount(i * whole + j, value, whole * whole)
                out = np.linalg.solve(flat.reshape(whole, whole), right)
            else:
                out = splu(coo_array((value, (i, j))).tocsc()).solve(right)
        except (np.linalg.LinAlgError, RuntimeError):
            return None
        return out if np.isfinite(out).all() else None

    def _search(self, x, step, multipliers) -> tuple[np.ndarray, float]:
        """(numbers, share of the step) where the merit (movement and violated equations) does not rise."""
        price = 2.0 * np.abs(multipliers).max(initial=0.0) + 1e-12

        def merit(numbers):
            return 0.5 * self.movement(numbers) + price * np.sum(
                np.abs(self.columns.errors(numbers))
            )

        before, size = merit(x), 1.0
        while size > 1e-3:
            moved = self.columns.moved(x, size * step)
            if merit(moved) <= before * (1.0 + 1e-14):
                return moved, size
            size *= 0.5
        return moved, size

    def restored(self, x: np.ndarray) -> np.ndarray | None:
        """Least-norm Newton steps until the equations hold to rounding."""
        size = self.problem.size
        best, least = None, RESIDUAL * size
        for _ in range(12):
            f = self.columns.errors(x)
            violated = np.abs(f).max(initial=0.0)
            if violated <= least:
                if best is not None and violated > 0.3 * least:
                    break
                best, least = x.copy(), violated
            if violated <= 2e-16 * size:
                break
            solution = self._solved(self.columns.entries(x), [], np.append(np.zeros(self.n), -f))
            if solution is None:
                break
            x = self.columns.moved(x, solution[: self.n])
        return best
