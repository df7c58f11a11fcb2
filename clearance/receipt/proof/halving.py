"""Cuts a body's faces in halves, and those again, by the faces alone: the nodes that evidence speaks of.

Node 0 is all of it, the halves of node i are 2 i + 1 and 2 i + 2, the earlier one smaller along the axis along
which the middles of its faces are farthest apart. Not for: where bodies are (`placing`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from clearance.receipt.proof.error_terms import OUTWARD, DirectionTerms
from clearance.receipt.proof.motion_data import Shape

FEW = 8
"""Faces of a node whose corners are looked at one by one; of more, the boxes of its parts three cuts down."""


class Halves(NamedTuple):
    """The nodes of several bodies behind one another.

    Attributes:
        first_node, first_face: (bodies,) where those of a body begin.
        start, stop: (nodes,) its faces in `corners` (3, k, faces) [m]: x, y, z of the first corners, and so on.
        low, high: (3, nodes) [m] its box.
        radius: (bodies,) [m] of the balls about the corners.
    """

    first_node: np.ndarray
    start: np.ndarray
    stop: np.ndarray
    low: np.ndarray
    high: np.ndarray
    corners: np.ndarray
    radius: np.ndarray

    def sizes(self, bodies: np.ndarray, nodes: np.ndarray) -> np.ndarray:
        """(k,) the number of faces of some nodes, as their bodies count them."""
        at = self.first_node[bodies] + nodes
        return self.stop[at] - self.start[at]


def halves_of(shapes: Sequence[Shape], depths: np.ndarray | None = None) -> Halves:
    """The nodes of some bodies.

    Args:
        depths: (bodies,) how often each is cut, if not down to single faces.
    """
    most = [None] * len(shapes) if depths is None else depths.tolist()
    width = max(shape.faces.shape[1] for shape in shapes)
    parts = [_halved(_widened(s.corners, width), n) for s, n in zip(shapes, most, strict=True)]
    nodes = np.cumsum([0, *(len(part[0]) for part in parts)])
    faces = np.cumsum([0, *(len(shape.faces) for shape in shapes)])
    low, high, corners = (
        np.ascontiguousarray(np.concatenate([part[k] for part in parts], -1)) for k in (2, 3, 4)
    )
    return Halves(
        nodes[:-1],
        np.concatenate([part[0] + at for part, at in zip(parts, faces[:-1], strict=True)]),
        np.concatenate([part[1] + at for part, at in zip(parts, faces[:-1], strict=True)]),
        low,
        high,
        corners,
        np.array([shape.radius for shape in shapes]),
    )


def _widened(corners: np.ndarray, width: int) -> np.ndarray:
    """The corners with the first once more where there are too few."""
    short = width - corners.shape[1]
    return np.concatenate([corners, *([corners[:, :1]] * short)], axis=1)


def _halved(corners: np.ndarray, most: int | None) -> tuple[np.ndarray, ...]:
    """Starts, stops, boxes of all nodes of one body, and its faces in their order."""
    n = len(corners)
    middles = np.add.reduce(corners, axis=1)
    order, starts, stops = np.arange(n), np.array([0]), np.array([n])
    ranks = np.empty((3, n), dtype=np.int64)
    for axis in range(3):
        ranks[axis, np.argsort(middles[:, axis], kind="stable")] = order
    all_starts, all_stops = [starts], [stops]
    while (stops - starts).max() > 1 and (most is None or len(all_starts) <= most):
        order = _ordered(middles, ranks, order, starts, stops)
        half = (starts + stops) // 2
        starts, stops = _alternating(starts, half), _alternating(half, stops)
        all_starts.append(starts)
        all_stops.append(stops)
    placed = corners[order]
    starts, stops = np.concatenate(all_starts), np.concatenate(all_stops)
    return starts, stops, *_boxes(placed, all_starts, all_stops), placed.T


def _alternating(first: np.ndarray, second: np.ndarray) -> np.ndarray:
    return np.stack([first, second], axis=1).reshape(-1)


def _ordered(
    middles: np.ndarray,
    ranks: np.ndarray,
    order: np.ndarray,
    starts: np.ndarray,
    stops: np.ndarray,
) -> np.ndarray:
    """The faces once more, those of each node along the axis along which they are farthest apart.

    Args:
        ranks: (3, faces) the place of each along each axis, of equals by their numbers.
    """
    full = stops > starts
    placed, firsts = middles[order], starts[full]
    spread = np.maximum.reduceat(placed, firsts) - np.minimum.reduceat(placed, firsts)
    sizes = (stops - starts)[full]
    axis = np.repeat(spread.argmax(axis=1), sizes)
    node = np.repeat(np.arange(len(firsts)), sizes)
    return order[np.argsort(node * len(order) + ranks[axis, order])]


def _boxes(
    placed: np.ndarray, starts: Sequence[np.ndarray], stops: Sequence[np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """(3, nodes) least and greatest coordinates of all nodes; of a node without faces infinities."""
    lows, highs = [], []
    face_low, face_high = placed.min(axis=1), placed.max(axis=1)
    for first, last in zip(starts, stops, strict=True):
        full = last > first
        low, high = np.full((len(first), 3), np.inf), np.full((len(first), 3), -np.inf)
        low[full] = np.minimum.reduceat(face_low, first[full])
        high[full] = np.maximum.reduceat(face_high, first[full])
        lows.append(low)
        highs.append(high)
    return np.concatenate(lows).T, np.concatenate(highs).T


def over_boxes(
    halves: Halves, bodies: np.ndarray, nodes: np.ndarray, along: np.ndarray
) -> np.ndarray:
    """(t, k) no less than `over_corners`, by the boxes of the nodes."""
    at = halves.first_node[bodies] + nodes
    low, high = (np.take(part, at, axis=1) for part in (halves.low, halves.high))
    found = np.zeros(along.shape[1:])
    for g, least, most in zip(along, low, high, strict=True):
        found = found + np.maximum(g * least, g * most)
    return found


def over_corners(
    halves: Halves,
    bodies: np.ndarray,
    nodes: np.ndarray,
    along: np.ndarray,
    errors: DirectionTerms | None = None,
) -> np.ndarray:
    """(t, k) the greatest `along . p` of the points of some nodes, or of boxes that hold them; of balls of their
    middles.

    Args:
        bodies, nodes: (k,). along: (3, t, k) several directions each, in the bodies' own frames.
        errors: what is added at each point.
    """
    at = halves.first_node[bodies] + nodes
    found = np.empty(along.shape[1:])
    size = halves.stop[at] - halves.start[at]
    for few, most in ((size == 1, 1), ((size > 1) & (size <= FEW), FEW)):
        rows = np.flatnonzero(few)
        x, y, z = points = _points(halves, at[rows], most)
        more = 0.0 if errors is None else errors.of(rows).at(points)
        for t, (gx, gy, gz) in enumerate(np.moveaxis(along[:, :, rows], 1, 0)):
            found[t, rows] = (x * gx + y * gy + z * gz + more).max(axis=0)
    rows = np.flatnonzero(size > FEW)
    eighths = halves.first_node[bodies[rows]] + _eighths(nodes[rows])
    low, high = (np.take(part, eighths, axis=1) for part in (halves.low, halves.high))
    more = 0.0 if errors is None else _over_boxes(errors.of(rows), low, high)
    for t, g in enumerate(np.moveaxis(along[:, :, rows], 1, 0)):
        reach = [np.maximum(g[k] * low[k], g[k] * high[k]) for k in range(3)]
        found[t, rows] = (reach[0] + reach[1] + reach[2] + more).max(axis=0)
    return found


def _over_boxes(errors: DirectionTerms, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    """(8, k) no point of the boxes (3, 8, k) has more added to it."""
    half = 0.5 * (high - low)
    radius = np.sqrt((half * half).sum(axis=0)) * OUTWARD
    return (errors.at(0.5 * (low + high)) + errors.slope * radius) * OUTWARD


def _points(halves: Halves, at: np.ndarray, most: int) -> np.ndarray:
    """(3, corners, k) [m] those of nodes with no more than so many faces; some are there several times."""
    faces = np.minimum(halves.start[at] + np.arange(most)[:, None], halves.stop[at] - 1)
    return np.take(halves.corners, faces, axis=2).reshape(
        3, most * halves.corners.shape[1], len(at)
    )


def _eighths(nodes: np.ndarray) -> np.ndarray:
    """(8, k) the parts of nodes three cuts down."""
    return 8 * nodes + 7 + np.arange(8)[:, None]


def farthest_points(
    halves: Halves, bodies: np.ndarray, nodes: np.ndarray, along: np.ndarray
) -> np.ndarray:
    """(3, k) [m] points at which `over_corners` is attained along (3, k); no proof needs them."""
    at = halves.first_node[bodies] + nodes
    found = np.empty((3, len(at)))
    few = halves.stop[at] - halves.start[at] <= FEW
    rows = np.flatnonzero(few)
    points = _points(halves, at[rows], FEW)
    found[:, rows] = _tips(points, along[:, rows])
    rows = np.flatnonzero(~few)
    eighths = halves.first_node[bodies[rows]] + _eighths(nodes[rows])
    g = along[:, None, rows]
    found[:, rows] = _tips(
        np.where(g > 0.0, halves.high[:, eighths], halves.low[:, eighths]), g[:, 0]
    )
    return found


def _tips(points: np.ndarray, along: np.ndarray) -> np.ndarray:
    """(3, k) of points (3, n, k) those farthest along (3, k)."""
    which = (points * along[:, None]).sum(axis=0).argmax(axis=0)
    return points[:, which, np.arange(len(which))]
