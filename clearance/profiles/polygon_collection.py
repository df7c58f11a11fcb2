"""The polygons of a sweep, gathered chunk by chunk: their union, and which of them come to its outline.

Not for: making them (`silhouette`, `section`).
"""

from __future__ import annotations

import numpy as np

from clearance.profiles.profile import Origin
from clearance.profiles.region import Region, RegionIndex, polygons, touching, union

MOST_KEPT = 20_000
"""Polygons that are held before those inside the outline so far are let go."""


class PolygonCollection:
    """The polygons kept so far; those that no longer come to the outline are let go now and then."""

    def __init__(self, covered: Region) -> None:
        self._whole = covered
        self._parts = np.zeros(0, dtype=object)
        self._makers = np.zeros((0, 2), dtype=np.int64)
        self._fresh = 0

    def add(self, hulls, i_view: int) -> None:
        made = polygons(hulls.corners, hulls.n_corners)
        makers = np.stack([np.full(len(made), i_view), hulls.instant.astype(np.int64)], axis=1)
        self._parts = np.concatenate([self._parts, made])
        self._makers = np.concatenate([self._makers, makers])
        self._fresh += len(made)
        if self._fresh > MOST_KEPT:
            self.region()

    def region(self) -> Region:
        """The union of all so far."""
        if self._fresh:
            fresh = self._parts[len(self._parts) - self._fresh :]
            self._whole = union([self._whole, union(fresh)])
            keep = touching(self._whole, self._parts)
            self._parts, self._makers, self._fresh = self._parts[keep], self._makers[keep], 0
        return self._whole

    def origin(self, contours, labels: tuple[str, ...]) -> Origin:
        """The maker of each piece: whose polygon is nearest to its middle, the first on ties."""
        middles = np.concatenate([contour.middles() for contour in contours])
        makers = self._makers[RegionIndex(self._parts)(middles)]
        return Origin(labels, makers[:, 0].copy(), makers[:, 1].copy())
