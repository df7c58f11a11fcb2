"""How far one curve strays from another along its length: the profile that a report shows.

Distances are exact at each sample (nearest point, certified); between samples they change by no more than
the length between, which `spacing` states. Not for: the greatest distance, which `hausdorff` gives exactly.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.kernels.curve.feet import feet
from clearance.planar.curve import Curve
from clearance.planar.directed import placed
from clearance.planar.entries import BadCurve, checked_number
from clearance.tolerance import EXCURSION, LAST_BITS

MOST_PARTS = 16
"""Parts that a stretch is cut into at once where an excursion could hide in it: more would often be too many."""


@dataclass(frozen=True)
class Deviation:
    """The distance of points along curve a from curve b.

    Attributes:
        parameter: (n,) parameters on a, increasing.
        arc_length: (n,) length along a from its start, by chords.
        distance: (n,) distance of each point from b.
        point, foot: (n, 2) the points and their nearest points on b.
        contour: (n,) contour of a that each point lies on.
        beyond: (k, 2) parameter intervals of a, one contour each, where the distance exceeds `limit`; their
            ends are bisected to the last bit. Neither an excursion nor a dip that passes
            the limit by more than `tolerance.EXCURSION` of both curves' size is missed, however few the samples;
            an excess by rounding alone does not count.
        limit: the limit, or None.
    """

    parameter: np.ndarray
    arc_length: np.ndarray
    distance: np.ndarray
    point: np.ndarray
    foot: np.ndarray
    contour: np.ndarray
    beyond: np.ndarray
    limit: float | None

    @cached_property
    def spacing(self) -> float:
        """The largest length between neighbouring samples: the profile misses at most half of it."""
        return float(np.diff(self.arc_length).max(initial=0.0))

    @cached_property
    def _share(self) -> np.ndarray:
        step = np.diff(self.arc_length)
        return 0.5 * (np.append(step, 0.0) + np.append(0.0, step))

    @property
    def mean(self) -> float:
        """The mean distance by length of a (trapezoidal rule)."""
        return float((self._share @ self.distance) / self._share.sum())

    def percentile(self, share: float) -> float:
        """The distance that `share` percent of a's length stays within.

        Raises: BadCurve, NotFinite (a share that is not from 0 to 100).
        """
        share = checked_number(share, "share", least=0.0)
        if share > 100.0:
            raise BadCurve(f"{share:g}", where="share", valid="0 to 100 percent")
        order = np.argsort(self.distance, kind="stable")
        reached = np.cumsum(self._share[order])
        k = np.searchsorted(reached, 0.01 * share * reached[-1])
        return float(self.distance[order[min(k, len(order) - 1)]])


def deviation(a: Curve, b: Curve, *, limit: float | None = None, samples: int = 1000) -> Deviation:
    """The distance profile of `a` from `b`, at about `samples` points spread by length, all joints among them.

    Raises: BadCurve, NotFinite (limit or samples).
    """
    limit = None if limit is None else checked_number(limit, "limit", least=0.0)
    samples = int(checked_number(samples, "samples", least=2))
    which, local = _spread(a, samples)
    point, found = _measured(a, b, which, local)
    distance = found[:, 0]
    foot = b._jets(found[:, 2].astype(np.int64), found[:, 3].copy())[:, :2] + b.origin
    low, high = a.limits[which].T
    parameter = low + local * (high - low)
    step = np.hypot(*np.diff(point, axis=0).T)
    contour = a.contour[which]
    step[np.diff(contour) != 0] = 0.0
    beyond = np.empty((0, 2))
    if limit is not None:
        passed = limit + a.rounding + b.rounding + LAST_BITS * placed(a, b)[1]
        beyond = _beyond(a, b, *_refined(a, b, which, local, distance, passed), passed)
    length = np.concatenate([[0.0], np.cumsum(step)])
    return Deviation(parameter, length, distance, point, foot, contour, beyond, limit)


def _spread(a: Curve, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Pieces and local parameters of the samples: each leaf gets its share by chord length."""
    chord = a.leaf_chords
    which, local = a.spread_on_leaves(
        np.maximum(1, np.ceil(chord / chord.sum() * samples)).astype(int)
    )
    last = np.flatnonzero(np.append(np.diff(a.contour[which]) != 0, True))
    return np.insert(which, last + 1, which[last]), np.insert(local, last + 1, 1.0)


def _measured(
    a: Curve, b: Curve, which: np.ndarray, local: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 2) of a, and the distance, its lower bound, piece and local parameter (n, 4) of b's nearest."""
    shift, _ = placed(a, b)
    own = a._jets(which, local)[:, :2]
    found = np.empty((len(own), 4))
    feet(b.pieces, b.leaves, np.ascontiguousarray(own + shift), found)
    return own + a.origin, found


def _refined(
    a: Curve,
    b: Curve,
    which: np.ndarray,
    local: np.ndarray,
    distance: np.ndarray,
    limit: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The samples, with more of them wherever an excursion beyond `limit`, or back, could hide between two.

    The distance changes by no more than the length run through, at most `_fastest` times the parameter.
    """
    enough = EXCURSION * placed(a, b)[1]
    fastest = _fastest(a)
    while True:
        width = np.where(np.diff(which) == 0, np.diff(local), 1.0 - local[:-1])
        middle = 0.5 * (distance[:-1] + distance[1:]) - limit
        same = (distance[:-1] > limit) == (distance[1:] > limit)
        needed = 0.5 * fastest[which[:-1]] * width / (np.abs(middle) + enough)
        k = np.flatnonzero(same & (needed > 1.0))
        if not len(k):
            return which, local, distance
        parts = np.clip(np.ceil(needed[k]), 2, MOST_PARTS).astype(int)
        k = np.repeat(k, parts - 1)
        rank = np.arange(len(k)) - np.repeat(np.cumsum(parts - 1) - parts, parts - 1)
        between = local[k] + width[k] * rank / np.repeat(parts, parts - 1)
        found = _measured(a, b, which[k], between)[1][:, 0]
        which = np.insert(which, k + 1, which[k])
        local, distance = np.insert(local, k + 1, between), np.insert(distance, k + 1, found)


def _fastest(curve: Curve) -> np.ndarray:
    """(n,) a bound of each piece's speed by its local parameter (Floater 1992: the weights' ratio squared)."""
    control, first = curve.pieces.control, curve.pieces.first
    step = np.hypot(*np.diff(control[:, :2] / control[:, 2:], axis=0).T)
    inside = np.ones(len(step), bool)
    inside[first[1:-1] - 1] = False
    longest = np.maximum.reduceat(np.where(inside, step, 0.0), first[:-1])
    weight = control[:, 2]
    ratio = np.maximum.reduceat(weight, first[:-1]) / np.minimum.reduceat(weight, first[:-1])
    return np.diff(first - np.arange(len(first))) * longest * ratio**2


def _beyond(
    a: Curve,
    b: Curve,
    which: np.ndarray,
    local: np.ndarray,
    distance: np.ndarray,
    limit: float,
) -> np.ndarray:
    """The intervals of a's parameter beyond `limit`, from the samples, their ends bisected."""
    out, same = distance > limit, np.diff(a.contour[which]) == 0
    low, high = a.limits[which].T
    parameter = low + local * (high - low)
    up, down = (
        np.flatnonzero(~out[:-1] & out[1:] & same),
        np.flatnonzero(out[:-1] & ~out[1:] & same),
    )
    inside, outside = np.append(up, down + 1), np.append(up + 1, down)
    crossed = _crossings(a, b, parameter[inside], parameter[outside], limit)
    starts, stops = parameter.copy(), parameter.copy()
    starts[up + 1], stops[down] = crossed[: len(up)], crossed[len(up) :]
    first = out & np.append(True, ~out[:-1] | ~same)
    last = out & np.append(~out[1:] | ~same, True)
    return np.stack([starts[first], stops[last]], axis=1)


def _crossings(
    a: Curve, b: Curve, inside: np.ndarray, outside: np.ndarray, limit: float
) -> np.ndarray:
    """The crossings of `limit` between pairs of parameters, all bisected at once; on the outer side."""
    outside = outside.copy()
    inside, going = inside.copy(), np.arange(len(inside))
    for _ in range(60):
        middle = 0.5 * (inside[going] + outside[going])
        fresh = (middle != inside[going]) & (middle != outside[going])
        going, middle = going[fresh], middle[fresh]
        if not len(going):
            break
        beyond = _measured(a, b, *a.locate(middle))[1][:, 0] > limit
        outside[going[beyond]] = middle[beyond]
        inside[going[~beyond]] = middle[~beyond]
    return outside
