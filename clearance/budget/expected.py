"""The clearance expected of the nearest pair of each step: an estimate, no proof.

Errors are independent. A number is uniform up to its size, or normal with its size at three standard deviations; a
vector is uniform in the ball of its size, or normal in each of three axes alike. To the first order the variance
of the distance is the sum of theirs, times the squares of their slopes: m^2 / 3, of a ball m^2 / 5 for each axis.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clearance.budget.sources import Slope, Witness, slopes
from clearance.record.certificate import Certificate
from clearance.record.measurement import Measurement
from clearance.record.rows.blocks import blocks
from clearance.world.budget import Budget
from clearance.world.case import Case
from clearance.world.cubic import values_along
from clearance.world.forest import Forest, forest_of, joined_positions
from clearance.world.motion import Motion
from clearance.world.pairs import Pair

OF_NUMBER, OF_VECTOR, OF_NORMAL = 1.0 / 3.0, 1.0 / 5.0, 1.0 / 9.0
"""The variance of an error of size 1, of each axis of a vector."""

A_MOMENT = 1e-4
"""[s] To either side of a time: speeds are differences over this span."""


def variance_of(slope: Slope, budget: Budget) -> np.ndarray:
    """(n,) [m^2] the variance of a distance by one error."""
    uniform = OF_VECTOR if slope.along.shape[1] == 3 else OF_NUMBER
    share = OF_NORMAL if budget.is_normal else uniform
    return share * slope.size**2 * (slope.along**2).sum(axis=1)


def deviations(case: Case, budget: Budget, witness: Witness) -> np.ndarray:
    """(n,) [m] the standard deviation of the distance of a pair."""
    total = np.zeros(len(witness.points))
    for slope in slopes(case, budget, witness):
        total += variance_of(slope, budget)
    return np.sqrt(total)


def expected_of_steps(
    case: Case,
    budget: Budget,
    motions: Sequence[Motion],
    pairs: Sequence[Pair],
    found: Measurement,
) -> np.ndarray:
    """(n,) [m] the clearance of each step less `coverage` standard deviations; NaN in contact or where unknown."""
    expected = np.full(len(found.clearance), np.nan)
    for block in blocks(len(expected)):
        separate = np.flatnonzero((found.pair[block] >= 0) & ~found.touches(block)) + block.start
        nearest = found.pair[separate]
        for i_pair in np.unique(nearest).tolist():
            steps = separate[nearest == i_pair]
            witness = witness_of(case, budget, motions, pairs[i_pair], steps, found.points[steps])
            loss = budget.coverage * deviations(case, budget, witness)
            expected[steps] = found.clearance[steps] - loss
    return expected


def expected_between(
    found: Measurement, certificate: Certificate, expected: np.ndarray
) -> np.ndarray:
    """(n,) [m] the same for the least moment after each step, NaN where none is nearer than the steps.

    The loss by errors is that of the nearer end, if known. The result never exceeds the distance that occurs.
    """
    clearance = np.where(np.isnan(found.clearance), np.inf, found.clearance)
    loss = np.nan_to_num(clearance - expected, nan=0.0, posinf=0.0)
    after = np.append(np.arange(1, len(clearance)), len(clearance) - 1)
    nearer = np.where(clearance[after] < clearance, loss[after], loss)
    remaining = certificate.upper_bound - np.where(certificate.touches(slice(None)), 0.0, nearer)
    return np.where(certificate.pair >= 0, remaining, np.nan)


def witness_of(
    case: Case,
    budget: Budget,
    motions: Sequence[Motion],
    pair: Pair,
    steps: np.ndarray,
    points: np.ndarray,
) -> Witness:
    """The nearest points of a pair at some steps, and the poses then."""
    columns = joined_positions(case, motions, steps)
    rates = clock_rates(case, budget, motions, motions[0].times[steps])
    return Witness(pair, points, forest_of(case).poses(columns), rates)


def clock_rates(
    case: Case, budget: Budget, motions: Sequence[Motion], times: np.ndarray
) -> Mapping[str, np.ndarray]:
    """For each owner of a clock with an error: (n, links, 4, 4) [1/s] the rates of the poses by it."""
    owners = [
        (name, slice(first, last))
        for name, first, last in _columns(case)
        if _timing(budget, name) > 0.0
    ]
    if not owners:
        return {}
    here, before, after = (
        _at(case, motions, times + shift) for shift in (0.0, -A_MOMENT, A_MOMENT)
    )
    return {name: _rate(forest_of(case), here, before, after, own) for name, own in owners}


def _rate(
    forest: Forest, here: np.ndarray, before: np.ndarray, after: np.ndarray, own: slice
) -> np.ndarray:
    ends = []
    for then in (before, after):
        moved = here.copy()
        moved[:, own] = then[:, own]
        ends.append(forest.poses(moved))
    return (ends[1] - ends[0]) / (2.0 * A_MOMENT)


def _at(case: Case, motions: Sequence[Motion], times: np.ndarray) -> np.ndarray:
    """(n, columns) the positions at some times; before and after the run its first and last."""
    knots = motions[0].times
    found = [values_along(knots, one.positions, one.velocities, times) for one in motions]
    tables = [one.moves.columns for one in case.obstacles if one.moves is not None]
    return np.column_stack([*found, *(values_along(knots, table, None, times) for table in tables)])


def _columns(case: Case) -> list[tuple[str, int, int]]:
    """The columns of the positions of each actor, from the first to before the last."""
    found, at = [], 0
    for placed in case.robots:
        n = len(placed.robot.moving_joints)
        found.append((placed.robot.name, at, at + n))
        at += n
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            found.append((obstacle.name, at, at + 7))
            at += 7
    return found


def _timing(budget: Budget, name: str) -> float:
    own = budget.robots.get(name) or budget.obstacles.get(name)
    return 0.0 if own is None else own.timing
