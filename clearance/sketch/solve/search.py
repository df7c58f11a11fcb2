"""Numeric clusters of any size: small ones by Newton, large ones by descents that learn where they fail.

A descent of a large cluster mostly ends either at a root or in a minimum whose error sits in one place, where
a few vertices lie on the wrong side of each other. Such a minimum is kicked there only: a vertex of a
violated equation, chosen with the error as weight, and its neighbours up to two equations away are moved
at random, and the descent goes on; right places elsewhere stay. A worse minimum is accepted if it is
not much worse. The sequence of random numbers is fixed.

The descent of a large cluster is damped least squares. Its columns are numbered from a far end (Cuthill and
McKee), so that the normal matrix is a band: n columns of width w cost n w^2 instead of n^3. The damping is in the
diagonal's own units (Marquardt), so that lengths and turns may be mixed.
Sources: basin hopping, Wales and Doye 1997, with moves in one place; Cuthill, McKee 1969; Marquardt 1963.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from scipy.linalg import LinAlgError, solveh_banded
from scipy.sparse import coo_array
from scipy.sparse.csgraph import reverse_cuthill_mckee

from clearance.sketch.effort import OutOfTime
from clearance.sketch.graph.graph import POINT, TURN
from clearance.sketch.solve.columns import Columns
from clearance.sketch.solve.newton import StoppingRule, newton

RESTARTS = 60
"""How often a numeric cluster is tried."""

KICKS = 8
"""Kicks of a large cluster for every such trial: the hardest of 100 clusters of 100 points took 150."""

BANDED = 40
"""Unknowns from which a cluster is solved on a band."""

WORK = 4e9
"""Multiplications after which a search ends."""

DIGITS, NEAR = 1e-2, 1e14
"""[-] Sums of squares in units of the squared tolerance between which nearly undamped steps add digits."""

FROM_SKETCH, FROM_KICK = 1e-2, 1e-4
"""[-] First damping: with the larger one more descents from the sketch end at the root nearest to it (64
against 50 of 100), with the smaller one a search needs half the steps."""

WORSE = 1.5
"""[-] How much larger the sum of squares may be after an accepted kick."""


def solve_cluster(columns: Columns, x: np.ndarray, rule: StoppingRule) -> np.ndarray | None:
    """Numbers (n,) near x at which a cluster's equations hold, by the method for its number of unknowns; None when
    none were found.

    Raises:
        OutOfTime: with the numbers of least error so far.
    """
    if not columns.n:
        return x if np.abs(columns.errors(x)).max(initial=0.0) <= rule.tolerance else None
    if columns.n < BANDED:
        return newton(columns, x, rule)
    return _Search(columns, x, rule).found()


class _Search:
    """The search of a large cluster: where it is, and the sum of squares there."""

    def __init__(self, columns: Columns, x: np.ndarray, rule: StoppingRule) -> None:
        self.columns, self.x, self.rule = columns, x, rule
        self.normal = BandedNormal(columns)
        self.random = np.random.default_rng(12345)
        self.total, self.steps = math.inf, 0

    def found(self) -> np.ndarray | None:
        """See `solve_cluster`."""
        enough = self.rule.tolerance**2
        try:
            self._descend(self.x, DescentLimits(FROM_SKETCH, 120, 8))
            kicks = _Kicks(self.columns)
            for _ in range(KICKS * self.rule.attempts):
                if self.total <= enough or self.steps * self.normal.work > WORK:
                    break
                kicked = self.columns.moved(self.x, kicks.step(self.x, self.random))
                self._descend(kicked, DescentLimits(FROM_KICK, 60, 4))
            if DIGITS * enough < self.total <= NEAR * enough:
                self._descend(self.x, DescentLimits(1e-12, 40, 40, last_digits=True))
        except OutOfTime:
            if self.total < math.inf:
                raise OutOfTime(self.x) from None
            raise
        return self.x if self.total <= enough else None

    def _descend(self, x: np.ndarray, limits: DescentLimits) -> None:
        """Goes down from x; stays there unless it is much worse."""
        x, total, steps = descend_damped(self.columns, self.normal, x, self.rule, limits)
        self.steps += steps
        if total < WORSE * self.total:
            self.x, self.total = x, total


class _Kicks:
    """The nodes of a cluster, each a body or a single vertex, and random moves of some of them."""

    def __init__(self, columns: Columns) -> None:
        s, row, column = columns.system, *columns.pattern
        self.columns = columns
        begins = np.unique(columns.first[columns.vertices])
        node = np.searchsorted(begins, column, side="right") - 1
        self.first, self.end = begins, np.append(begins[1:], columns.n)
        self.turn_nodes = set(
            np.searchsorted(
                begins, columns.first[columns.single[s.kind[columns.single] == TURN]]
            ).tolist()
        )
        self.of_row: list[list[int]] = [[] for _ in range(columns.rows.size)]
        for at, k in zip(row.tolist(), node.tolist(), strict=True):
            if k not in self.of_row[at]:
                self.of_row[at].append(k)
        self.rows: list[list[int]] = [[] for _ in begins]
        for at, mine in enumerate(self.of_row):
            for k in mine:
                self.rows[k].append(at)

    def step(self, x: np.ndarray, random: np.random.Generator) -> np.ndarray:
        """(columns,) a move of a node of an equation that does not hold, chosen with the error as weight, and of
        its neighbours up to two equations away."""
        weight = np.cumsum(np.abs(self.columns.errors(x)))
        row = min(int(np.searchsorted(weight, random.uniform() * weight[-1])), weight.size - 1)
        node = self.of_row[row][random.integers(len(self.of_row[row]))]
        ring = int(random.integers(3))
        amount = (2.0, 1.0, 0.5)[ring] * random.uniform(0.3, 1.0)
        reach = self._reach(x, node)
        out = np.zeros(self.columns.n)
        for k in self._around(node, ring):
            share = random.uniform(-1.0, 1.0, self.end[k] - self.first[k])
            scale = np.full(share.size, 1.0 if k in self.turn_nodes else reach)
            scale[2:] = 1.0  # a body's turn
            out[self.first[k] : self.end[k]] = amount * share * scale
        return out

    def _around(self, node: int, ring: int) -> list[int]:
        """The node and its neighbours up to so many equations away."""
        depth, waiting = {node: 0}, [node]
        for u in waiting:
            for row in self.rows[u] if depth[u] < ring else ():
                for w in self.of_row[row]:
                    if w not in depth:
                        depth[w] = depth[u] + 1
                        waiting.append(w)
        return waiting

    def _reach(self, x: np.ndarray, node: int) -> float:
        """[m] the mean distance between the points of a node's equations; where there are none, the extent of the
        cluster over the root of its points."""
        s, gaps = self.columns.system, []
        for row in self.columns.rows[self.rows[node]]:
            named = s.vertex_of[s.var[row][s.var[row] >= 0]]
            roots = s.root[
                list(dict.fromkeys(v for v in named.tolist() if v > 0 and s.kind[v] == POINT))
            ]
            gaps += np.hypot(np.diff(x[roots]), np.diff(x[roots + 1])).tolist()
        if sum(gaps) > 0.0:
            return sum(gaps) / len(gaps)
        points = self.columns.vertices[s.kind[self.columns.vertices] == POINT]
        places = x[np.concatenate([s.root[points], s.root[points] + 1])]
        extent = float(np.ptp(places)) if places.size else 0.0
        return extent / math.sqrt(points.size) if extent > 0.0 else 1.0


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
