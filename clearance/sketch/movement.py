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

from clearance.sketch.graph.graph import POINT, SIZE, SLIDE, TURN
from clearance.sketch.problem import RESIDUAL, Problem
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.system import System

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
    if (
        best is None and problem.contacts is not None
    ):  # a regular equation may lead to a line's other side
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
    """One part's columns, weights and equations."""

    def __init__(self, problem: Problem, part: int, target: np.ndarray, weight: np.ndarray) -> None:
        self.system: System = problem.regular
        s = self.system
        self.problem = problem
        self.vertices = np.flatnonzero(problem.part == part)
        dependent = np.zeros(problem.row_part.size, bool)
        dependent[problem.plan.dependent] = True
        self.rows = np.flatnonzero((problem.row_part == part) & (problem.fate == 0) & ~dependent)
        self.columns = Columns(s, self.vertices, self.rows)
        self.first, self.n = self.columns.first, self.columns.n
        self.target = target
        self.hessian = self._hessian(weight)

    def _hessian(self, weight: np.ndarray) -> np.ndarray:
        """Entries (row, column, value) of the movement's second derivative."""
        s, entries = self.system, []
        size = self.problem.size
        drawn = {int(t) for t, a, _ in self.problem.tables.line_ends if a >= 0}
        for v in self.vertices:
            c, i = self.first[v], s.root[v]
            if s.kind[v] == POINT:
                entries += [(c, c, weight[i]), (c + 1, c + 1, weight[i])]
            elif s.kind[v] == SIZE:
                for j in s.member[s.member_start[v] : s.member_start[v + 1]]:
                    entries.append((c, c, s.scale[j] ** 2))
            elif s.kind[v] == TURN:
                for j in s.member[s.member_start[v] : s.member_start[v + 1]]:
                    entries.append((c, c, size * size * (WEAK if int(j) in drawn else 1.0)))
            elif s.kind[v] == SLIDE:
                for j in s.member[s.member_start[v] : s.member_start[v + 1]]:
                    entries.append((c, c, s.scale[j] ** 2 * (WEAK if int(j) - 1 in drawn else 1.0)))
        return np.array(entries).reshape(-1, 3)

    def holds(self, x: np.ndarray) -> bool:
        """Whether the equations hold as they are counted: a contact may be regular on a line's other side."""
        if self.problem.contacts is None:
            return True
        error = self.problem.system.rows(self.rows).errors(x)
        return bool(np.abs(error).max(initial=0.0) <= RESIDUAL * self.problem.size)

    def offsets(self, x: np.ndarray) -> np.ndarray:
        """(n,) how far every column is from its target."""
        s, out = self.system, np.empty(self.n)
        points = self.vertices[s.kind[self.vertices] == POINT]
        for k in (0, 1):
            out[self.first[points] + k] = x[s.root[points] + k] - self.target[s.root[points] + k]
        others = self.vertices[s.kind[self.vertices] != POINT]
        for v in others:
            mine = s.member[s.member_start[v] : s.member_start[v + 1]]
            goal = np.mean((self.target[mine] - s.shift[mine]) / s.scale[mine])
            out[self.first[v]] = x[s.root[v]] - goal
        return out

    def movement(self, x: np.ndarray) -> float:
        """The movement squared."""
        g = self.offsets(x)
        i, _, h = self.hessian.T
        return float(np.sum(h * g[i.astype(int)] ** 2))

    def optimum(self, x: np.ndarray) -> np.ndarray | None:
        """Sequential quadratic programming from x; None when the equations could not be
        satisfied."""
        size = self.problem.size
        multipliers = np.zeros(self.rows.size)
        for k in range(30):
            self.problem.limit.require_time()
            f, entries = self.columns.errors(x), self.columns.entries(x)
            rows, cols = self.columns.pattern
            gap = self.offsets(x)
            bent = self.columns.bend(x, multipliers) if k > 1 else None
            step, fresh = self._step(f, rows, cols, entries, gap, bent)
            if step is None:
                return None
            moved, length = self._search(x, f, gap, step, fresh)
            x, multipliers = moved, fresh
            if length * np.abs(step).max() <= 1e-9 * size:
                break
        return self.restored(x)

    def _step(self, f, rows, cols, entries, gap, bent):
        i, _, h = self.hessian.T
        diagonal = np.bincount(i.astype(int), h, self.n)
        m = f.size
        right = np.concatenate([-diagonal * gap, -f])
        for with_bend in (bent is not None, False):
            solution = self._solved(
                diagonal, bent if with_bend else None, rows, cols, entries, m, right
            )
            if solution is None or not np.isfinite(solution).all():
                continue
            step = solution[: self.n]
            if with_bend:
                curved = np.sum(bent[2] * step[bent[0]] * step[bent[1]]) + np.sum(
                    diagonal * step**2
                )
                if curved <= 1e-3 * np.sum(diagonal * step**2):
                    continue
            return step, solution[self.n :]
        return None, None

    def _solved(self, diagonal, bent, rows, cols, entries, m: int, right: np.ndarray):
        n = self.n
        if n + m <= 2 * DENSE:
            matrix = np.zeros((n + m, n + m))
            matrix[np.arange(n), np.arange(n)] = diagonal
            if bent is not None:
                np.add.at(matrix, (bent[0], bent[1]), bent[2])
            np.add.at(matrix, (n + rows, cols), entries)
            matrix[:n, n:] = matrix[n:, :n].T
            matrix[np.arange(n, n + m), np.arange(n, n + m)] = -1e-13
            try:
                return np.linalg.solve(matrix, right)
            except np.linalg.LinAlgError:
                return None
        from scipy.sparse import coo_array
        from scipy.sparse.linalg import splu

        i = [np.arange(n), n + rows, cols, np.arange(n, n + m)]
        j = [np.arange(n), cols, n + rows, np.arange(n, n + m)]
        value = [diagonal, entries, entries, np.full(m, -1e-13)]
        if bent is not None:
            i, j, value = [*i, bent[0]], [*j, bent[1]], [*value, bent[2]]
        matrix = coo_array((np.concatenate(value), (np.concatenate(i), np.concatenate(j))))
        try:
            return splu(matrix.tocsc()).solve(right)
        except RuntimeError:
            return None

    def _search(self, x, f, gap, step, multipliers):
        """A step along which the merit (movement and violated equations) falls."""
        i, _, h = self.hessian.T
        i = i.astype(int)
        price = 2.0 * np.abs(multipliers).max(initial=0.0) + 1e-12

        def merit(numbers):
            g = self.offsets(numbers)
            r = self.columns.errors(numbers)
            return 0.5 * np.sum(h * g[i] ** 2) + price * np.sum(np.abs(r))

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
            f, entries = self.columns.errors(x), self.columns.entries(x)
            rows, cols = self.columns.pattern
            violated = np.abs(f).max(initial=0.0)
            if violated <= least:
                if best is not None and violated > 0.3 * least:
                    break
                best, least = x.copy(), violated
            if violated <= 2e-16 * size:
                break
            i, _, h = self.hessian.T
            diagonal = np.bincount(i.astype(int), h, self.n)
            right = np.concatenate([np.zeros(self.n), -f])
            solution = self._solved(diagonal, None, rows, cols, entries, f.size, right)
            if solution is None or not np.isfinite(solution).all():
                break
            x = self.columns.moved(x, solution[: self.n])
        return best


__all__ = ["least_movement"]
