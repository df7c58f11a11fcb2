"""Warnings on scans whose balls stand alone: what is thinner than the gaps between them passes through."""

from __future__ import annotations

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from clearance.geometry.point_cloud import PointCloud
from clearance.world.case import Case
from clearance.world.notice import Notice, Severity

SAMPLED = 200
"""Points that are asked whether their ball touches another."""


def notices_on_scans(case: Case) -> Iterator[Notice]:
    """A warning on each scan most of whose balls touch no other."""
    for obstacle in case.obstacles:
        shape = obstacle.body.shape
        if isinstance(shape, PointCloud) and _has_gaps(shape):
            mm = f"{1e3 * shape.ball_radius:.4g} mm"
            text = (
                f"scan {obstacle.name!r}: most of its balls of {mm} touch no other: what is thinner than the gaps "
                "between them passes through; its radius should be at least the distance of neighbouring points"
            )
            yield Notice(Severity.WARNING, "scan", text)


@lru_cache(maxsize=16)
def _has_gaps(shape: PointCloud) -> bool:
    """True if most of some balls, evenly spread, stand alone."""
    points = shape.vertices
    chosen = points[:: -(-len(points) // SAMPLED)]
    n_alone = sum(not _touches_another(point, points, shape.ball_radius) for point in chosen)
    return 2 * n_alone > len(chosen)


def _touches_another(point: np.ndarray, points: np.ndarray, radius: float) -> bool:
    """True if the ball about a point touches that of another of `points` (n, 3), which are ordered by x."""
    reach = 2.0 * radius
    ends = np.searchsorted(points[:, 0], [point[0] - reach, np.nextafter(point[0] + reach, np.inf)])
    near = points[ends[0] : ends[1]] - point
    return int(np.count_nonzero((near**2).sum(axis=1) <= reach * reach)) > 1
