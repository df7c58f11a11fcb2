"""The one curve type: contours of Bézier pieces, polynomial or rational, open or closed.

Lines, arcs, polylines, B-splines and NURBS all become such pieces when they are made, and everything is
checked there: a `Curve` that exists is finite, has extent and positive weights. Pieces are stored about an
origin of the curve's own, so that a curve 1e6 away loses no digits. Not for: distances.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clearance.kernels.curve.bezier import HIGHEST_DEGREE, Pieces, piece_spans, pieces_of_spline
from clearance.ordered import ascending
from clearance.planar.curve_facts import CurveFacts
from clearance.planar.entries import (
    BadCurve,
    checked_knots,
    checked_points,
    checked_transform,
    checked_weights,
    sweep_of,
)
from clearance.tolerance import CURVE_SIZES, MEETING, PARAMETER

if TYPE_CHECKING:
    from numpy.typing import ArrayLike


@dataclass(frozen=True, eq=False)
class Curve(CurveFacts):
    """One or more contours of Bézier pieces in the plane, in the caller's unit of length.

    Attributes:
        pieces: homogeneous control points about `origin`.
        origin: (2,) what to add to every coordinate of `pieces`.
        limits: (n, 2) the parameter interval of each piece; contours follow one another.
        contour: (n,) the contour that each piece belongs to.

    Make one by the class methods; the constructor itself checks nothing.
    """

    @classmethod
    def line(cls, start: ArrayLike, end: ArrayLike) -> Curve:
        """The segment between two points; parameter 0 to 1."""
        return cls.polyline([start, end])

    @classmethod
    def polyline(cls, points: ArrayLike | Sequence[ArrayLike], *, closed: bool = False) -> Curve:
        """The polyline through `points` (n, 2), n >= 2; vertex i has the parameter i.

        `closed` adds the segment back to the first point. Repeated points are passed over.

        Raises: BadShape, NotFinite, BadCurve (fewer than two points, no extent).
        """
        vertices = checked_points(points, "points", least=2)
        if closed and np.any(vertices[0] != vertices[-1]):
            vertices = np.concatenate([vertices, vertices[:1]])
        x, y = vertices.T
        box = np.array([[x.min(), y.min()], [x.max(), y.max()]])
        checked_size(box[1] - box[0])
        origin = origin_of(box)
        step = np.flatnonzero((x[1:] != x[:-1]) | (y[1:] != y[:-1]))
        n = len(step)
        control, limits = np.empty((n, 2, 3)), np.empty((n, 2))
        for end in range(2):
            control[:, end, 0] = x[step + end] - origin[0]
            control[:, end, 1] = y[step + end] - origin[1]
            limits[:, end] = step + end
        control[:, :, 2] = 1.0
        pieces = Pieces(control.reshape(-1, 3), 2 * np.arange(n + 1), np.zeros(n, bool))
        return cls(pieces, origin, limits, np.zeros(n, np.int64))

    @classmethod
    def bspline(
        cls,
        control: ArrayLike,
        degree: int = 3,
        knots: ArrayLike | None = None,
        weights: ArrayLike | None = None,
    ) -> Curve:
        """The B-spline or NURBS of `control` (n, 2), over [knots[degree], knots[n]].

        Args:
            control: (n, 2) control points, n > degree.
            degree: 1 to 24.
            knots: (n + degree + 1,) non-decreasing; None for clamped uniform on [0, 1].
            weights: (n,) positive, within 1e6 times of each other; None for a polynomial spline.

        Raises: BadShape, NotFinite, BadCurve.
        """
        degree = _checked_degree(degree)
        points = checked_points(control, "control", least=degree + 1)
        weight = checked_weights(weights, len(points))
        knot = checked_knots(knots, len(points), degree)
        base = origin_of(points)
        weighted = np.column_stack([(points - base) * weight[:, None], weight])
        rows, limits = pieces_of_spline(weighted, knot, degree)
        rows[:, :2] /= rows[:, 2:]
        return cls(*assembled(rows, np.arange(len(limits) + 1) * (degree + 1), limits, base=base))

    @classmethod
    def bezier(cls, control: ArrayLike, weights: ArrayLike | None = None) -> Curve:
        """The Bézier curve of `control` (n, 2), of degree n - 1, with optional `weights`; parameter 0 to 1."""
        points = checked_points(control, "control", least=2)
        _checked_degree(len(points) - 1)
        rows = np.empty((len(points), 3))
        rows[:, :2], rows[:, 2] = points, checked_weights(weights, len(points))
        return cls(*assembled(rows, np.array([0, len(points)]), np.array([[0.0, 1.0]])))

    @classmethod
    def arc(cls, center: ArrayLike, radius: float, start: float, end: float) -> Curve:
        """The arc about `center` from the angle `start` to `end` [rad], clockwise where `end` < `start`.

        It is exact: rational quadratics of at most a quarter turn; the parameter runs from 0 to 1.

        Raises: BadShape, NotFinite, BadCurve (radius not positive, sweep 0 or beyond a full turn).
        """
        middle, radius, sweep = sweep_of(center, radius, start, end)
        n = max(1, math.ceil(abs(sweep) / (0.5 * math.pi) - PARAMETER))
        half = 0.5 * sweep / n
        angles = start + half * np.arange(2 * n + 1)
        turn = np.stack([np.cos(angles), np.sin(angles)], axis=1)
        turn[1::2] /= math.cos(half)
        if abs(sweep) == 2.0 * math.pi:
            turn[-1] = turn[0]
        rows = np.empty((3 * n, 3))
        for k in range(3):
            rows[k::3, :2] = radius * turn[k : 2 * n - 1 + k : 2]
            rows[k::3, 2] = math.cos(half) if k == 1 else 1.0
        low = np.arange(n) / n
        limits = np.stack([low, low + 1.0 / n], axis=1)
        return cls(*assembled(rows, np.arange(n + 1) * 3, limits, base=middle))

    @classmethod
    def circle(cls, center: ArrayLike, radius: float) -> Curve:
        """The whole circle, counter-clockwise from the angle 0; parameter 0 to 1."""
        return cls.arc(center, radius, 0.0, 2.0 * math.pi)

    @classmethod
    def chain(cls, parts: Sequence[Curve]) -> Curve:
        """The parts one after the other as one contour; each must start where the last ended.

        The parameter continues: each part keeps its length of parameter. Gaps between ends up to 1e-9 of the size
        are accepted and stay.

        Raises: BadCurve where two parts do not meet, or there is none.
        """
        return cls(*joined(parts, together=True))

    @classmethod
    def contours(cls, parts: Sequence[Curve]) -> Curve:
        """The set of several contours as one curve, e.g. an outline with its holes."""
        return cls(*joined(parts, together=False))

    def transformed(self, matrix: ArrayLike) -> Curve:
        """The curve under the affine map `matrix` (2, 3) or (3, 3): x -> matrix[:2, :2] x + matrix[:2, 2].

        Raises: BadShape, NotFinite, BadCurve (a singular map).
        """
        affine = checked_transform(matrix)
        rows = self.pieces.control.copy()
        rows[:, :2] = rows[:, :2] / rows[:, 2:]
        rows[:, :2] = rows[:, :2] @ affine[:, :2].T
        base = affine[:, :2] @ self.origin + affine[:, 2]
        return Curve(*assembled(rows, self.pieces.first, self.limits, self.contour, base))

    def reversed(self) -> Curve:
        """The same set of points run through backwards, over the same range of parameters."""
        first, last = self.limits[0, 0], self.limits[-1, 1]
        rows = self.pieces.control[::-1].copy()
        rows[:, :2] /= rows[:, 2:]
        sizes = np.concatenate([[0], np.cumsum(np.diff(self.pieces.first)[::-1])])
        limits = (first + last) - self.limits[::-1, ::-1]
        contour = self.contour[-1] - self.contour[::-1]
        return Curve(*assembled(rows, sizes, limits, contour, self.origin))


class CurveFields(NamedTuple):
    """The fields of a curve; see `Curve`."""

    pieces: Pieces
    origin: np.ndarray
    limits: np.ndarray
    contour: np.ndarray


def origin_of(points: np.ndarray) -> np.ndarray:
    """About the middle of `points`, with so few digits that taking it off a coordinate is exact.

    A coordinate far larger than the extent is a multiple of its own last bit, and so is the difference;
    any other difference is rounded relative to the extent.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    unit = 2.0 ** (math.frexp(float((high - low).max()) or 1.0)[1] - 5)
    return np.round((0.5 * low + 0.5 * high) / unit) * unit


def checked_size(extent: np.ndarray) -> float:
    """The diagonal of a curve's box (2,), refused where it is 0 or leaves the range of floats."""
    size = math.hypot(*extent)
    if size == 0.0:
        raise BadCurve("a curve of zero length", valid="at least two points that differ")
    least, most = CURVE_SIZES
    if not least < size < most:
        raise BadCurve(f"a curve of size {size:g}", valid=f"a size between {least:g} and {most:g}")
    return size


def assembled(
    rows: np.ndarray,
    first: np.ndarray,
    limits: np.ndarray,
    contour: np.ndarray | None = None,
    base: ArrayLike = (0.0, 0.0),
) -> CurveFields:
    """The curve of Cartesian control points about `base` with weights, `rows` (m, 3); pieces of no extent go."""
    first = np.ascontiguousarray(first, np.int64)
    contour = np.zeros(len(limits), np.int64) if contour is None else np.asarray(contour, np.int64)
    ascending(contour, strictly=False)
    low, high = piece_spans(rows, first)
    extent = (high[:, :2] > low[:, :2]).any(axis=1)
    size = checked_size((high.max(axis=0) - low.min(axis=0))[:2])
    degree = np.diff(first)
    if not extent.all():
        rows, limits, contour = rows[np.repeat(extent, degree)], limits[extent], contour[extent]
        low, high, degree = low[extent], high[extent], degree[extent]
        first = np.concatenate([[0], np.cumsum(degree)])
    rational = high[:, 2] > low[:, 2]
    origin = origin_of(np.stack([low.min(axis=0)[:2], high.max(axis=0)[:2]]))
    if np.any(base) and np.abs(origin).max() <= 2.0 * size:
        origin[:] = 0.0  # near enough, and `base` stays as exact as it was given
    weight = np.where(np.repeat(rational, degree), rows[:, 2], 1.0)
    control = np.empty((len(rows), 3))
    control[:, :2], control[:, 2] = (rows[:, :2] - origin) * weight[:, None], weight
    pieces = Pieces(control, first, np.ascontiguousarray(rational))
    return CurveFields(pieces, origin + base, np.ascontiguousarray(limits), contour)


def joined(parts: Sequence[CurveFacts], *, together: bool) -> CurveFields:
    """Several curves as one: `together` as one contour, each starting where the last ended.

    Raises: BadCurve where two parts do not meet, or there is none.
    """
    parts = list(parts)
    if not parts or not all(isinstance(part, CurveFacts) for part in parts):
        raise BadCurve(f"{len(parts)} parts", where="parts", valid="a list of at least one Curve")
    at, n_contours = 0.0, 0
    rows: list[np.ndarray] = []
    limits: list[np.ndarray] = []
    contours: list[np.ndarray] = []
    for k, part in enumerate(parts):
        cartesian = part.pieces.control.copy()
        cartesian[:, :2] = cartesian[:, :2] / cartesian[:, 2:] + (part.origin - parts[0].origin)
        if together and k and not _meets(rows[-1][-1], cartesian[0], part.size):
            gap = float(np.hypot(*(rows[-1][-1] - cartesian[0])[:2]))
            raise BadCurve(
                f"part {k} starts {gap:g} away from the end of part {k - 1}",
                where="parts",
                valid="parts that meet; use Curve.contours for several contours",
            )
        rows.append(cartesian)
        limits.append(part.limits - part.limits[0, 0] + at)
        at = limits[-1][-1, 1]
        contours.append(np.zeros_like(part.contour) if together else part.contour + n_contours)
        n_contours += int(part.contour[-1]) + 1
    sizes = np.concatenate([np.diff(part.pieces.first) for part in parts])
    first = np.concatenate([[0], np.cumsum(sizes)])
    contour = np.concatenate(contours)
    return assembled(np.concatenate(rows), first, np.concatenate(limits), contour, parts[0].origin)


def _meets(end: np.ndarray, start: np.ndarray, size: float) -> bool:
    return bool(np.hypot(*(end - start)[:2]) <= MEETING * size)


def _checked_degree(degree: int) -> int:
    if not isinstance(degree, (int, np.integer)) or not 1 <= degree <= HIGHEST_DEGREE:
        raise BadCurve(
            f"degree {degree!r}", where="degree", valid=f"a whole number 1 to {HIGHEST_DEGREE}"
        )
    return int(degree)
