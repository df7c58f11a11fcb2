"""Facts about a curve's pieces, and the places of its points. Not for: making one (`curve`)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from clearance.kernels.curve.arc_fit import Leaves, box_tree, fit_leaves
from clearance.kernels.curve.bezier import Joints, Pieces, control_box, points_on
from clearance.kernels.hausdorff.segments import segment_boxes
from clearance.planar.entries import BadCurve
from clearance.tolerance import BIARC, CLOSED, LAST_BITS, MEETING, TANGENT, UNIT_ROUNDOFF

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

HALVINGS = 60
"""Halvings of control polygons, until the rest that still stands out counts for the box."""


@dataclass(frozen=True, eq=False)
class CurveFacts:
    """The pieces of a curve, and what follows from them; attributes as in `Curve`."""

    pieces: Pieces
    origin: np.ndarray
    limits: np.ndarray
    contour: np.ndarray

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

    @property
    def joints(self) -> Joints:
        """How the pieces follow one another, as an argument of kernels."""
        return Joints(self.contour, TANGENT, MEETING * self.size)

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

    def point(self, parameter: ArrayLike) -> np.ndarray:
        """Points (..., 2) at the given parameters; a parameter outside becomes the nearest end."""
        return self.derivative(parameter, 0)

    def derivative(self, parameter: ArrayLike, order: int = 1) -> np.ndarray:
        """Derivatives (..., 2) of the given order, 0 to 2, by the curve's own parameter."""
        if order not in (0, 1, 2):
            raise BadCurve(f"derivative of order {order}", where="order", valid="0, 1 or 2")
        asked = np.asarray(parameter, float)
        which, local = self.locate(asked.ravel())
        found = self._jets(which, local)[:, 2 * order : 2 * order + 2]
        width = (self.limits[which, 1] - self.limits[which, 0])[:, None]
        found = found / width**order if order else found + self.origin
        return found.reshape((*asked.shape, 2))

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

    def spread_on_leaves(self, count: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Pieces and local parameters of `count` (n,) places on each leaf, evenly, its start first."""
        rows = self.leaves.arcs
        index = np.repeat(np.arange(len(rows)), count)
        rank = np.arange(len(index)) - np.repeat(np.cumsum(count) - count, count)
        local = rows[index, 0] + (rows[index, 1] - rows[index, 0]) * rank / count[index]
        return self.leaves.piece[index], local

    @property
    def leaf_chords(self) -> np.ndarray:
        """(n,) the length of each leaf's chord."""
        rows = self.leaves.arcs
        return np.hypot(rows[:, 4] - rows[:, 2], rows[:, 5] - rows[:, 3])

    def _jets(self, which: np.ndarray, local: np.ndarray) -> np.ndarray:
        out = np.empty((len(which), 6))
        points_on(self.pieces, which, local, out)
        return out


def least_box(pieces: Pieces) -> np.ndarray:
    """(2, 2) lower and upper corner; the curve may stand out by LAST_BITS of its largest coordinate."""
    count = np.diff(pieces.first)
    parts = [
        pieces.control[pieces.first[:-1][count == n][:, None] + np.arange(n)]
        for n in np.unique(count)
    ]
    return np.array([[-_farthest(parts, axis, -1.0) for axis in (0, 1)],
                     [_farthest(parts, axis, 1.0) for axis in (0, 1)]])  # fmt: skip


def _farthest(parts: list[np.ndarray], axis: int, sign: float) -> float:
    """The greatest coordinate (times `sign`) of any of the curves (k, degree + 1, 3), from above."""
    best = -math.inf
    for rows in parts:
        slack = LAST_BITS * float(np.abs(rows[:, :, axis] / rows[:, :, 2]).max())
        for _ in range(HALVINGS):
            reach = sign * rows[:, :, axis] / rows[:, :, 2]
            best = max(best, float(reach[:, [0, -1]].max()))
            rows = rows[reach.max(axis=1) > best + slack]
            if not len(rows):
                break
            rows = np.concatenate(halved(rows))
        else:
            best = max(best, float((sign * rows[:, :, axis] / rows[:, :, 2]).max()))
    return best


def halved(rows: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Both halves of each control polygon, by de Casteljau at 1/2."""
    left, right, inner = np.empty_like(rows), np.empty_like(rows), rows
    for k in range(rows.shape[1]):
        left[:, k], right[:, -1 - k] = inner[:, 0], inner[:, -1]
        inner = 0.5 * (inner[:, :-1] + inner[:, 1:])
    return left, right
