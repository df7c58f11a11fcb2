"""The two programmes that a step of the search solves: the least point of linear rows, and the least violation.

scipy's solvers are the adapters: `nnls` (Lawson & Hanson 1974), `linprog` (HiGHS). Not for: the
rows (`shortfalls`).
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from clearance.gains.shortfalls import Rows


class Box(NamedTuple):
    """(m,) lower and upper bounds of the variables."""

    low: np.ndarray
    high: np.ndarray

    def about(self, x: np.ndarray, reach: np.ndarray) -> Box:
        """The part of it within (m,) `reach` of a point in it."""
        return Box(np.maximum(self.low, x - reach), np.minimum(self.high, x + reach))


def reachable(rows: Rows, x: np.ndarray, box: Box) -> Rows:
    """The rows that some point of a box may break, linear about x."""
    low, high = box.low - x, box.high - x
    gradients = rows.gradients
    least = np.minimum(gradients * low, gradients * high).sum(axis=1)
    some = rows.missing > least
    return Rows(rows.missing[some], gradients[some])


def least_norm(rows: Rows, x: np.ndarray, box: Box) -> np.ndarray | None:
    """(m,) the point of a box of least Euclidean length that keeps all rows, linear about x; None if none does.

    Source: least-distance programming by non-negative least squares, Lawson & Hanson 1974, chapter 23.
    """
    from scipy.optimize import nnls

    size = len(x)
    bounded = [np.isfinite(box.low), np.isfinite(box.high)]
    a = np.concatenate([rows.gradients, np.eye(size)[bounded[0]], -np.eye(size)[bounded[1]]])
    b = np.concatenate(
        [rows.missing + rows.gradients @ x, box.low[bounded[0]], -box.high[bounded[1]]]
    )
    if (b <= 0.0).all():
        return np.zeros(size)
    scale = float(np.abs(b).max())
    system = np.vstack([a.T, b[None] / scale])
    aim = np.zeros(size + 1)
    aim[-1] = 1.0
    weights, _ = nnls(system, aim, maxiter=30 * (size + len(b)))
    residual = system @ weights - aim
    if -residual[-1] < 1e-12:
        return None
    return -residual[:size] / residual[-1] * scale


class Inequalities(NamedTuple):
    """What the variables x keep beside their bounds: a x <= b.

    Attributes:
        a: (k, m), a sparse matrix. b: (k,).
    """

    a: Any
    b: np.ndarray


def within_reach(inequalities: Inequalities, low: np.ndarray, high: np.ndarray) -> Inequalities:
    """Those that some point between (m,) `low` and `high`, all finite, may break."""
    most = inequalities.a.maximum(0.0) @ high + inequalities.a.minimum(0.0) @ low
    some = most > inequalities.b
    return Inequalities(inequalities.a[some], inequalities.b[some])


def least_missing(
    rows: Rows, x: np.ndarray, box: Box, inequalities: Inequalities | None
) -> tuple[np.ndarray, float]:
    """(m,) the point of a box at which the worst row, linear about x, is least below 0, and how much that is.

    Args:
        inequalities: what is kept beside the box; None for nothing.
    """
    from scipy.optimize import linprog

    rows = reachable(rows, x, box)
    n_rows, size = rows.gradients.shape
    cost = np.zeros(size + 1)
    cost[-1] = 1.0
    above, most = np.hstack([-rows.gradients, -np.ones((n_rows, 1))]), -rows.missing
    if inequalities is not None:
        from scipy.sparse import csr_array, hstack, vstack

        shifted = Inequalities(inequalities.a, inequalities.b - inequalities.a @ x)
        near = within_reach(shifted, box.low - x, box.high - x)
        with_zeros = hstack([near.a, csr_array((len(near.b), 1))])
        above, most = vstack([csr_array(above), with_zeros]), np.concatenate([most, near.b])
    bounds = [*zip(box.low - x, box.high - x, strict=True), (0.0, None)]
    found = linprog(cost, A_ub=above, b_ub=most, bounds=bounds, method="highs")
    if found.x is None:
        return x, float(rows.missing.max(initial=0.0))
    return x + found.x[:size], float(found.x[-1])
