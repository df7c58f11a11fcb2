"""Distances between a shape and an outline at many points, with their change by every number of the shape.

A row says: this far inside here (negative: outside), and so much more for each number. The first order is exact,
since the foot of a shortest line may move along its curve at no cost. Not for: certified distances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.profiles.pieces import Pieces
from clearance.profiles.region import Region, holds


class Rows(NamedTuple):
    """Attributes: distance (k,) with its sign; slope (k, n) by the shape's numbers; point (k, 2) where."""

    distance: np.ndarray
    slope: np.ndarray
    point: np.ndarray


class Slope(NamedTuple):
    """Two neighbouring shapes, how far apart one of their numbers is (0 where it cannot change), and the change
    of the area for each unit of it."""

    behind: Pieces
    ahead: Pieces
    width: float
    area: float = 0.0


def sides_of(pieces: Pieces, region: Region) -> np.ndarray:
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
    return np.where(holds(region, pieces.point(longest, half) + step), 1.0, -1.0)


def rows_of_shape(here: Pieces, slopes, outline: Pieces, sides, samples) -> Rows:
    """Rows of the shape's places `samples` (pieces, shares), positive inside the outline."""
    own = here.point(*samples)
    distance, normal, _ = _measured(outline, sides, own)
    return Rows(distance, _slope(slopes, samples, normal), own)


def rows_of_outline(here: Pieces, slopes, sides, given: np.ndarray) -> Rows:
    """Rows of the outline's points `given` (k, 2), positive inside the shape."""
    distance, normal, at = _measured(here, sides, given)
    return Rows(distance, -_slope(slopes, at, normal), given)


def joined_rows(*parts: Rows) -> Rows:
    """All rows of several."""
    return Rows(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _measured(curve: Pieces, sides: np.ndarray, points: np.ndarray):
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


def _slope(slopes: list[Slope], places, normal: np.ndarray) -> np.ndarray:
    """(k, n) how fixed places of the shape move along `normal`."""
    columns = []
    for behind, ahead, width, _ in slopes:
        moved = ahead.point(*places) - behind.point(*places) if width else np.zeros_like(normal)
        columns.append((moved * normal).sum(axis=1) / (width or 1.0))
    return np.stack(columns, axis=1)
