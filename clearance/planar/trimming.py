"""Which parts of a curve trimming leaves, for pictures and for the test that trimming is safe."""

from __future__ import annotations

import numpy as np

from clearance.kernels.hausdorff.trim import field, kept_arcs
from clearance.planar.curve import Curve
from clearance.planar.directed import placed


def kept_intervals(a: Curve, b: Curve, lower_bound: float) -> np.ndarray:
    """Parameter intervals (n, 2) of the arcs of `a` that may be farther from `b` than `lower_bound`.

    Every point of a outside them is proven to be nearer. Equations (3) to (10) of Kim, Oh, Kim (2010).
    """
    piece, local = kept_parts(a, b, lower_bound)
    low, high = a.limits[piece].T[:, :, None]
    return low + local * (high - low)


def kept_parts(a: Curve, b: Curve, lower_bound: float) -> tuple[np.ndarray, np.ndarray]:
    """As `kept_intervals`, by piece (n,) and local parameters (n, 2): clear also where a contour ends."""
    shift, _ = placed(a, b)
    rows, owner = a.leaves.arcs, a.leaves.piece
    pixel = a.length / max(64, 2 * len(rows))
    kept = kept_arcs(a.pieces, a.leaves, b.leaves, shift[0], shift[1], lower_bound, pixel)
    return owner[kept], rows[kept, :2]


def distance_field(curve: Curve, xs: np.ndarray, ys: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distance to the arcs of `curve` and the nearest arc's index, (len(ys), len(xs)) each: a page of the map."""
    depth = np.empty((len(ys), len(xs)))
    which = np.empty(depth.shape, np.int64)
    x = np.ascontiguousarray(xs - curve.origin[0])
    y = np.ascontiguousarray(ys - curve.origin[1])
    field(curve.leaves, x, y, depth, which)
    return depth, which
