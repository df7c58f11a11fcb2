"""Polygons of mesh files, convex or not, cut into triangles that cover exactly the polygon.

Loaders usually cut every polygon as a fan from its first corner, which covers wrong ground when it
is concave. Here a fan is used only where all its triangles turn the polygon's way; any other
polygon loses its ears one by one (Meisters, Polygons have ears, 1975; `kernels.mesh.ears`).
Not for: polygons with holes.
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadPolygon
from clearance.kernels.mesh.ears import TOO_MUCH, cut_ears

MOST_WORK = 1_000_000_000
"""Corners that cutting the polygons of a piece may look at: some 3 s. A star of 100,000 corners takes
270,000,000."""


def cut_rings(vertices: np.ndarray, corners: np.ndarray, counts: np.ndarray) -> np.ndarray:
    """(m, 3) triangles of all polygons, in the polygons' order and orientation.

    Args:
        vertices: (n, 3) [m], finite where they are used.
        corners: vertex indices of all polygons one after the other, all in range.
        counts: how many corners each polygon has, three or more.

    Raises:
        BadPolygon: fewer than three corners, a polygon that crosses itself, or one that is too intricate.
    """
    if len(counts) and counts.min() < 3:
        i_bad = int(np.argmin(counts))
        raise BadPolygon(f"face {i_bad} has {counts[i_bad]} vertices", valid="three or more")
    firsts = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    starts = np.concatenate([[0], np.cumsum(counts - 2)]).astype(np.int64)
    triangles = np.empty((starts[-1], 3), dtype=np.int64)
    work = np.array([MOST_WORK])
    for size in np.unique(counts):
        chosen = np.flatnonzero(counts == size)
        rows = corners[firsts[chosen][:, None] + np.arange(size)]
        cut = _cut_equal(vertices, rows, chosen, work)
        triangles[(starts[chosen][:, None] + np.arange(size - 2)).ravel()] = cut.reshape(-1, 3)
    return triangles


def _cut_equal(
    vertices: np.ndarray, rows: np.ndarray, numbers: np.ndarray, work: np.ndarray
) -> np.ndarray:
    """(m, k - 2, 3) triangles of m polygons with k corners each."""
    size = rows.shape[1]
    fan = np.stack([np.repeat(rows[:, :1], size - 2, axis=1), rows[:, 1:-1], rows[:, 2:]], axis=2)
    if size == 3:
        return fan
    corners = _within_one(vertices[rows])
    for i in np.flatnonzero(~_fans_cover(corners)):
        fan[i] = rows[i][_ears(corners[i], int(numbers[i]), work)]
    return fan


def _within_one(corners: np.ndarray) -> np.ndarray:
    """(m, k, 3) polygons, each divided by a power of two: the same polygons without overflow."""
    greatest = np.abs(corners).max(axis=(1, 2), keepdims=True)
    return np.ldexp(corners, -np.frexp(greatest)[1])


def _fans_cover(corners: np.ndarray) -> np.ndarray:
    """(m,) whether the fan from the first corner covers each (k, 3) polygon."""
    normals = _newell(corners)
    edges = np.roll(corners, -1, axis=1) - corners
    turns = np.einsum("mki,mi->mk", np.cross(np.roll(edges, 1, axis=1), edges), normals)
    spokes = corners[:, 1:] - corners[:, :1]
    sweeps = np.einsum("mki,mi->mk", np.cross(spokes[:, :-1], spokes[:, 1:]), normals)
    flat = ~np.cross(spokes[:, :-1], spokes[:, 1:]).any(axis=(1, 2))
    return (turns >= 0).all(axis=1) & (sweeps >= 0).all(axis=1) & (normals.any(axis=1) | flat)


def _newell(corners: np.ndarray) -> np.ndarray:
    """(m, 3) twice the vector area of (m, k, 3) polygons."""
    local = corners - corners[:, :1]
    return np.cross(local, np.roll(local, -1, axis=1)).sum(axis=1)


def _ears(corners: np.ndarray, number: int, work: np.ndarray) -> np.ndarray:
    """(k - 2, 3) positions of the triangles of one (k, 3) polygon."""
    normal = _newell(corners[None])[0]
    drop = int(np.argmax(np.abs(normal)))
    sign = 1.0 if (normal[drop] > 0) != (drop == 1) else -1.0
    flat = np.ascontiguousarray(np.delete(corners, drop, axis=1) * [1.0, sign])
    triangles = np.empty((len(flat) - 2, 3), dtype=np.int64)
    outcome, spent = cut_ears(flat, triangles, work[0])
    work -= spent
    if outcome == TOO_MUCH:
        raise BadPolygon(
            f"face {number} of {len(flat)} corners is too intricate", valid="export triangles"
        )
    if outcome or not normal.any():
        raise BadPolygon(f"face {number} crosses itself", valid="a simple polygon is needed")
    return triangles


def strip(corners: np.ndarray) -> np.ndarray:
    """(n - 2, 3) the triangles of a strip of n corners; every other one is turned, so that all face one way."""
    triangles = (
        np.lib.stride_tricks.sliding_window_view(corners, 3).copy() if len(corners) > 2 else _none()
    )
    triangles[1::2] = triangles[1::2][:, [1, 0, 2]]
    return triangles


def fan(corners: np.ndarray) -> np.ndarray:
    """(n - 2, 3) the triangles of a fan of n corners about its first."""
    if len(corners) < 3:
        return _none()
    return np.stack([np.full(len(corners) - 2, corners[0]), corners[1:-1], corners[2:]], axis=1)


def _none() -> np.ndarray:
    return np.empty((0, 3), dtype=np.int64)
