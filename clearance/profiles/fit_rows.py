"""Distances between a shape and an outline at many points, with their change by every number of the shape.

A row says: this far inside here (negative: outside), and so much more for each number. The first order is exact,
since the foot of a shortest line may move along its curve at no cost. Distances are measured at all points, slopes
only at those that matter. Not for: certified distances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.profiles.pieces import ContourPieces
from clearance.profiles.region import Region, contains


class FitRows(NamedTuple):
    """Attributes: distance (k,) with its sign; slope (k, n) by the shape's numbers; point (k, 2) where."""

    distance: np.ndarray
    slope: np.ndarray
    point: np.ndarray


class Gaps(NamedTuple):
    """Rows before their slopes are known.

    Attributes:
        distance: (k,) with its sign. point: (k, 2) where.
        normal: (k, 2) how the distance changes when the shape's own place moves.
        piece, share: (k,) the shape's own place.
        at_corner: (k,) whether the foot is where two pieces of the other curve meet.
    """

    distance: np.ndarray
    point: np.ndarray
    normal: np.ndarray
    piece: np.ndarray
    share: np.ndarray
    at_corner: np.ndarray

    def at(self, chosen: np.ndarray) -> Gaps:
        """Only the chosen ones."""
        return Gaps(*(column[chosen] for column in self))

    def signed(self, sign: float) -> Gaps:
        """The other side counted positive where `sign` is -1."""
        return self._replace(distance=sign * self.distance, normal=sign * self.normal)

    def without(self, omitted: np.ndarray, far: float) -> Gaps:
        """The same, those `omitted` (k,) put so `far` that they do not matter."""
        return self._replace(distance=self.distance + far * omitted)


class FitSlope(NamedTuple):
    """Two neighbouring shapes, the difference of one of their numbers (0 where it cannot change), and the change
    of the area for each unit of it."""

    behind: ContourPieces
    ahead: ContourPieces
    width: float
    area: float = 0.0

    def moved(self, gaps: Gaps, own: np.ndarray) -> np.ndarray:
        """(k, 2) how the places `own` of the shape move for each unit of the number."""
        if not self.width:
            return np.zeros_like(own)
        ahead = self.ahead.point(gaps.piece, gaps.share)
        return (ahead - self.behind.point(gaps.piece, gaps.share)) / self.width


class RigidSlope(NamedTuple):
    """The shape as a whole: by `shift` (2,) for each unit, and turned to the left about `pivot` (2,)."""

    shift: np.ndarray
    pivot: np.ndarray
    turn: float = 0.0
    area: float = 0.0

    def moved(self, gaps: Gaps, own: np.ndarray) -> np.ndarray:
        """(k, 2) how the places `own` of the shape move for each unit of the number."""
        arm = own - self.pivot
        return self.shift + self.turn * np.stack([-arm[:, 1], arm[:, 0]], axis=1)


def sides_of(pieces: ContourPieces, region: Region) -> np.ndarray:
    """For each contour 1 where its inside is on the left, -1 where it is on the right."""
    length = np.hypot(*(pieces.end - pieces.start).T)
    longest = np.array(
        [
            np.flatnonzero(pieces.owner == k)[np.argmax(length[pieces.owner == k])]
            for k in np.unique(pieces.owner)
        ]
    )
    half = np.full(len(longest), 0.5)
    step = 1e-5 * pieces.size * pieces.left(longest, half)
    return np.where(contains(region, pieces.point(longest, half) + step), 1.0, -1.0)


def gaps_of_shape(outline: ContourPieces, sides: np.ndarray, here: ContourPieces, samples) -> Gaps:
    """Gaps of the shape's places `samples` (pieces, shares), positive inside the outline."""
    own = here.point(*samples)
    distance, normal, (_, foot) = _measured(outline, sides, own)
    piece, share = samples
    return Gaps(distance, own, normal, piece, share, at_corner(foot))


def gaps_of_outline(here: ContourPieces, sides: np.ndarray, given: np.ndarray) -> Gaps:
    """Gaps of the outline's points `given` (k, 2), positive inside the shape."""
    distance, normal, (piece, share) = _measured(here, sides, given)
    return Gaps(distance, given, -normal, piece, share, at_corner(share))


def at_corner(share: np.ndarray) -> np.ndarray:
    """Whether places on pieces are ends of theirs."""
    return np.abs(share - 0.5) >= 0.5 - 1e-9


def joined_gaps(*parts: Gaps) -> Gaps:
    """All gaps of several."""
    return Gaps(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def rows_of(gaps: Gaps, here: ContourPieces, slopes: list[FitSlope | RigidSlope]) -> FitRows:
    """Gaps of the shape `here` with their slopes."""
    own = here.point(gaps.piece, gaps.share)
    columns = [(slope.moved(gaps, own) * gaps.normal).sum(axis=1) for slope in slopes]
    return FitRows(gaps.distance, np.stack(columns, axis=1), gaps.point)


def _measured(curve: ContourPieces, sides: np.ndarray, points: np.ndarray):
    """Distance of points inside a curve, the direction in which it grows, and where their feet are."""
    piece, share, foot = curve.feet(points)
    left = curve.left(piece, share)
    off = points - foot
    length = np.hypot(*off.T)
    near = length <= 1e-7 * curve.size
    side = np.where((off * left).sum(axis=1) < 0.0, -1.0, 1.0)
    away = off / np.where(near, 1.0, length)[:, None] * side[:, None]
    normal = np.where(near[:, None], left, away) * sides[curve.owner[piece]][:, None]
    return (off * normal).sum(axis=1), normal, (piece, share)
