"""Lines and arcs as flat arrays: points, normals and nearest points of many at once, in closed form.

For searches that ask again and again; a place on them is a piece and the share of its length. Not for: certified
distances (`clearance.planar`).
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property

import numpy as np

from clearance.planar.biarcs import biarcs
from clearance.planar.curve import Curve
from clearance.profiles.contour import Contour

FINE = 1e-7
"""[-] How far arcs may stray from free-form curves, relative to their size."""


class Pieces:
    """The pieces of closed contours.

    Attributes:
        start, end: (n, 2) [m]. bulge: (n,). owner: (n,) contour of each.
    """

    def __init__(self, contours: Sequence[Contour]) -> None:
        self.start = np.concatenate([c.vertices for c in contours])
        self.end = np.concatenate([np.roll(c.vertices, -1, axis=0) for c in contours])
        self.bulge = np.concatenate([c.bulges for c in contours])
        sizes = np.array([c.n_pieces for c in contours])
        self.owner = np.repeat(np.arange(len(contours)), sizes)
        firsts = np.cumsum(sizes) - sizes
        ring = np.arange(len(self.bulge)) - firsts[self.owner]
        self.ahead = firsts[self.owner] + (ring + 1) % sizes[self.owner]
        self.behind = firsts[self.owner] + (ring - 1) % sizes[self.owner]
        self.size = float(np.hypot(*(self.start.max(axis=0) - self.start.min(axis=0))))
        self._flat = np.abs(self.bulge) < 1e-9
        bulge = np.where(self._flat, 1.0, self.bulge)
        along = self.end - self.start
        left = np.stack([-along[:, 1], along[:, 0]], axis=1)
        lift = (1.0 - bulge * bulge) / (4.0 * bulge)
        self._along = along
        self._center = 0.5 * (self.start + self.end) + lift[:, None] * left
        self._arm = self.start - self._center
        self._sweep = np.where(self._flat, 0.0, 4.0 * np.arctan(bulge))

    @classmethod
    def of_curve(cls, curve: Curve) -> Pieces:
        """The pieces of a curve of closed contours; free-form parts as arcs within `FINE`."""
        return cls(contours_of(curve, FINE * curve.size))

    def point(self, piece: np.ndarray, share: np.ndarray) -> np.ndarray:
        """(k, 2) points at shares of pieces."""
        straight = self.start[piece] + share[:, None] * self._along[piece]
        turn = share * self._sweep[piece]
        x, y = self._arm[piece].T
        cosine, sine = np.cos(turn), np.sin(turn)
        turned = np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=1)
        return np.where(self._flat[piece, None], straight, self._center[piece] + turned)

    def left(self, piece: np.ndarray, share: np.ndarray) -> np.ndarray:
        """(k, 2) unit normals to the left."""
        along = self._along[piece]
        straight = np.stack([-along[:, 1], along[:, 0]], axis=1)
        inward = (self._center[piece] - self.point(piece, share)) * np.sign(self.bulge[piece])[
            :, None
        ]
        found = np.where(self._flat[piece, None], straight, inward)
        return found / np.maximum(np.hypot(*found.T), 1e-300)[:, None]

    def feet(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Piece, share and foot (k, 2) of the nearest point to each of `points`, among the pieces near the
        nearest of a dense table.
        """
        owner, tree = self._table
        _, at = tree.query(points)
        near = owner[at]
        best = None
        for piece in (near, self.ahead[near], self.behind[near]):
            share = self._share(piece, points)
            foot = self.point(piece, share)
            off = ((points - foot) ** 2).sum(axis=1)
            if best is None:
                best = [piece.copy(), share, foot, off]
                continue
            better = off < best[3] * (1.0 - 1e-14)
            for kept, fresh in zip(best, (piece, share, foot, off), strict=True):
                kept[better] = fresh[better]
        return best[0], best[1], best[2]

    def _share(self, piece: np.ndarray, points: np.ndarray) -> np.ndarray:
        """(k,) where on each piece the point nearest to each of `points` is."""
        along = self._along[piece]
        straight = ((points - self.start[piece]) * along).sum(axis=1) / (along**2).sum(axis=1)
        off, arm = points - self._center[piece], self._arm[piece]
        turn = np.arctan2(arm[:, 0] * off[:, 1] - arm[:, 1] * off[:, 0], (arm * off).sum(axis=1))
        sweep = np.where(self._flat[piece], 1.0, self._sweep[piece])
        return np.clip(np.where(self._flat[piece], straight, turn / sweep), 0.0, 1.0)

    @cached_property
    def _table(self):
        from scipy.spatial import cKDTree

        length = np.hypot(*self._along.T)
        count = np.clip(np.ceil(400.0 * length / length.sum()), 2, 64).astype(int)
        owner = np.repeat(np.arange(len(count)), count)
        share = (np.arange(len(owner)) - np.repeat(np.cumsum(count) - count, count)) / count[owner]
        return owner, cKDTree(self.point(owner, share))

    def spread(self, per_piece: int) -> tuple[np.ndarray, np.ndarray]:
        """Pieces and shares of `per_piece` places on each, its start first."""
        piece = np.repeat(np.arange(len(self.bulge)), per_piece)
        return piece, np.tile(np.arange(per_piece) / per_piece, len(self.bulge))


def contours_of(curve: Curve, tolerance: float) -> tuple[Contour, ...]:
    """The contours of a curve as lines and arcs within `tolerance`; its contours must be closed."""
    arcs = biarcs(curve, tolerance)
    owner = curve.contour[curve.locate(arcs.parameters.mean(axis=1))[0]]
    along = arcs.end - arcs.start
    flat = ~np.isfinite(arcs.radius)
    half = 0.5 * np.hypot(*along.T) / np.where(flat, 1.0, arcs.radius)
    bulge = np.tan(0.5 * np.arcsin(np.clip(np.where(flat, 0.0, half), 0.0, 1.0)))
    bulge = np.where(arcs.counter_clockwise, bulge, -bulge) * ~flat
    keep = np.hypot(*along.T) > 0.0
    return tuple(
        Contour(arcs.start[chosen], bulge[chosen])
        for chosen in (keep & (owner == k) for k in range(int(owner[-1]) + 1))
    )
