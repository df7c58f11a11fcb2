"""The motions that a solution really has: the local dimension of the set of solutions, and its causes.

The derivative's kernel at a solution is too large where constraints only touch: a point at the tangent point of
a line and a circle is fixed, though not in the first order. The kernel at a place aside of the solution is too
small where dependencies hold on the solutions alone (theorems, mirror images). So both are asked at solutions:
from the solution a short walk along a random motion of the kernel, then back on the equations by least-norm
steps, ends at a generic solution nearby. There a motion of the kernel counts unless the second derivative
of the dependent equations ends it, or a walk along it comes back. Lengths here are near 1.
Not for: sketches whose equations are independent; their kernel is right.
Sources: Connelly, Whiteley 1996 (second-order rigidity); Wampler, Hauenstein, Sommese 2011 (local dimension).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.sketch.equations import OF_LENGTH, are
from clearance.sketch.graph.graph import TURN
from clearance.sketch.problem import Problem
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.system import System

SINGULAR = 1e-9
"""[-] Ratio to the largest below which a singular value counts as 0: dimensions are scaled to
one size."""

STRAIGHT = 1e-6
"""[1/m at size 1] Curvature below which an equation counts as flat along a motion."""

STEP, LEAST_STEP = 1e-3, 1e-5
"""[-] How far a walk goes, relative to the smallest length of a part, and at least, relative to the size."""

WALKS = 3
"""Walks from a singular solution: several branches may meet there, the largest counts."""

SURVIVES = 0.3
"""[-] Share of a walk that must remain after coming back to the equations: a motion that is ended by
contact of fourth order leaves 0.1, by second order 1e-5."""


class Motions(NamedTuple):
    """Motions (n, k) by column, orthonormal, at the numbers `place`."""

    basis: np.ndarray
    place: np.ndarray


class Equations:
    """Some equations of one part at a solution: derivatives scaled to lengths, walks on the solutions.

    Their remaining errors at the solution (an implied dimension may be off by a rounding) count as
    right. The order of the rows says which are named where some follow from others: the last.
    """

    def __init__(
        self, problem: Problem, part: int, rows: np.ndarray, x: np.ndarray, system: System
    ) -> None:
        self.problem = problem
        self.part = part
        self.rows = rows
        self.solution = x
        self.vertices = problem.vertices_of(part)
        self.columns = Columns(system, self.vertices, rows)
        self.first, self.n = self.columns.first, self.columns.n
        self.system = s = system
        self.unit = np.ones(self.n)
        self.unit[self.first[self.vertices[s.kind[self.vertices] == TURN]]] = 1.0 / problem.size
        self.error = np.zeros(rows.size)
        self.error = self.at(x)[0]

    def without(self, row: int) -> Equations:
        """The same without one of them."""
        rows = self.rows[self.rows != row]
        return Equations(self.problem, self.part, rows, self.solution, self.system)

    def at(self, x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Residuals (m,) and derivative (m, n)."""
        return self.columns.errors(x) - self.error, self.columns.matrix(x) * self.unit

    def curvature(self, x: np.ndarray, weights: np.ndarray, motions: np.ndarray) -> np.ndarray:
        """(k, k) the second derivative of the weighted equations along motions (n, k)."""
        i, j, value = self.columns.bend(x, weights)
        matrix = np.zeros((self.n, self.n))
        np.add.at(matrix, (i, j), value)
        scaled = self.unit[:, None] * motions
        return scaled.T @ matrix @ scaled

    def moved(self, x: np.ndarray, step: np.ndarray) -> np.ndarray:
        """The numbers after a step (n,) of the columns."""
        return self.columns.moved(x, self.unit * step)

    def walked(self, x: np.ndarray, step: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """(numbers, path in columns) after a step and the least-norm return to the equations, if it is
        found."""
        path, place = step.copy(), self.moved(x, step)
        for _ in range(40):
            self.problem.limit.require_time()
            f, matrix = self.at(place)
            if np.abs(f).max(initial=0.0) <= 2e-16:
                break
            back = -np.linalg.lstsq(matrix, f, rcond=SINGULAR)[0]
            if np.abs(back).max() <= 1e-15:
                break
            if np.linalg.norm(back) > 2.0 * np.linalg.norm(step):
                return None
            path, place = path + back, self.moved(place, back)
        allowed = 1e-13 + 1e-2 * np.abs(self.error).max(initial=0.0)
        good = np.abs(self.at(place)[0]).max(initial=0.0) <= allowed
        return (place, path) if good else None

    @property
    def reach(self) -> float:
        """How far a walk goes."""
        s, size = self.problem.system, self.problem.size
        plain = np.abs(s.value[self.rows[are(s.code[self.rows], *OF_LENGTH)]])
        least = plain[plain > 0.0].min(initial=size)
        return max(STEP * least, LEAST_STEP * size)


def split(matrix: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(kernel (n, k), left kernel (m, l)) of a matrix (m, n), orthonormal."""
    if not matrix.shape[0]:
        return np.eye(matrix.shape[1]), np.zeros((0, 0))
    u, values, vt = np.linalg.svd(matrix)
    rank = int(np.sum(values > SINGULAR * max(values[0], 1.0))) if values.size else 0
    return vt[rank:].T, u[:, rank:]


def motions_of(equations: Equations, x: np.ndarray | None = None, *, walk: bool = True) -> Motions:
    """The motions that a solution really has (or another, x (n,), of the same equations); their number is
    the local dimension.

    Where the equations are dependent they are those at a generic solution nearby; without a walk, those of
    the kernel.

    Raises:
        OutOfTime: the problem's limit has passed.
    """
    x = equations.solution if x is None else x
    kernel, left = split(equations.at(x)[1])
    if not walk or not left.shape[1] or not kernel.shape[1]:
        return Motions(kernel, x)
    random, found = np.random.default_rng(0), []
    for _ in range(WALKS):
        walked = equations.walked(x, _stride(equations, kernel, random))
        if walked is not None:
            found.append(_generic(equations, walked[0], random))
            if found[-1].basis.shape[1] == kernel.shape[1]:
                break
    found = found or [_generic(equations, x, random)]
    return max(found, key=lambda m: m.basis.shape[1])


def _stride(equations: Equations, motions: np.ndarray, random) -> np.ndarray:
    """A random motion of the length of a walk."""
    step = motions @ random.standard_normal(motions.shape[1])
    return step * (equations.reach / np.abs(step).max())


def _generic(equations: Equations, x: np.ndarray, random) -> Motions:
    """The motions at a generic solution: those of the kernel that dependent equations do not end."""
    kernel, left = split(equations.at(x)[1])
    if left.shape[1] and kernel.shape[1]:
        bent = np.vstack([equations.curvature(x, w, kernel) for w in left.T])
        _, values, vt = np.linalg.svd(bent)
        kernel = kernel @ vt[int(np.sum(values > STRAIGHT)) :].T
        if kernel.shape[1]:
            kernel = _surviving(equations, x, kernel, random)
    return Motions(kernel, x)


def _surviving(equations: Equations, x: np.ndarray, motions: np.ndarray, random) -> np.ndarray:
    """The motions along which a walk gets on: all, where a random one does."""
    step = _stride(equations, motions, random)
    walked = equations.walked(x, step)
    if walked is not None:
        rest = motions.T @ (walked[1] - step)
        if np.linalg.norm(rest) <= SURVIVES * np.linalg.norm(step):
            return motions
    ways = []
    for motion in motions.T:
        walked = equations.walked(x, motion * equations.reach)
        ways.append(
            motions.T @ walked[1] / equations.reach if walked else np.zeros(motions.shape[1])
        )
    u, values, _ = np.linalg.svd(np.array(ways).T)
    return motions @ u[:, : int(np.sum(values > SURVIVES))]


def are_independent(equations: Equations) -> bool:
    """Whether no equation follows from the others in the first order."""
    return rank_of(equations.at(equations.solution)[1]) == equations.rows.size


def implied(equations: Equations, *, walk: bool = True) -> list[int]:
    """The equations (rows) that follow from the others: without them the solutions near x are as many.

    If equations follow from one another, the last are named.
    """
    if are_independent(equations):
        return []
    motions = motions_of(equations, walk=walk)
    kernel, left = split(equations.at(motions.place)[1])
    if motions.basis.shape[1] == kernel.shape[1]:  # a smaller set of equations has no larger kernel
        return [int(equations.rows[k]) for k in dependent(equations.at(motions.place)[1])]
    out = []
    for row in equations.rows[np.abs(left).max(axis=1, initial=0.0) > STRAIGHT][::-1]:
        equations.problem.limit.require_time()
        fewer = equations.without(row)
        if motions_of(fewer, motions.place).basis.shape[1] == motions.basis.shape[1]:
            equations = fewer
            out.append(int(row))
    return sorted(out)


def dependent(matrix: np.ndarray) -> list[int]:
    """Rows of a matrix that the rows before them span."""
    basis, out = np.zeros((0, matrix.shape[1])), []
    for k, row in enumerate(matrix):
        rest = row - basis.T @ (basis @ row)
        rest -= basis.T @ (basis @ rest)
        norm = np.linalg.norm(rest)
        if norm <= SINGULAR * max(float(np.linalg.norm(row)), 1.0):
            out.append(k)
        else:
            basis = np.vstack([basis, rest / norm])
    return out


def rank_of(matrix: np.ndarray, singular: float = SINGULAR) -> int:
    """The numerical rank."""
    if not matrix.size:
        return 0
    values = np.linalg.svd(matrix, compute_uv=False)
    return int(np.sum(values > singular * max(values[0], 1.0)))
