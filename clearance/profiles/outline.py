"""From a region of many small edges to lines and arcs around it, with the bounds proven on the result.

The region is offset outward by what its points may be short of the truth (`inner`) plus the tolerance of the
arcs; arcs are fitted to the offset; then the least distance of the arcs from the region is measured (on chords
of known height) and the greatest (`clearance.planar`, certified), so that neither the offset nor the fit has to
be trusted. Not for: the region itself (`sweep`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.errors import BadDimension
from clearance.kernels.profile.outline_arcs import arcs_of_ring
from clearance.planar.curve import Curve
from clearance.planar.hausdorff import hausdorff
from clearance.profiles.contour import Contour, joined
from clearance.profiles.region import (
    Region,
    boundary_distance,
    contains,
    grown,
    inner_points,
    region_of,
    rings_of,
    smoothed,
)

ROUNDING = 1e-8
"""[m] Subtracted from every tolerance, since unions move vertices: ten times `region.GRID`."""


@dataclass(frozen=True)
class Outline:
    """Contours around a region.

    Attributes:
        contours: outer ones counter-clockwise, holes clockwise.
        inner: [m] every point within this of the region lies inside the contours (proven).
        outer: [m] no point inside the contours is farther than this from the region (proven).
    """

    contours: tuple[Contour, ...]
    inner: float
    outer: float


def outline_of(region: Region, inner: float, tolerance: float) -> Outline:
    """Lines and arcs around all points within `inner` [m] of the region, none beyond `tolerance` [m] of it.

    Raises:
        BadDimension: the tolerance is too small for `inner`.
    """
    slack = (tolerance - ROUNDING - 1.04 * (inner + ROUNDING)) / 2.1
    if not slack > 1e-3 * tolerance:
        raise BadDimension(
            f"a tolerance of {tolerance:g} m beside {inner:g} m of motion between samples",
            where="tolerance",
            valid="a larger tolerance",
        )
    boundary = Curve.contours([Curve.polyline(ring, closed=True) for ring, _ in rings_of(region)])
    for _ in range(4):
        offset = inner + ROUNDING + slack
        contours = tuple(
            _fitted(ring, 0.85 * slack)
            for ring, _ in rings_of(smoothed(grown(region, offset), 0.1 * slack))
        )
        height = 1e-3 * tolerance
        chords = [contour.flattened(height) for contour in contours]
        gap = boundary_distance(region, chords) - height - ROUNDING
        if gap >= inner and _encloses(contours, chords, region):
            far = hausdorff(joined(contours), boundary).directed["a_to_b"].upper
            # Holes narrower than twice the offset are filled: their points are within the offset.
            return Outline(contours, gap, max(far, 1.03 * offset) + ROUNDING)
        slack *= 0.6
    raise AssertionError("no outline within its tolerance around a region of finite extent")


def _fitted(ring: np.ndarray, tolerance: float) -> Contour:
    distinct = np.any(ring != np.roll(ring, 1, axis=0), axis=1)
    points = np.ascontiguousarray(ring[distinct])
    starts, bulges = arcs_of_ring(points, tolerance)
    if len(starts) < 3:  # a ring no larger than the tolerance stays as it is
        starts, bulges = np.arange(len(points)), np.zeros(len(points))
    return Contour(points[starts], bulges)


def _encloses(contours: tuple[Contour, ...], chords: list[np.ndarray], region: Region) -> bool:
    """True if the contours, none of which comes near the region's boundary, have all of it inside."""
    starts = np.array([contour.vertices[0] for contour in contours])
    return bool(
        contains(region_of(chords), inner_points(region)).all()
        and not contains(region, starts).any()
    )
