"""Bounds of the depth from the common region of two bodies: directions worth trying, and balls inside it.

Both from above and from below without cutting a body into convex parts.
"""

from __future__ import annotations

import numpy as np

from clearance.geometry.boolean import ClosedMesh
from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.arithmetic.union_find import joined_labels
from clearance.query.retreat import Ray

MOST_WAYS = 16
"""Normals of the region along which it is measured, both ways each: those of the greatest area."""

CHORDS = 12
"""Triangles of the region below which a ball is tried, in the middle of the chord."""

SURE = 1.0 - 1e-9
"""[-] The share of a ball's radius that counts: its middle and distances are rounded."""


def ways_through(region: ClosedMesh) -> list[Ray]:
    """Translations as long as the region is thick along its own normals, shortest first.

    The faces of a region are the bodies' own: along a normal is how a body would leave the other's face.
    """
    corners = region.vertices[region.triangles]
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(sides, axis=1)
    normals = sides[areas > 0.0] / areas[areas > 0.0, None]
    alike, group = np.unique(np.round(normals, 1), axis=0, return_inverse=True)
    share = np.bincount(group.ravel(), weights=areas[areas > 0.0], minlength=len(alike))
    chosen = np.argsort(-share, kind="stable")[:MOST_WAYS]
    first = np.array([int(np.flatnonzero(group.ravel() == k)[0]) for k in chosen], dtype=np.int64)
    directions = np.concatenate([normals[first], -normals[first]])
    lengths = thickness(region, directions)
    return [Ray(float(lengths[i]), directions[i]) for i in np.argsort(lengths, kind="stable")]


def thickness(region: ClosedMesh, directions: np.ndarray) -> np.ndarray:
    """(k,) [m] how thick the thickest piece of a region is along each unit direction (k, 3)."""
    sides = region.triangles[:, [0, 1, 1, 2]].reshape(-1, 2)
    piece = joined_labels(len(region.vertices), *np.ascontiguousarray(sides.T))
    order = np.argsort(piece, kind="stable")
    starts = np.searchsorted(piece[order], np.arange(piece.max() + 1))
    heights = (region.vertices @ directions.T)[order]
    return (np.maximum.reduceat(heights, starts) - np.minimum.reduceat(heights, starts)).max(axis=0)


def ball_depth(region: ClosedMesh, bodies: list[np.ndarray], lost: float) -> float:
    """[m] no shorter translation parts two bodies that share the region.

    A ball about a point of the region that lies in body a, and one in b: to separate them takes the sum of their
    radii. A point's radius is its distance from the body's own triangles.

    Args:
        bodies: the triangles (t, 3, 3) [m] of each. lost: [m] what facets may stand out, of both together.
    """
    corners = region.vertices[region.triangles]
    middles = _middles_of_chords(corners)
    if not len(middles):
        return 0.0
    radii = np.array([_distance(middle, corners) for middle in middles])
    best = middles[int(radii.argmax())]
    far = float(np.abs(region.vertices).max())
    total = sum(_distance(best, triangles) for triangles in bodies)
    return max(0.0, SURE * total - lost - 1e-12 * far)


def volume_of_facets(body: Polyhedron, pose: np.ndarray, region: ClosedMesh) -> float:
    """[m^3] what facets of a body at a pose that stand out can add to a region."""
    if body.excess == 0.0:
        return 0.0
    corners = body.vertices[body.triangles()] @ pose[:3, :3].T + pose[:3, 3]
    low, high = region.vertices.min(axis=0), region.vertices.max(axis=0)
    reach = 2.0 * body.excess
    near = (corners.min(axis=1) <= high + reach).all(axis=1)
    near &= (corners.max(axis=1) >= low - reach).all(axis=1)
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return float(0.5 * np.linalg.norm(sides[near], axis=1).sum() * body.excess)


def _middles_of_chords(corners: np.ndarray) -> np.ndarray:
    """(k, 3) [m] points inside a closed surface (t, 3, 3): half way from a triangle to the opposite one."""
    sides = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    areas = np.linalg.norm(sides, axis=1)
    largest = np.argsort(-areas, kind="stable")[: CHORDS // 2]
    spread = np.arange(0, len(corners), max(1, len(corners) // (CHORDS - CHORDS // 2)))
    chosen = [
        int(i) for i in dict.fromkeys([*largest.tolist(), *spread.tolist()]) if areas[i] > 0.0
    ]
    found = []
    for i in chosen[:CHORDS]:
        start, inward = corners[i].mean(axis=0), -sides[i] / areas[i]
        way = _first_hit(corners, i, start, inward)
        if np.isfinite(way):
            found.append(start + 0.5 * way * inward)
    return np.array(found).reshape(-1, 3)


def _first_hit(corners: np.ndarray, own: int, start: np.ndarray, along: np.ndarray) -> float:
    """[m] how far a ray from the triangle `own` goes to the next one; infinite if it meets none.

    Source: Möller & Trumbore (1997).
    """
    one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
    across = np.cross(along, two)
    volume = np.einsum("ij,ij->i", one, across)
    with np.errstate(divide="ignore", invalid="ignore"):
        off = start - corners[:, 0]
        u = np.einsum("ij,ij->i", off, across) / volume
        turned = np.cross(off, one)
        v = turned @ along / volume
        way = np.einsum("ij,ij->i", two, turned) / volume
        met = (u >= 0.0) & (v >= 0.0) & (u + v <= 1.0) & (way > 0.0)
    met[own] = False
    return float(way[met].min(initial=np.inf))


def _distance(point: np.ndarray, corners: np.ndarray) -> float:
    """[m] of a point from triangles (t, 3, 3), not more than the truth but for rounding.

    The nearest point of a triangle is its foot where that is inside, or else on an edge.
    """
    corners = corners[_may_be_nearest(corners, point)]
    off = corners - point
    ahead = np.roll(corners, -1, axis=1) - corners
    lengths = np.einsum("ijk,ijk->ij", ahead, ahead)
    share = -np.einsum("ijk,ijk->ij", off, ahead) / np.where(lengths > 0.0, lengths, 1.0)
    on_edge = off + np.clip(share, 0.0, 1.0)[..., None] * ahead
    least = np.einsum("ijk,ijk->ij", on_edge, on_edge).min(axis=1)
    normal = np.cross(ahead[:, 0], ahead[:, 1])
    area_sq = np.einsum("ij,ij->i", normal, normal)
    height = np.einsum("ij,ij->i", off[:, 0], normal)
    sides = np.einsum("ijk,ik->ij", np.cross(ahead, -off), normal)
    inside = (sides >= 0.0).all(axis=1) & (area_sq > 0.0)
    foot = height * height / np.where(area_sq > 0.0, area_sq, 1.0)
    return float(np.sqrt(np.where(inside, np.minimum(foot, least), least).min()))


def _may_be_nearest(corners: np.ndarray, point: np.ndarray) -> np.ndarray:
    """(t,) False for triangles whose box is farther from the point than the nearest corner of all."""
    off = corners - point
    low, high = off.min(axis=1), off.max(axis=1)
    outside = np.maximum(0.0, np.maximum(low, -high))
    nearest_sq = np.einsum("ij,ij->i", off[:, 0], off[:, 0]).min()
    return np.einsum("ij,ij->i", outside, outside) <= nearest_sq * (1.0 + 1e-9)
