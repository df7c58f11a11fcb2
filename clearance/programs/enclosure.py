"""Between two samples, a proven bound of how far joints that hold the tool on its path are off their cubics.

With c(t) the cubic of an interval, t in [-1, 1], and F(q, t) what brings the tool from its pose at joints q to
that of the path, N(q) = q - Y F(q, t) with Y the inverse of the Jacobian at the middle. If for every t

    |Y F(c(t), t)| <= e   and   |I - Y F'(q, t)| <= K where |q - c(t)| <= r,   with   e + K r < r,

then N maps the box of r about c(t) into itself and contracts, so exactly one q in it has F(q, t) = 0, and it is
continuous in t (Krawczyk 1969; Neumaier 1990, 5.1). e is the sum of Chebyshev coefficients of the series of Y
F(c(t), t) and its remainder; K is bounded by how far the Jacobian's columns can turn. An arm of more than six
joints keeps its others on the cubic: rows N' (q - c(t)) = 0, N the directions in which the tool rests at the
middle. Not for: the joints at samples (`following`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry.quaternions import half_skew
from clearance.programs.arm import Arm
from clearance.programs.carriage import Carried
from clearance.programs.series import (
    ORDER,
    greatest,
    majorant_of_turns,
    matrix_product,
    moved,
    product,
)
from clearance.programs.tool_path import Stretch

ROUNDING = 2.0**-44
"""The rounding of a pose and of a series, relative to the arm's length and to 1: some 20 products of rotations,
each right to a few roundings."""


class Intervals(NamedTuple):
    """Intervals between samples on one stretch of a path.

    Attributes:
        lengths: (n,) [s]. before, after: (n, k) positions, and rates: (2, n, k) their rates at both ends [1/s].
        strokes: (3, n, 2) share, rate [1/s] and change [1/s^2] of both strokes at the beginning.
        carried: what carries the path meanwhile; None where it is in a frame that stands, or that joints move.
    """

    lengths: np.ndarray
    before: np.ndarray
    after: np.ndarray
    rates: np.ndarray
    strokes: np.ndarray
    carried: Carried | None = None

    def rows(self, i: np.ndarray) -> Intervals:
        """Those of some intervals."""
        carried = None if self.carried is None else self.carried.rows(i)
        own = self.lengths[i], self.before[i], self.after[i]
        return Intervals(*own, self.rates[:, i], self.strokes[:, i], carried)


class Spread(NamedTuple):
    """Poses about a corner's path: the point at strokes s1 + s and s2 - s, the rotation at s1 + a and s2 + b.

    Attributes:
        joints: (n, k) [rad or m] how far the cubics are shifted for it.
        held: (n, k) how far joints that do not follow may be from there, with s.
        shifts, halves: (n, 3) the middle of s, a and b, and half their range.
        ball: [m] how far the point may be from there, in any direction.
    """

    joints: np.ndarray
    held: np.ndarray
    shifts: np.ndarray
    halves: np.ndarray
    ball: float = 0.0

    @classmethod
    def none(cls, n: int, k: int) -> Spread:
        """The path itself."""
        return cls(np.zeros((n, k)), np.zeros((n, k)), np.zeros((n, 3)), np.zeros((n, 3)))


class Enclosed(NamedTuple):
    """What is proven of joints within intervals.

    Attributes:
        box: (n, k) [rad or m] how far each joint is off its shifted cubic at most; infinite where nothing is
            proven.
        middle: (n, k) the joints of the shifted cubics at the middle.
    """

    box: np.ndarray
    middle: np.ndarray
    variation: _Variation

    def is_unique(self, arm: Arm, box: np.ndarray) -> np.ndarray:
        """(n,) True where no two q within boxes (n, k) hold the tool at the same pose of the spread.

        N contracts there, so that two would be nearer to each other than they are.
        """
        return np.asarray(self.variation.bound(arm, box).sum(axis=2).max(axis=1) < 0.999)


def deviations(arm: Arm, stretch: Stretch, given: Intervals, free: np.ndarray) -> np.ndarray:
    """(n, k) [rad or m] how far each joint is off its cubic at most; infinite where nothing is proven.

    Args:
        free: (k,) the joints that follow the path; the others are on their cubics by definition.
    """
    return enclosed(arm, stretch, given, free, Spread.none(*given.before.shape)).box


def enclosed(
    arm: Arm, stretch: Stretch, given: Intervals, free: np.ndarray, spread: Spread
) -> Enclosed:
    """What is proven of the joints that hold the tool at any pose of a spread about the path."""
    half = 0.5 * given.lengths[:, None]
    joints, strokes = cubic_series(given, half), stroke_series(given, half)
    joints[0] += spread.joints
    turn, origin = arm.series(joints)
    of_point, of_turn = _shifted(strokes, spread)
    path_turn, path_origin = stretch.series(of_point, of_turn)
    own_turn = path_turn[0]
    if given.carried is not None:
        path_turn, path_origin = given.carried.seen(path_turn, path_origin)
    between = matrix_product(np.swapaxes(path_turn, 2, 3), turn)
    off = np.concatenate([origin - path_origin, half_skew(between)], axis=2)
    _, rates = arm.tool.poses_and_rates(joints[0])
    rates[:, 3:] = np.swapaxes(path_turn[0], 1, 2) @ rates[:, 3:]
    inverse, is_regular = _inverses(rates, free)
    within = np.abs(joints[1:]).sum(axis=0)
    longest = arm.longest(np.concatenate([given.before, given.after]))
    longest += float(arm.sums(within.max(axis=0, initial=0.0))[1])
    longest += float(arm.sums(np.abs(spread.joints))[1].max(initial=0.0))
    unknown = _remainders(arm, stretch, joints, strokes, longest, given.carried)
    error = greatest((inverse @ off[..., None])[..., 0])
    error += (np.abs(inverse) @ unknown[..., None])[..., 0]
    error += (np.abs(inverse @ rates) @ spread.held[..., None])[..., 0]
    sizes = np.linalg.norm(inverse.reshape(*inverse.shape[:2], 2, 3), axis=3).transpose(2, 0, 1)
    off_middle = 1.1 * greatest(half_skew(between)).sum(axis=1)
    by_spread, turned = _of_spread(
        stretch, spread, of_point, inverse, sizes, own_turn, off_middle, given.carried
    )
    varied = np.einsum("nkc,ncji->nkji", inverse, arm.second_rates(joints[0], path_turn[0]))
    variation = _Variation(np.abs(varied), sizes, within, off_middle + turned, longest)
    box = _closed(arm, error + by_spread, variation, is_regular, free, spread.held)
    return Enclosed(box, joints[0], variation)


def _shifted(strokes: np.ndarray, spread: Spread) -> tuple[np.ndarray, np.ndarray]:
    """The strokes of the point and of the rotation at the middle of a spread."""
    of_point, of_turn = strokes.copy(), strokes.copy()
    of_point[0] += spread.shifts[:, :1] * np.array([1.0, -1.0])
    of_turn[0] += spread.shifts[:, 1:]
    return of_point, of_turn


def _of_spread(
    stretch: Stretch,
    spread: Spread,
    of_point: np.ndarray,
    inverse: np.ndarray,
    sizes: np.ndarray,
    own_turn: np.ndarray,
    off: np.ndarray,
    carried: Carried | None,
) -> tuple[np.ndarray, np.ndarray]:
    """(n, k) what the poses of a spread add to |Y F|, and (n,) [rad] how far they are turned from its middle.

    A point that goes by s along strokes whose ways bend is off s times their slopes at the middle by how far the
    slopes change, and by how far what carries them turns. A stroke by a turns the tool by a w1 about an axis that
    the second stroke turns by up to |w2|; two turns come to their sum but for half the product, and their sine but
    for half their product with how far the tool is off the middle.
    """
    s, a, b = spread.halves.T
    own = np.linalg.norm(stretch.turns, axis=1)
    seen = stretch.turns @ own_turn
    slopes = [way.slopes(of_point[0, :, k]) for k, way in enumerate(stretch.ways)]
    across = slopes[0] - slopes[1]
    bends = np.array([way.bend for way in stretch.ways])
    bent = s * (np.abs(of_point[1:]).sum(axis=0) @ bends + 0.5 * s * bends.sum())
    if carried is not None:
        bent += s * np.linalg.norm(across, axis=1) * carried.turned
        across = (carried.turn[0] @ across[..., None])[..., 0]
    by_way = np.abs(inverse[:, :, :3] @ across[..., None])[..., 0]
    by_turn = np.abs(np.einsum("nkc,nac->ank", inverse[:, :, 3:], seen))
    turned = a * own[0] + b * own[1] + (0.0 if carried is None else carried.off[1])
    rest = turned * (turned + off) + own[0] * own[1] * a
    found = s[:, None] * by_way + a[:, None] * by_turn[0] + b[:, None] * by_turn[1]
    return found + sizes[0] * (bent + spread.ball)[:, None] + sizes[1] * rest[:, None], turned


def cubic_series(given: Intervals, half: np.ndarray) -> np.ndarray:
    """(ORDER + 1, n, k) the series of the cubics about the middle, in halves of the interval."""
    a, b = given.before, given.after
    va, vb = half * given.rates[0], half * given.rates[1]
    found = np.zeros((ORDER + 1, *a.shape))
    found[0] = 0.5 * (a + b) + 0.25 * (va - vb)
    found[1] = 0.75 * (b - a) - 0.25 * (va + vb)
    found[2] = 0.25 * (vb - va)
    found[3] = 0.25 * (va + vb) - 0.25 * (b - a)
    return found


def stroke_series(given: Intervals, half: np.ndarray) -> np.ndarray:
    """(ORDER + 1, n, 2) the series of the strokes about the middle."""
    share, rate, change = given.strokes
    found = np.zeros((ORDER + 1, *share.shape))
    found[0] = share + half * (rate + 0.5 * change * half)
    found[1] = half * (rate + change * half)
    found[2] = 0.5 * change * half**2
    return found


def _inverses(seen: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n, k, 6) the inverse of the Jacobian, turns seen from the path, and (n,) where there is one.

    Joints beyond six, and those that are not free, take no part: their rows of the bordered inverse are dropped.
    """
    n, _, k = seen.shape
    own = seen[:, :, free]
    found = np.zeros((n, k, 6))
    sizes = np.linalg.svd(own, compute_uv=False)
    is_regular = sizes[:, -1] > 1e-9 * sizes[:, 0]
    found[np.ix_(is_regular, free)] = np.linalg.pinv(own[is_regular])
    return found, is_regular


def _remainders(
    arm: Arm,
    stretch: Stretch,
    joints: np.ndarray,
    strokes: np.ndarray,
    longest: float,
    carried: Carried | None,
) -> np.ndarray:
    """(n, 6) [m] and [-] what the series leave out and round away."""
    turned, lengths = arm.sums(moved(joints))
    turn = majorant_of_turns(turned)
    lengths[0] = longest
    path_turn, path_origin = stretch.majorants(strokes)
    way, angle = ROUNDING * longest, ROUNDING
    if carried is not None:
        path_origin[0] += stretch.farthest
        path_turn, path_origin = carried.majorants(path_turn, path_origin)
        way = way + carried.off[0] + (carried.off[1] + ROUNDING) * path_origin[0][:, None]
        angle += carried.off[1]
    found = np.empty((joints.shape[1], 6))
    found[:, :3] = (product(turn, lengths) + path_origin)[-1][:, None] + way
    found[:, 3:] = product(turn, path_turn)[-1][:, None] + angle
    return found


class _Variation(NamedTuple):
    """How the Jacobian varies about the middle of an interval.

    Attributes:
        by_joint: (n, k, k, k) |Y H|: row, column, and the joint by which the column changes.
        sizes: (2, n, k) lengths of the rows of Y, for ways and for turns. within: (n, k) [rad or m] how far
            joints go from the middle on their cubics.
        off: (n,) [rad] how far the tool may be turned from the path. longest: [m] of the arm.
    """

    by_joint: np.ndarray
    sizes: np.ndarray
    within: np.ndarray
    off: np.ndarray
    longest: float

    def bound(self, arm: Arm, box: np.ndarray) -> np.ndarray:
        """(n, k, k) K for joints within boxes (n, k) about the cubics.

        The first derivatives of columns are those at the middle; the second are at most the arm's length, or 1
        for turns. With the tool turned by b from the path, the sine's skew part changes with a turn w seen from
        the tool by B w, and B - 1 is at most b / 2 + b^2 / 2; at the middle w is seen from the path, off by b.
        """
        ways = self.within + box
        turned, slid = arm.sums(ways)
        off = self.off + arm.sums(box)[0]
        longest = self.longest + arm.sums(box)[1]
        by_way = 0.5 * turned * (longest * turned + 2.0 * slid)
        by_turn = 0.5 * (turned**2 + off + off**2) + self.off
        of_way, of_turn = self.sizes[0] * by_way[:, None], self.sizes[1] * by_turn[:, None]
        found = np.einsum("nkji,ni->nkj", self.by_joint, ways)
        for one in arm.chain.joints:
            size = abs(one.factor)
            if one.turns:
                found[:, :, one.column] += size * (of_way + of_turn)
            else:
                found[:, :, one.column] += size * self.sizes[0] * (0.5 * turned**2)[:, None]
        return found


def _closed(
    arm: Arm,
    error: np.ndarray,
    variation: _Variation,
    is_regular: np.ndarray,
    free: np.ndarray,
    held: np.ndarray,
) -> np.ndarray:
    """(n, k) boxes r with e + K r < r, or infinite; as `held` (n, k) for joints that are not free."""
    box = np.where(free, 2.0 * error, held)
    for _ in range(3):
        change = variation.bound(arm, box)[:, free]
        by_held = (change @ np.where(free, 0.0, held)[..., None])[..., 0]
        box = np.where(free, _grown(change[:, :, free], error, by_held, free), held)
    change = variation.bound(arm, box)[:, free]
    mapped = error[:, free] + (change @ box[..., None])[..., 0]
    is_proven = (mapped < box[:, free]).all(axis=1) & is_regular
    return np.where(is_proven[:, None], box, np.where(free, np.inf, held))


def _grown(
    change: np.ndarray, error: np.ndarray, by_held: np.ndarray, free: np.ndarray
) -> np.ndarray:
    """(n, k) the least boxes r with e + K r = r, a little wider; as wide as 1 where there are none.

    Args:
        by_held: (n, free) what joints that are not free add to e.
    """
    found = np.zeros_like(error)
    margin = np.eye(int(free.sum())) - change
    contracts = change.sum(axis=2).max(axis=1, initial=0.0) < 1.0
    margin[~contracts] = np.eye(margin.shape[1])
    solved = np.linalg.solve(margin, (error[:, free] + by_held)[..., None])[..., 0]
    found[:, free] = np.where(contracts[:, None], solved * (1.0 + 1e-6) + 1e-300, 1.0)
    return found
