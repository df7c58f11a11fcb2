"""The points of a cloud that are near a body, by its bounds: few points of a scanned hall are near a link.

Not for: whether they are inside (`inside`, and `kernels.search.containment` for surfaces that are closed).
"""

from __future__ import annotations

import itertools
from typing import NamedTuple

import numpy as np

from clearance.geometry.point_cloud import PointCloud


class CloudPoints(NamedTuple):
    """Points of a cloud, ordered by x.

    Attributes:
        every: (n, 3) [m] all of them. heads: (k, 3) [m] one of each group whose balls hang together.
    """

    every: np.ndarray
    heads: np.ndarray

    @classmethod
    def of(cls, cloud: PointCloud) -> CloudPoints:
        """Those of a cloud."""
        _, firsts = np.unique(cloud.face_component, return_index=True)
        return cls(cloud.vertices, cloud.vertices[np.sort(firsts)])

    def within(
        self,
        bounds: np.ndarray,
        world_from_body: np.ndarray,
        world_from_cloud: np.ndarray,
        one_of_each: bool = False,
    ) -> np.ndarray:
        """(m, 3) [m] the points that may be within the bounds (2, 3) [m] of a body, in the frame of the cloud.

        Args:
            one_of_each: of each group of balls that hang together only one.
        """
        corners = np.array(list(itertools.product(*bounds.T)))
        corners = (
            corners @ world_from_body[:3, :3].T + world_from_body[:3, 3] - world_from_cloud[:3, 3]
        )
        corners = corners @ world_from_cloud[:3, :3]
        slack = _ROUNDING * np.abs(corners).max()
        low, high = corners.min(axis=0) - slack, corners.max(axis=0) + slack
        points = self.heads if one_of_each else self.every
        first, last = (
            np.searchsorted(points[:, 0], low[0]),
            np.searchsorted(points[:, 0], high[0], "right"),
        )
        near = points[first:last]
        return near[((near >= low) & (near <= high)).all(axis=1)]


_ROUNDING = 1e-9
"""[-] Of the coordinates, by which a box is made larger."""
