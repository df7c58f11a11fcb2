"""The nearest place on lines and arcs to each of many points, in closed form, behind boxes of runs of pieces.

A place is a piece and the share of its length. Where two pieces meet in the nearest point, the one is taken that
the point is more square to: of the two only that one says for certain on which side it lies. Not for: proofs
(`curve.nearest`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.declared import Floats, Floats2, Integers
from clearance.compile.decorators import inline, kernel
from clearance.kernels.curve.boxes import box_gap_sq

RUN = 16
"""Pieces that share a box."""

TIED = 1.0 + 1e-12
"""Squared distances within this are those of one corner."""


class FlatPieces(NamedTuple):
    """Pieces of closed contours as arrays.

    Attributes:
        start, along: (n, 2) [m] first point, and from there to the last.
        center, arm: (n, 2) [m] of arcs: the centre, and from there to the first point.
        sweep: (n,) [rad] of arcs, with its sign; 0 for lines.
        box: (n, 4) [m] least and greatest x and y of each piece. run_box: (ceil(n / RUN), 4) of each run.
    """

    start: Floats2
    along: Floats2
    center: Floats2
    arm: Floats2
    sweep: Floats
    box: Floats2
    run_box: Floats2


@inline
def _share_of(pieces, k, x, y):
    """The share of piece `k` at its point nearest to (x, y)."""
    sweep = pieces.sweep[k]
    if sweep == 0.0:
        ux, uy = pieces.along[k, 0], pieces.along[k, 1]
        share = (x - pieces.start[k, 0]) * ux + (y - pieces.start[k, 1]) * uy
        return min(1.0, max(0.0, share / (ux * ux + uy * uy)))
    px, py = x - pieces.center[k, 0], y - pieces.center[k, 1]
    ax, ay = pieces.arm[k, 0], pieces.arm[k, 1]
    turn = math.atan2(ax * py - ay * px, ax * px + ay * py)
    # Beyond the arc the nearer end; the side opposite its middle divides them.
    opposite = 0.5 * sweep
    if abs(turn - opposite) > math.pi:
        turn += math.copysign(2.0 * math.pi, opposite)
    return min(1.0, max(0.0, turn / sweep))


@inline
def _point_at(pieces, k, share):
    if pieces.sweep[k] == 0.0:
        return (
            pieces.start[k, 0] + share * pieces.along[k, 0],
            pieces.start[k, 1] + share * pieces.along[k, 1],
        )
    cosine, sine = math.cos(share * pieces.sweep[k]), math.sin(share * pieces.sweep[k])
    ax, ay = pieces.arm[k, 0], pieces.arm[k, 1]
    return (
        pieces.center[k, 0] + cosine * ax - sine * ay,
        pieces.center[k, 1] + sine * ax + cosine * ay,
    )


@inline
def _squareness(pieces, k, share, ex, ey):
    """How far (ex, ey), from the piece's point at `share`, is beside its tangent there."""
    tx, ty = pieces.along[k, 0], pieces.along[k, 1]
    if pieces.sweep[k] != 0.0:
        px, py = _point_at(pieces, k, share)
        tx, ty = pieces.center[k, 1] - py, px - pieces.center[k, 0]
    return abs(tx * ey - ty * ex) / math.hypot(tx, ty)


@kernel
def places_of(pieces: FlatPieces, piece: Integers, share: Floats, out: Floats2):
    """Writes the points (n, 2) at shares of pieces."""
    for i in range(len(piece)):
        out[i, 0], out[i, 1] = _point_at(pieces, piece[i], share[i])


@inline
def _nearest_run(pieces, x, y):
    nearest, least = 0, np.inf
    for run in range(len(pieces.run_box)):
        gap = box_gap_sq(pieces.run_box, run, x, y)
        if gap < least:
            nearest, least = run, gap
    return nearest


@kernel
def nearest_places(
    pieces: FlatPieces, points: Floats2, piece: Integers, share: Floats, foot: Floats2
):
    """Writes piece and share (n,), and the nearest point (n, 2), for each of `points` (n, 2)."""
    n, n_runs = len(pieces.sweep), len(pieces.run_box)
    for i in range(len(points)):
        x, y = points[i, 0], points[i, 1]
        best, best_share, fx, fy = 0, 0.0, 0.0, 0.0
        least, square = np.inf, -1.0
        first = _nearest_run(pieces, x, y)
        for k_run in range(n_runs):
            run = (first + k_run) % n_runs
            if box_gap_sq(pieces.run_box, run, x, y) > least * TIED:
                continue
            for k in range(RUN * run, min(n, RUN * run + RUN)):
                if box_gap_sq(pieces.box, k, x, y) > least * TIED:
                    continue
                at = _share_of(pieces, k, x, y)
                px, py = _point_at(pieces, k, at)
                off = (x - px) ** 2 + (y - py) ** 2
                if off > least * TIED:
                    continue
                squareness = _squareness(pieces, k, at, x - px, y - py)
                if off * TIED < least or squareness > square:
                    best, best_share, fx, fy, square = k, at, px, py, squareness
                    least = min(least, off)
        piece[i], share[i], foot[i, 0], foot[i, 1] = best, best_share, fx, fy
