"""The one curve type: contours of Bézier pieces, polynomial or rational, open or closed.

Lines, arcs, polylines, B-splines and NURBS all become such pieces when they are made, and everything is
checked there: a `Curve` that exists is finite, has extent and positive weights. Pieces are held about an
origin of the curve's own, so that a curve 1e6 away loses no digits. Not for: distances.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from importlib import import_module

import numpy as np

from clearance.kernels.arc_fit import Leaves, box_tree, fit_leaves
from clearance.kernels.curve_bezier import (
    HIGHEST_DEGREE,
    Pieces,
    control_box,
    piece_spans,
    pieces_of_spline,
    points_on,
    rough_joints,
)
from clearance.kernels.hausdorff_polyline import segment_boxes
from clearance.planar.entries import (
    BadCurve,
    checked_knots,
    checked_points,
    checked_transform,
    checked_weights,
    sweep_of,
)
from clearance.planar.extent import least_box
from clearance.tolerance import (
    BIARC,
    CLOSED,
    CURVE_SIZES,
    MEETING,
    PARAMETER,
    TANGENT,
    UNIT_ROUNDOFF,
)


@dataclass(frozen=True, eq=False)
class Curve:
    """One or more contours of Bézier pieces in the plane, in the caller's unit of length.

    Attributes:
        pieces: homogeneous control points about `origin`.
        origin: (2,) what to add to every coordinate of `pieces`.
        limits: (n, 2) the parameter interval of each piece; contours follow one another.
        contour: (n,) the contour that each piece belongs to.

    Make one by the class methods; the constructor itself checks nothing.
    """

    pieces: Pieces
    origin: np.ndarray
    limits: np.ndarray
    contour: np.ndarray

    # --- constructors -------------------------------------------------------------------------------

    @classmethod
    def line(cls, start: Sequence[float], end: Sequence[float]) -> Curve:
        """The segment between two points; parameter 0 to 1."""
        return cls.polyline([start, end])

    @classmethod
    def polyline(cls, points: np.ndarray, *, closed: bool = False) -> Curve:
        """The polyline through `points` (n, 2), n >= 2; vertex i has the parameter i.

        `closed` adds the segment back to the first point. Repeated points are passed over.

        Raises: BadShape, NotFinite, BadCurve (fewer than two points, no extent).
        """
        points = checked_points(points, "points", least=2)
        if closed and np.any(points[0] != points[-1]):
            points = np.concatenate([points, points[:1]])
        x, y = points.T
        box = np.array([[x.min(), y.min()], [x.max(), y.max()]])
        _check_size(box[1] - box[0])
        origin = _origin_of(box)
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
        control: np.ndarray,
        degree: int = 3,
        knots: np.ndarray | None = None,
        weights: np.ndarray | None = None,
    ) -> Curve:
        """The B-spline or NURBS of `control` (n, 2), over [knots[degree], knots[n]].

        Args:
            control: (n, 2) control points, n > degree.
            degree: 1 to 24.
            knots: (n + degree + 1,) non-decreasing; None for clamped uniform on [0, 1].
            weights: (n,) positive; None for a polynomial spline.

        Raises: BadShape, NotFinite, BadCurve.
        """
        degree = _checked_degree(degree)
        control = checked_points(control, "control", least=degree + 1)
        weights = checked_weights(weights, len(control))
        knots = checked_knots(knots, len(control), degree)
        base = _origin_of(control)
        weighted = np.column_stack([(control - base) * weights[:, None], weights])
        rows, limits = pieces_of_spline(weighted, knots, degree)
        rows[:, :2] /= rows[:, 2:]
        return _assembled(rows, np.arange(len(limits) + 1) * (degree + 1), limits, base=base)

    @classmethod
    def bezier(cls, control: np.ndarray, weights: np.ndarray | None = None) -> Curve:
        """The Bézier curve of `control` (n, 2), of degree n - 1, with optional `weights`; parameter 0 to 1."""
        control = checked_points(control, "control", least=2)
        _checked_degree(len(control) - 1)
        rows = np.empty((len(control), 3))
        rows[:, :2], rows[:, 2] = control, checked_weights(weights, len(control))
        return _assembled(rows, np.array([0, len(control)]), np.array([[0.0, 1.0]]))

    @classmethod
    def arc(cls, center: Sequence[float], radius: float, start: float, end: float) -> Curve:
        """The arc about `center` from the angle `start` to `end` [rad], clockwise where `end` < `start`.

        It is exact: rational quadratics of at most a quarter turn; the parameter runs from 0 to 1.

        Raises: BadShape, NotFinite, BadCurve (radius not positive, sweep 0 or beyond a full turn).
        """
        center, radius, sweep = sweep_of(center, radius, start, end)
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
        return _assembled(rows, np.arange(n + 1) * 3, limits, base=center)

    @classmethod
    def circle(cls, center: Sequence[float], radius: float) -> Curve:
        """The whole circle, counter-clockwise from the angle 0; parameter 0 to 1."""
        return cls.arc(center, radius, 0.0, 2.0 * math.pi)

    @classmethod
    def chain(cls, parts: Sequence[Curve]) -> Curve:
        """The parts one after the other as one contour; each must start where the last ended.

        The parameter continues: each part keeps its length of parameter. Ends up to 1e-9 of the size apart
        are accepted and left as they are.

        Raises: BadCurve where two parts do not meet, or there is none.
        """
        return _joined(parts, together=True)

    @classmethod
    def contours(cls, parts: Sequence[Curve]) -> Curve:
        """The set of several contours as one curve, e.g. an outline with its holes."""
        return _joined(parts, together=False)

    @classmethod
    def from_dxf(cls, path: str) -> Curve:
        """The lines, arcs, circles, polylines and splines of a DXF file's model space, joined where they meet.

        Raises: MissingFile, BadSyntax, BadCurve; see `clearance.planar.dxf`.
        """
        # By name: the reader builds on this module, which must not import it in turn.
        return import_module("clearance.planar.dxf").read_dxf(path)

    # --- facts --------------------------------------------------------------------------------------

    @property
    def n_pieces(self) -> int:
        return len(self.limits)

    @cached_property
    def box(self) -> np.ndarray:
        """(2, 2) corners of a box that contains the curve, that of its control points; least: `bounding_box`."""
        return control_box(self.pieces.control).reshape(2, 2) + self.origin

    @cached_property
    def bounding_box(self) -> np.ndarray:
        """(2, 2) lower and upper corner of the least box around the curve, to rounding."""
        return least_box(self.pieces) + self.origin

    @cached_property
    def corners(self) -> list[list[float]]:
        """`box` as plain numbers."""
        return self.box.tolist()

    @cached_property
    def size(self) -> float:
        """The diagonal of `box`."""
        return float(np.hypot(*(self.box[1] - self.box[0])))

    @cached_property
    def reach(self) -> float:
        """The largest coordinate about `origin`, what rounding errors are relative to."""
        return float(np.abs(self.box - self.origin).max())

    @cached_property
    def highest_degree(self) -> int:
        first = self.pieces.first
        return int((first[1:] - first[:-1]).max()) - 1

    @cached_property
    def is_polyline(self) -> bool:
        """Whether every piece is a straight segment."""
        return self.highest_degree == 1 and not bool(self.pieces.rational.any())

    @cached_property
    def rounding(self) -> float:
        """A bound of the rounding error of any point computed on the curve, in its unit.

        Conversion to pieces, two cuts and one evaluation, each at most 3 degree + 1 roundings of the
        largest coordinate; twice that where a division by the weight follows; both coordinates.
        """
        passes = (
            4.0 * (3.0 * self.highest_degree + 1.0) * (2.0 if self.pieces.rational.any() else 1.0)
        )
        return passes * math.sqrt(0.5) * UNIT_ROUNDOFF * self.reach

    @cached_property
    def leaves(self) -> Leaves:
        """Biarcs of the curve within BIARC of its size, and their tree; made once, when first needed."""
        arcs, owner = fit_leaves(self.pieces, BIARC * self.size, 14)
        return Leaves(arcs, owner, box_tree(arcs))

    @cached_property
    def segment_boxes(self) -> np.ndarray:
        """The tree of boxes over the segments of a polyline; made once, when first needed."""
        return segment_boxes(self.pieces.control)

    @cached_property
    def is_end(self) -> np.ndarray:
        """(n, 2) whether each piece's start and end is an end of a contour or a corner."""
        return rough_joints(self.pieces, self.contour, TANGENT, MEETING * self.size)

    @property
    def is_closed(self) -> bool:
        """Whether every contour ends where it starts."""
        starts = np.flatnonzero(np.diff(self.contour, prepend=-1))
        stops = np.append(starts[1:], self.n_pieces) - 1
        first, last = self.pieces.first[starts], self.pieces.first[stops + 1] - 1
        rows = self.pieces.control[:, :2] / self.pieces.control[:, 2:]
        return bool(np.all(np.abs(rows[first] - rows[last]) <= CLOSED * self.size))

    @cached_property
    def length(self) -> float:
        """The arc length, by Gauss-Legendre quadrature on the biarcs' intervals (about 1e-12 relative)."""
        nodes, weights = np.polynomial.legendre.leggauss(16)
        arcs = self.leaves.arcs
        half = 0.5 * (arcs[:, 1] - arcs[:, 0])
        local = (0.5 * (arcs[:, 0] + arcs[:, 1]))[:, None] + half[:, None] * nodes
        which = np.repeat(self.leaves.piece, len(nodes))
        speed = np.hypot(*self._jets(which, local.ravel())[:, 2:4].T).reshape(local.shape)
        return float((speed @ weights) @ half)

    # --- evaluation ---------------------------------------------------------------------------------

    def point(self, parameter: np.ndarray) -> np.ndarray:
        """Points (..., 2) at the given parameters; a parameter outside is held to the nearest end."""
        return self.derivative(parameter, 0)

    def derivative(self, parameter: np.ndarray, order: int = 1) -> np.ndarray:
        """Derivatives (..., 2) of the given order, 0 to 2, by the curve's own parameter."""
        if order not in (0, 1, 2):
            raise BadCurve(f"derivative of order {order}", where="order", valid="0, 1 or 2")
        parameter = np.asarray(parameter, float)
        which, local = self.locate(parameter.ravel())
        found = self._jets(which, local)[:, 2 * order : 2 * order + 2]
        width = (self.limits[which, 1] - self.limits[which, 0])[:, None]
        found = found / width**order if order else found + self.origin
        return found.reshape((*parameter.shape, 2))

    def locate(self, parameter: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The piece and its local parameter in [0, 1] of each parameter (k,)."""
        which = np.searchsorted(self.limits[:, 0], parameter, side="right") - 1
        which = np.clip(which, 0, self.n_pieces - 1)
        low, high = self.limits[which, 0], self.limits[which, 1]
        return which, np.clip((parameter - low) / (high - low), 0.0, 1.0)

    def parameter_of(self, piece: int, local: float) -> float:
        """The curve's parameter at the local parameter of a piece.

        At the end of a contour it is the last float before: the joint itself is the next contour's start.
        """
        low, high = self.limits.item(piece, 0), self.limits.item(piece, 1)
        if local < 1.0:
            return low + local * (high - low)
        last = piece + 1 == self.n_pieces or self.contour[piece] == self.contour[piece + 1]
        return float(high if last else np.nextafter(high, low))

    def transformed(self, matrix: np.ndarray) -> Curve:
        """The curve under the affine map `matrix` (2, 3) or (3, 3): x -> matrix[:2, :2] x + matrix[:2, 2].

        Raises: BadShape, NotFinite, BadCurve (a singular map).
        """
        matrix = checked_transform(matrix)
        rows = self.pieces.control.copy()
        rows[:, :2] = rows[:, :2] / rows[:, 2:]
        rows[:, :2] = rows[:, :2] @ matrix[:, :2].T
        base = matrix[:, :2] @ self.origin + matrix[:, 2]
        return _assembled(rows, self.pieces.first, self.limits, self.contour, base)

    def reversed(self) -> Curve:
        """The same set of points run through backwards, over the same range of parameters."""
        first, last = self.limits[0, 0], self.limits[-1, 1]
        rows = self.pieces.control[::-1].copy()
        rows[:, :2] /= rows[:, 2:]
        sizes = np.concatenate([[0], np.cumsum(np.diff(self.pieces.first)[::-1])])
        limits = (first + last) - self.limits[::-1, ::-1]
        contour = self.contour[-1] - self.contour[::-1]
        return _assembled(rows, sizes, limits, contour, self.origin)

    def _jets(self, which: np.ndarray, local: np.ndarray) -> np.ndarray:
        out = np.empty((len(which), 6))
        points_on(self.pieces, which, local, out)
        return out


def _checked_degree(degree: int) -> int:
    if not isinstance(degree, (int, np.integer)) or not 1 <= degree <= HIGHEST_DEGREE:
        raise BadCurve(
            f"degree {degree!r}", where="degree", valid=f"a whole number 1 to {HIGHEST_DEGREE}"
        )
    return int(degree)


def _origin_of(points: np.ndarray) -> np.ndarray:
    """About the middle of `points`, with so few digits that taking it off a coordinate is exact.

    A coordinate far larger than the extent is a multiple of its own last bit, and so is the difference;
    any other difference is rounded relative to the extent.
    """
    low, high = points.min(axis=0), points.max(axis=0)
    unit = 2.0 ** (math.frexp(float((high - low).max()) or 1.0)[1] - 5)
    return np.round((0.5 * low + 0.5 * high) / unit) * unit


def _check_size(extent: np.ndarray) -> float:
    """The diagonal of a curve's box (2,), refused where it is 0 or leaves the range of floats."""
    size = math.hypot(*extent)
    if size == 0.0:
        raise BadCurve("a curve of zero length", valid="at least two points that differ")
    least, most = CURVE_SIZES
    if not least < size < most:
        raise BadCurve(f"a curve of size {size:g}", valid=f"a size between {least:g} and {most:g}")
    return size


def _assembled(rows, first, limits, contour=None, base=(0.0, 0.0)) -> Curve:
    """The curve of Cartesian control points about `base` with weights, `rows` (m, 3); pieces of no extent go."""
    first = np.ascontiguousarray(first, np.int64)
    contour = np.zeros(len(limits), np.int64) if contour is None else np.asarray(contour, np.int64)
    low, high = piece_spans(rows, first)
    extent = (high[:, :2] > low[:, :2]).any(axis=1)
    size = _check_size((high.max(axis=0) - low.min(axis=0))[:2])
    degree = np.diff(first)
    if not extent.all():
        rows, limits, contour = rows[np.repeat(extent, degree)], limits[extent], contour[extent]
        low, high, degree = low[extent], high[extent], degree[extent]
        first = np.concatenate([[0], np.cumsum(degree)])
    rational = high[:, 2] > low[:, 2]
    origin = _origin_of(np.stack([low.min(axis=0)[:2], high.max(axis=0)[:2]]))
    if np.any(base) and np.abs(origin).max() <= 2.0 * size:
        origin[:] = 0.0  # near enough, and `base` stays as exact as it was given
    weight = np.where(np.repeat(rational, degree), rows[:, 2], 1.0)
    control = np.empty((len(rows), 3))
    control[:, :2], control[:, 2] = (rows[:, :2] - origin) * weight[:, None], weight
    pieces = Pieces(control, first, np.ascontiguousarray(rational))
    return Curve(pieces, origin + base, np.ascontiguousarray(limits), contour)


def _joined(parts: Sequence[Curve], *, together: bool) -> Curve:
    parts = list(parts)
    if not parts or not all(isinstance(part, Curve) for part in parts):
        raise BadCurve(f"{len(parts)} parts", where="parts", valid="a list of at least one Curve")
    rows, limits, contour, at, n_contours = [], [], [], 0.0, 0
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
        contour.append(np.zeros_like(part.contour) if together else part.contour + n_contours)
        n_contours += int(part.contour[-1]) + 1
    sizes = np.concatenate([np.diff(part.pieces.first) for part in parts])
    first = np.concatenate([[0], np.cumsum(sizes)])
    contour = np.concatenate(contour)
    return _assembled(np.concatenate(rows), first, np.concatenate(limits), contour, parts[0].origin)


def _meets(end: np.ndarray, start: np.ndarray, size: float) -> bool:
    return bool(np.hypot(*(end - start)[:2]) <= MEETING * size)
