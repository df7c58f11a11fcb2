"""Distances between a shape and an outline at many points, with their change by every number of the shape.

A row says: this far apart here (with a sign), and so much more for each number. The first order is exact, since
the foot of a shortest line may move along its curve at no cost. Not for: certified distances.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.planar.curve import Curve
from clearance.profiles.fit_shape import Placed
from clearance.profiles.outline_file import Drawn
from clearance.profiles.region import holds


class Rows(NamedTuple):
    """Attributes: distance (k,) with its sign; slope (k, n) by the shape's numbers; point (k, 2) where."""

    distance: np.ndarray
    slope: np.ndarray
    point: np.ndarray


class Table:
    """A curve as dense points in a tree, to find feet from."""

    def __init__(self, curve: Curve, per_piece: int) -> None:
        from scipy.spatial import cKDTree

        self.curve = curve
        share = (np.arange(per_piece) + 0.0) / per_piece
        low, high = curve.limits.T
        inner = (low[:, None] + (high - low)[:, None] * share).ravel()
        self.parameter = np.append(inner, high[-1])
        self.step = np.append(np.repeat((high - low) / per_piece, per_piece), 0.0)
        self.point = curve.point(self.parameter)
        self._tree = cKDTree(self.point)

    def feet(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Parameters (k,) and feet (k, 2) near points: the nearest of the table, then Newton's method."""
        _, at = self._tree.query(points)
        start = self.parameter[at]
        reach = np.maximum(self.step[at], self.step[np.maximum(at - 1, 0)])
        best, foot = start.copy(), self.point[at].copy()
        least = ((points - foot) ** 2).sum(axis=1)
        parameter = start.copy()
        for side in (0.5, -0.5):  # a joint belongs to two pieces: one start on either
            parameter = np.clip(start + side * reach, *self.curve.limits[[0, -1], [0, 1]])
            for _ in range(4):
                parameter = self._stepped(points, parameter, start, reach)
                there = self.curve.point(parameter)
                off = ((points - there) ** 2).sum(axis=1)
                better = off < least
                best[better], foot[better] = parameter[better], there[better]
                least = np.minimum(off, least)
        return best, foot

    def _stepped(self, points, parameter, start, reach) -> np.ndarray:
        speed = self.curve.derivative(parameter)
        off = self.curve.point(parameter) - points
        slope = (off * speed).sum(axis=1)
        bend = (speed**2).sum(axis=1) + (off * self.curve.derivative(parameter, 2)).sum(axis=1)
        safe = np.where(bend > 0.1 * (speed**2).sum(axis=1), bend, (speed**2).sum(axis=1))
        moved = parameter - slope / np.where(safe > 0.0, safe, 1.0)
        return np.clip(
            np.clip(moved, start - reach, start + reach), *self.curve.limits[[0, -1], [0, 1]]
        )


def normals(
    curve: Curve, parameter: np.ndarray, points: np.ndarray, foot: np.ndarray
) -> np.ndarray:
    """(k, 2) unit directions from foot to point, to the left of the curve where they coincide."""
    along = curve.derivative(parameter)
    left = np.stack([-along[:, 1], along[:, 0]], axis=1)
    left /= np.maximum(np.hypot(*left.T), 1e-300)[:, None]
    off = points - foot
    length = np.hypot(*off.T)
    near = length <= 1e-7 * curve.size
    side = np.where((off * left).sum(axis=1) < 0.0, -1.0, 1.0)
    return np.where(near[:, None], left, off / np.where(near, 1.0, length)[:, None] * side[:, None])


class Sides:
    """For each contour of a curve 1 where its inside is on the left, -1 where it is on the right."""

    def __init__(self, curve: Curve, name: str) -> None:
        region = Drawn(name, curve).region
        firsts = np.flatnonzero(np.diff(curve.contour, prepend=-1))
        middle = curve.limits[firsts].mean(axis=1)
        along = curve.derivative(middle)
        left = np.stack([-along[:, 1], along[:, 0]], axis=1) / np.hypot(*along.T)[:, None]
        inside = holds(region, curve.point(middle) + 1e-5 * curve.size * left)
        self._sign = np.where(inside, 1.0, -1.0)
        self._curve = curve

    def at(self, curve: Curve, parameter: np.ndarray) -> np.ndarray:
        """(k,) the sign at parameters of a curve with the same contours."""
        return self._sign[curve.contour[curve.locate(parameter)[0]]]


def outline_rows(here: Placed, slopes, outline: Table, sides: Sides, samples: np.ndarray) -> Rows:
    """Rows of the shape's points at the parameters `samples` against the outline, positive inside it."""
    own = here.curve.point(samples)
    at, foot = outline.feet(own)
    normal = normals(outline.curve, at, own, foot) * sides.at(outline.curve, at)[:, None]
    return Rows(((own - foot) * normal).sum(axis=1), _slope(slopes, samples, normal), own)


def shape_rows(here: Placed, slopes, sides: Sides, given: np.ndarray) -> Rows:
    """Rows of the outline's points `given` (k, 2) against the shape, positive inside it."""
    at, foot = Table(here.curve, 16).feet(given)
    normal = normals(here.curve, at, given, foot) * sides.at(here.curve, at)[:, None]
    return Rows(((given - foot) * normal).sum(axis=1), -_slope(slopes, at, normal), given)


def joined_rows(parts: list[Rows]) -> Rows:
    """All rows of several."""
    return Rows(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _slope(slopes, parameter: np.ndarray, normal: np.ndarray) -> np.ndarray:
    """(k, n) how points at fixed parameters of the shape move along `normal`."""
    columns = []
    for behind, ahead, width in slopes:
        moved = ahead.curve.point(parameter) - behind.curve.point(parameter)
        columns.append((moved * normal).sum(axis=1) / width if width else np.zeros(len(normal)))
    return np.stack(columns, axis=1)
