"""The adapter of shapely: unions, offsets, areas and membership of plane regions.

Rings are (n, 2) arrays without the first point repeated, outer ones counter-clockwise, holes clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, NamedTuple, TypeAlias

import numpy as np

from clearance.extras import Library
from clearance.kernels.profile.swept_cover import Raster

if TYPE_CHECKING:
    import shapely
else:
    shapely = Library("shapely", "profiles", "a profile")

Region: TypeAlias = "shapely.Geometry"
"""A polygon or several, possibly empty."""

GRID = 1e-9
"""[m] Where GEOS fails in floating point, unions are computed on a grid of this width instead."""


def polygons(corners: np.ndarray, n_corners: np.ndarray) -> np.ndarray:
    """(m,) regions of convex polygons `corners` (m, k, 2), of which the first `n_corners` count."""
    if not len(n_corners):
        return np.zeros(0, dtype=object)
    used = corners[np.arange(corners.shape[1]) < n_corners[:, None]]
    rings = shapely.linearrings(used, indices=np.repeat(np.arange(len(n_corners)), n_corners))
    return shapely.polygons(rings)


def widened(corners: np.ndarray, n_corners: np.ndarray, by: float, excess: float) -> np.ndarray:
    """(m,) regions of the same polygons with all points within `by` [m], and none beyond that and `excess`."""
    n = max(8, math.ceil(math.pi / math.acos(by / (by + excess))))
    angles = 2.0 * np.pi / n * np.arange(n)
    around = by / math.cos(math.pi / n) * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    last = np.minimum(np.arange(corners.shape[1]), n_corners[:, None] - 1)
    used = np.take_along_axis(corners, last[:, :, None], axis=1)
    points = (used[:, :, None] + around).reshape(len(used), -1, 2)
    return shapely.convex_hull(shapely.linestrings(points))


def union(parts: Sequence[Region] | np.ndarray) -> Region:
    """The union of regions; on a fine grid where floating point fails."""
    parts = np.asarray(parts, dtype=object)
    try:
        found = shapely.unary_union(parts)
    except shapely.GEOSException:
        found = shapely.unary_union(parts, grid_size=GRID)
    return _areas(found)


def covered_region(raster: Raster) -> Region:
    """The covered pixels: runs of each row, equal runs of neighbouring rows joined."""
    edge = np.diff(np.pad(raster.covered, ((0, 0), (1, 1))).astype(np.int8), axis=1)
    rows, starts = np.nonzero(edge == 1)
    stops = np.nonzero(edge == -1)[1]
    open_runs: dict[tuple[int, int], int] = {}
    boxes = []
    for row in range(raster.covered.shape[0] + 1):
        here = {
            (a, b)
            for a, b in zip(starts[rows == row].tolist(), stops[rows == row].tolist(), strict=True)
        }
        for run in [run for run in open_runs if run not in here]:
            boxes.append((run[0], open_runs.pop(run), run[1], row))
        for run in here:
            open_runs.setdefault(run, row)
    if not boxes:
        return shapely.Polygon()
    low = np.array([raster.x, raster.y, raster.x, raster.y])
    x0, y0, x1, y1 = (low + raster.pixel * np.array(sorted(boxes), float)).T
    return union(shapely.box(x0, y0, x1, y1))


def convex_parts(region: Region) -> tuple[np.ndarray, np.ndarray]:
    """Triangles (m, 3, 2) that make up a region, and their numbers of corners (m,)."""
    parts = [
        shapely.get_parts(shapely.constrained_delaunay_triangles(part))
        for part in shapely.get_parts(region)
    ]
    triangles = [shapely.get_coordinates(part)[:3] for group in parts for part in group]
    return np.array(triangles).reshape(-1, 3, 2), np.full(len(triangles), 3)


def grown(region: Region, distance: float) -> Region:
    """The region offset outward by at least `distance` and at most 3 % more; narrow holes close."""
    # Four chords a quarter circle fall short by 1 - cos(pi / 16) = 1.9 %; GEOS simplifies within 1 %.
    return _areas(region.buffer(1.03 * distance, quad_segs=4))


def smoothed(region: Region, distance: float) -> Region:
    """The region with fewer vertices, its boundary within `distance` (Douglas and Peucker 1973)."""
    return _areas(shapely.simplify(region, distance))


def rings_of(region: Region) -> list[tuple[np.ndarray, bool]]:
    """Each ring and whether it is a hole; outer rings by their lowest left corner, each with its holes."""
    parts = [shapely.normalize(part) for part in shapely.get_parts(region) if part.area > 0.0]
    parts = sorted(parts, key=lambda part: part.bounds)
    found = []
    for part in parts:
        part = shapely.orient_polygons(part, exterior_cw=False)
        holes = sorted(part.interiors, key=lambda hole: hole.bounds)
        for k, ring in enumerate([part.exterior, *holes]):
            found.append((np.array(ring.coords)[:-1], k > 0))
    return found


def region_of(rings: Sequence[np.ndarray]) -> Region:
    """The region that a set of closed rings encloses, by parity."""
    found = shapely.Polygon()
    for ring in rings:
        polygon = shapely.make_valid(shapely.Polygon(ring))
        found = shapely.symmetric_difference(found, polygon)
    return _areas(found)


class Overlap(NamedTuple):
    """Two rings of which neither holds the other; or one twice, which laps over itself. `point` lies in both."""

    first: int
    second: int
    point: tuple[float, float]


def overlap_of(rings: Sequence[np.ndarray], width: float) -> Overlap | None:
    """The first overlap of closed rings, where parity would leave out what two of them enclose; or None.

    Args:
        width: [m] overlaps no wider along the whole of a ring count as touching.
    """
    drawn = [shapely.Polygon(ring) for ring in rings]
    for i, one in enumerate(drawn):
        if not one.is_valid:
            wound = shapely.make_valid(one, method="structure", keep_collapsed=False)
            left_out = shapely.symmetric_difference(shapely.make_valid(one), wound)
            if left_out.area > width * one.length:
                return Overlap(i, i, _inner_point(left_out))
    filled = np.array([shapely.make_valid(one) for one in drawn])
    for i, k in shapely.STRtree(filled).query(filled, predicate="intersects").T.tolist():
        one, two = filled[i], filled[k]
        shared = shapely.intersection(one, two)
        slack = width * min(one.length, two.length)
        is_nested = min(one.area, two.area) - shared.area <= slack < abs(one.area - two.area)
        if i < k and shared.area > slack and not is_nested:
            return Overlap(i, k, _inner_point(shared))
    return None


def crosses_itself(ring: np.ndarray, width: float) -> bool:
    """True if a closed ring encloses another area than its corners say with their signs.

    Args:
        width: [m] a difference no wider along the whole ring is none: the ring touches itself, at most.
    """
    drawn = shapely.Polygon(ring)
    if drawn.is_valid:
        return False
    return bool(abs(shapely.make_valid(drawn).area - drawn.area) > width * drawn.length)


def _inner_point(region: Region) -> tuple[float, float]:
    x, y = region.representative_point().coords[0]
    return x, y


def area(region: Region) -> float:
    """[m^2]"""
    return float(region.area)


def difference(one: Region, two: Region) -> Region:
    """The points of `one` outside `two`."""
    return _areas(shapely.difference(one, two))


def contains(region: Region, points: np.ndarray) -> np.ndarray:
    """(n,) whether points (n, 2) lie in the region."""
    shapely.prepare(region)
    return shapely.contains_xy(region, points[:, 0], points[:, 1])


def inner_points(region: Region) -> np.ndarray:
    """(k, 2) one point inside each part of the region."""
    return np.array([part.representative_point().coords[0] for part in shapely.get_parts(region)])


def boundary_distance(region: Region, rings: Sequence[np.ndarray]) -> float:
    """The least distance between the region's boundary and closed rings."""
    lines = shapely.MultiLineString([np.concatenate([ring, ring[:1]]) for ring in rings])
    boundary = shapely.boundary(region)
    shapely.prepare(boundary)
    return float(shapely.distance(boundary, lines))


def nearest_parts(parts: np.ndarray, points: np.ndarray) -> np.ndarray:
    """(n,) index of the region that is nearest to each of points (n, 2); the first one on ties."""
    asked, found = shapely.STRtree(parts).query_nearest(shapely.points(points))
    first = np.full(len(points), np.iinfo(np.int64).max)
    np.minimum.at(first, asked, found)
    return first


def touching(region: Region, parts: np.ndarray) -> np.ndarray:
    """(m,) whether each part comes to the boundary of the region."""
    boundary = shapely.boundary(region)
    shapely.prepare(boundary)
    return shapely.dwithin(boundary, parts, 2.0 * GRID)


def _areas(region: Region) -> Region:
    parts = [
        part
        for part in shapely.get_parts(region)
        if part.geom_type == "Polygon" and part.area > 0.0
    ]
    return (
        shapely.Polygon()
        if not parts
        else parts[0]
        if len(parts) == 1
        else shapely.MultiPolygon(parts)
    )
