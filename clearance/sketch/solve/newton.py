"""Small numeric clusters: all unknowns moved at once until the equations hold, from one place or from many.

Newton with a step control (the residual must fall), and Levenberg and Marquardt's damping where Newton fails.
Several places go down side by side, so that sixty starts cost little more than one.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.sketch.effort import OutOfTime, TimeLimit
from clearance.sketch.graph.graph import TURN
from clearance.sketch.solve.columns import Columns

AT_ONCE = 20
"""Starts that go down side by side; the first that ends at a root counts."""

FAR = 1e6
"""[m] at size 1: a longer step is one along which a singular matrix says nothing."""


class StoppingRule(NamedTuple):
    """When a search for a cluster's place ends.

    Attributes:
        floor: [m] the residual that it aims at. tolerance: [m] the residual at which the equations hold.
        attempts: how often it is tried. limit: when it is stopped.
        settled: [m] a step of a plan whose equations hold to this is skipped.
    """

    floor: float
    tolerance: float
    attempts: int
    limit: TimeLimit
    settled: float = 0.0


def newton(columns: Columns, x: np.ndarray, rule: StoppingRule) -> np.ndarray | None:
    """Numbers (n,) near x at which the equations hold to `rule.tolerance`; None when none were found.

    Where the descent ends in a local minimum it starts again from x, shaken by growing shifts in units of the
    first residual.
    """
    found, good = descended(columns, x[None], rule, 40)
    if good[0]:
        return found[0]
    starts = _shaken(columns, x, rule.attempts)
    for k in range(0, len(starts), AT_ONCE):
        found, good = descended(columns, starts[k : k + AT_ONCE], rule, 20)
        if good.any():
            return found[int(np.argmax(good))]
    return None


def _shaken(columns: Columns, x: np.ndarray, attempts: int) -> np.ndarray:
    """(attempts - 1, n) x with every vertex (bodies as a whole) shifted, the later the more."""
    share = np.random.default_rng(12345).uniform(-1.0, 1.0, (max(attempts, 1), columns.n))[1:]
    share[:, columns.first[columns.single[columns.system.kind[columns.single] == TURN]]] = 0.0
    share[:, columns.turns] = 0.0
    spread = np.sqrt(np.mean(columns.errors(x) ** 2))
    strength = 0.2 + 1.8 * np.arange(1, share.shape[0] + 1) / max(attempts, 1)
    return columns.moved(
        np.repeat(x[None], share.shape[0], axis=0), spread * strength[:, None] * share
    )


def descended(
    columns: Columns, x: np.ndarray, rule: StoppingRule, longest: int
) -> tuple[np.ndarray, np.ndarray]:
    """(numbers (k, n), marks of those at which the equations hold) after up to `longest` steps from each of x."""
    x = x.copy()
    error = columns.errors(x)
    total, damping = np.sum(error**2, axis=-1), np.zeros(len(x))
    active = np.ones(len(x), bool)
    for _ in range(longest):
        active &= total > rule.floor**2
        at = np.flatnonzero(active)
        if not at.size:
            break
        if rule.limit.is_over():
            raise OutOfTime(x[np.argmin(total)])
        step = _steps(error[at], columns.matrix(x[at]), damping[at])
        fell = _search(columns, (x, error, total), at, step, damping[at] == 0.0)
        was = damping[at]
        damping[at] = np.where(
            fell, np.where(was > 1e-7, 0.1 * was, 0.0), np.maximum(1e-3, 8.0 * was)
        )
        active[at] &= fell | ~((was > 1e8) | (total[at] <= rule.tolerance**2))
    return x, total <= rule.tolerance**2


def _search(
    columns: Columns, state, at: np.ndarray, step: np.ndarray, halved: np.ndarray
) -> np.ndarray:
    """Takes every step along which the error falls, or a half, a quarter of it (where `halved`); marks of them."""
    x, error, total = state
    fell, trying, size = np.zeros(at.size, bool), np.arange(at.size), 1.0
    while trying.size and size > 0.01:
        y = columns.moved(x[at[trying]], size * step[trying])
        after = columns.errors(y)
        sums = np.sum(after**2, axis=-1)
        good = sums < (1.0 - 1e-3 * size) * total[at[trying]]
        hit = at[trying[good]]
        x[hit], error[hit], total[hit] = y[good], after[good], sums[good]
        fell[trying[good]] = True
        trying = trying[~good & halved[trying]]
        size *= 0.5
    return fell


def _steps(error: np.ndarray, matrix: np.ndarray, damping: np.ndarray) -> np.ndarray:
    """(k, n) the steps to where the linear equations hold, or nearly; `damping` in units of the normal matrix's
    diagonal."""
    k, m, n = matrix.shape
    out = np.zeros((k, n))
    plain = (damping == 0.0) & (m == n)
    if plain.any():
        out[plain] = _solved(matrix[plain], -error[plain])
    rest = ~plain
    if rest.any():
        a = matrix[rest]
        normal = a.transpose(0, 2, 1) @ a
        diagonal = normal[:, np.arange(n), np.arange(n)]
        mean = diagonal.mean(axis=1, keepdims=True)
        more = damping[rest, None] * (diagonal + 1e-3 * mean) + 1e-14 * mean + 1e-300
        normal[:, np.arange(n), np.arange(n)] += more
        out[rest] = _solved(normal, -(a.transpose(0, 2, 1) @ error[rest, :, None])[..., 0])
    out[~(np.abs(out).max(axis=1, initial=0.0) < FAR)] = 0.0
    return out


def _solved(matrix: np.ndarray, right: np.ndarray) -> np.ndarray:
    """(k, n) the solutions; no step where a matrix is singular."""
    try:
        return np.linalg.solve(matrix, right[..., None])[..., 0]
    except np.linalg.LinAlgError:
        return np.array(
            [np.linalg.lstsq(a, b, rcond=1e-15)[0] for a, b in zip(matrix, right, strict=True)]
        )
