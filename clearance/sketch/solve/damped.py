"""Large numeric clusters: damped least squares on a banded matrix.

The columns are numbered from a far end of the cluster (Cuthill and McKee), so that the normal
matrix is a band: n columns of width w cost n w^2 instead of n^3. The damping is in the diagonal's own units
(Marquardt), so that lengths and turns may be mixed. Not for: the last digits of small clusters (`newton`).
Sources: Cuthill, McKee 1969; Marquardt 1963.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, solveh_banded
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from clearance.sketch.effort import OutOfTime
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.newton import StoppingRule


class DescentLimits(NamedTuple):
    """How a damped descent begins and ends.

    Attributes:
        damping: [-] the first, in units of the diagonal.
        longest: steps. patience: steps in which the sum of squares must fall by a fifth.
        last_digits: goes on below the tolerance while that gains anything.
    """

    damping: float
    longest: int
    patience: int
    last_digits: bool = False


class BandedNormal:
    """The normal equations of a cluster as a band whose columns have an order of their own.

    Attributes:
        work: multiplications of one factorisation.
    """

    def __init__(self, columns: Columns) -> None:
        row, column = columns.pattern
        self.columns, n = columns, columns.n
        links = coo_array((np.ones(row.size), (row, column)), (columns.rows.size, n)).tocsr()
        order = reverse_cuthill_mckee((links.T @ links).tocsr(), symmetric_mode=True)
        self.place = np.empty(n, np.int64)
        self.place[order] = np.arange(n)
        p, q = columns.pairs
        low, high = self.place[column[p]], self.place[column[q]]
        inside = low <= high
        self._p, self._q = p[inside], q[inside]
        self._half = int((high - low).max(initial=0)) + 1
        self._target = (high - low)[inside] * n + low[inside]
        self._row, self._column = row, self.place[column]
        self.work = float(n) * self._half**2

    def at(self, x: np.ndarray, error: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(band (half, n), lower form; minus the gradient (n,)) at numbers with some errors (m,)."""
        value, n = self.columns.entries(x), self.columns.n
        band = np.bincount(self._target, value[self._p] * value[self._q], self._half * n)
        right = -np.bincount(self._column, error[self._row] * value, n)
        return band.reshape(self._half, n), right

    def solved(self, band: np.ndarray, right: np.ndarray, more: np.ndarray) -> np.ndarray | None:
        """(n,) the step by columns, `more` (n,) being added to the diagonal; None when not positive definite."""
        damped = band.copy()
        damped[0] += more
        try:
            step = solveh_banded(damped, right, True, True, lower=True, check_finite=False)
        except LinAlgError:
            return None
        return step[self.place]


def descend_damped(
    columns: Columns, normal: BandedNormal, x: np.ndarray, rule: StoppingRule, limits: DescentLimits
) -> tuple[np.ndarray, float, int]:
    """(numbers, their sum of squares, steps) where a descent from x ends: at the floor, or where the sum falls too
    little."""
    error = columns.errors(x)
    total, damping = float(error @ error), limits.damping
    enough = 0.0 if limits.last_digits else rule.tolerance**2
    past, unit, equations = total, None, None
    for k in range(limits.longest):
        if not (total > rule.floor**2 and damping <= 1e6):
            return x, total, k
        if rule.limit.is_over():
            raise OutOfTime(x)
        if equations is None:
            equations = normal.at(x, error)
        if unit is None:
            unit = np.where(equations[0][0] > 0.0, equations[0][0], 1.0)
        step = normal.solved(*equations, damping * unit)
        y = x if step is None else columns.moved(x, step)
        fresh = columns.errors(y)
        after = float(fresh @ fresh)
        if after < total:
            damping *= 0.1 if after < 0.3 * total else (0.4 if after < 0.7 * total else 1.0)
            damping = max(damping, 1e-13)
            x, error, total, equations = y, fresh, after, None
        elif total <= enough:
            return x, total, k
        else:
            damping *= 4.0
        if (k + 1) % limits.patience == 0:
            if total > 0.8 * past:
                return x, total, k + 1
            past = total
    return x, total, limits.longest
