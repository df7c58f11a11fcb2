"""Lines and arcs as flat arrays: points, normals and nearest points of many at once, in closed form.

For searches with many evaluations; a place on them is a piece and the share of its length.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.kernels.profile.outline_feet import RUN, FlatPieces, nearest_places, places_of
from clearance.planar.biarcs import biarcs
from clearance.planar.curve import Curve
from clearance.profiles.contour import Contour

FINE = 1e-7
"""[-] How far arcs may stray from free-form curves, relative to their size."""


class ContourPieces:
    """The pieces of closed contours.

    Attributes:
        start, end: (n, 2) [m]. bulge: (n,). owner: (n,) contour of each.
    """

    def __init__(self, contours: Sequence[Contour]) -> None:
        self.start = np.concatenate([c.vertices for c in contours])
        self.end = np.concatenate([c.vertices[_following(c.n_pieces)] for c in contours])
        self.bulge = np.concatenate([c.bulges for c in contours])
        self.owner = np.repeat(np.arange(len(contours)), [c.n_pieces for c in contours])
        self.size = float(np.hypot(*(self.start.max(axis=0) - self.start.min(axis=0))))
        self._flat = np.abs(self.bulge) < 1e-9
        self.arrays = self._arrays()

    def _arrays(self) -> FlatPieces:
        """As arguments of kernels."""
        bulge = np.where(self._flat, 1.0, self.bulge)
        along = self.end - self.start
        left = np.stack([-along[:, 1], along[:, 0]], axis=1)
        lift = (1.0 - bulge * bulge) / (4.0 * bulge)
        center = 0.5 * (self.start + self.end) + lift[:, None] * left
        # An arc of less than half a turn stays within its height of the chord's box.
        height = 0.5 * np.hypot(*along.T) * np.abs(self.bulge) * (1.0 + 1e-12)
        low = np.minimum(self.start, self.end) - height[:, None]
        high = np.maximum(self.start, self.end) + height[:, None]
        runs = np.arange(0, len(bulge), RUN)
        run_low, run_high = np.minimum.reduceat(low, runs), np.maximum.reduceat(high, runs)
        return FlatPieces(
            start=self.start,
            along=along,
            center=center,
            arm=self.start - center,
            sweep=np.where(self._flat, 0.0, 4.0 * np.arctan(bulge)),
            box=np.hstack([low, high]),
            run_box=np.hstack([run_low, run_high]),
        )

    def point(self, piece: np.ndarray, share: np.ndarray) -> np.ndarray:
        """(k, 2) points at shares of pieces."""
        out = np.empty((len(piece), 2))
        places_of(self.arrays, piece, share, out)
        return out

    def left(self, piece: np.ndarray, share: np.ndarray) -> np.ndarray:
        """(k, 2) unit normals to the left."""
        along = self.arrays.along[piece]
        straight = np.stack([-along[:, 1], along[:, 0]], axis=1)
        inward = self.arrays.center[piece] - self.point(piece, share)
        inward *= np.sign(self.bulge[piece])[:, None]
        found = np.where(self._flat[piece, None], straight, inward)
        return found / np.maximum(np.hypot(*found.T), 1e-300)[:, None]

    def feet(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Piece, share and foot (k, 2) of the nearest point to each of `points`."""
        n = len(points)
        piece, share, foot = np.empty(n, np.int64), np.empty(n), np.empty((n, 2))
        nearest_places(self.arrays, np.ascontiguousarray(points), piece, share, foot)
        return piece, share, foot

    def spread(self, per_piece: int) -> tuple[np.ndarray, np.ndarray]:
        """Pieces and shares of `per_piece` places on each, its start first."""
        piece = np.repeat(np.arange(len(self.bulge)), per_piece)
        return piece, np.tile(np.arange(per_piece) / per_piece, len(self.bulge))


def _following(n: int) -> np.ndarray:
    return np.append(np.arange(1, n), 0)


def contours_of(curve: Curve, tolerance: float) -> tuple[Contour, ...]:
    """The contours of a curve as lines and arcs within `tolerance`; its contours must be closed."""
    arcs = biarcs(curve, tolerance)
    owner = curve.contour[curve.locate(arcs.parameters.mean(axis=1))[0]]
    along = arcs.end - arcs.start
    flat = ~np.isfinite(arcs.radius)
    half = 0.5 * np.hypot(*along.T) / np.where(flat, 1.0, arcs.radius)
    bulge = np.tan(0.5 * np.arcsin(np.clip(np.where(flat, 0.0, half), 0.0, 1.0)))
    bulge = np.where(arcs.counter_clockwise, bulge, -bulge) * ~flat
    has_length = np.hypot(*along.T) > 0.0
    return tuple(
        Contour(arcs.start[chosen], bulge[chosen])
        for chosen in (has_length & (owner == k) for k in range(int(owner[-1]) + 1))
    )
