"""Polygons of mesh files, convex or not, cut into triangles that cover exactly the polygon.

Loaders usually cut every polygon as a fan from its first corner, which covers wrong ground when it
is concave. Here a fan is used only where all its triangles turn the polygon's way; any other
polygon loses its ears one by one (Meisters, Polygons have ears, 1975). Not for: polygons with
holes.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadPolygon


def cut_polygons(vertices: np.ndarray, polygons: Sequence[Sequence[int]]) -> np.ndarray:
    """(m, 3) triangles of all polygons, in the polygons' order and orientation.

    Args:
        vertices: (n, 3) [m].
        polygons: vertex indices of each, three or more, all in range.

    Raises:
        BadPolygon: fewer than three corners, or a polygon that crosses itself.
    """
    sizes = np.array([len(polygon) for polygon in polygons], dtype=np.int64)
    if len(sizes) and sizes.min() < 3:
        i_bad = int(np.argmin(sizes))
        raise BadPolygon(f"face {i_bad} has {sizes[i_bad]} vertices", valid="three or more")
    starts = np.concatenate([[0], np.cumsum(sizes - 2)])
    triangles = np.empty((starts[-1], 3), dtype=np.int64)
    for size in np.unique(sizes):
        chosen = np.flatnonzero(sizes == size)
        rows = np.array([polygons[i] for i in chosen], dtype=np.int64)
        cut = _cut_equal(vertices, rows, chosen)
        triangles[(starts[chosen][:, None] + np.arange(size - 2)).ravel()] = cut.reshape(-1, 3)
    return triangles


def _cut_equal(vertices: np.ndarray, rows: np.ndarray, numbers: np.ndarray) -> np.ndarray:
    """(m, k - 2, 3) triangles of m polygons with k corners each."""
    size = rows.shape[1]
    fan = np.stack([np.repeat(rows[:, :1], size - 2, axis=1), rows[:, 1:-1], rows[:, 2:]], axis=2)
    if size == 3:
        return fan
    for i in np.flatnonzero(~_fans_cover(vertices[rows])):
        fan[i] = rows[i][_ears(vertices[rows[i]], int(numbers[i]))]
    return fan


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


def _ears(corners: np.ndarray, number: int) -> np.ndarray:
    """(k - 2, 3) positions of the triangles of one (k, 3) polygon."""
    normal = _newell(corners[None])[0]
    drop = int(np.argmax(np.abs(normal)))
    flat = np.delete(corners, drop, axis=1) * (
        1.0 if (normal[drop] > 0) != (drop == 1) else [1.0, -1.0]
    )
    left = list(range(len(corners)))
    triangles = []
    while len(left) > 3:
        i = _ear(flat, left)
        if i is None:
            break
        triangles.append((left[i - 1], left[i], left[(i + 1) % len(left)]))
        del left[i]
    if len(left) > 3 or _turn(*flat[left]) < 0 or not normal.any():
        raise BadPolygon(f"face {number} crosses itself", valid="a simple polygon is needed")
    return np.array([*triangles, tuple(left)])


def _ear(flat: np.ndarray, left: list[int]) -> int | None:
    """Position in `left` of a corner that can be cut off, a true ear if there is one."""
    straight = None
    for i in range(len(left)):
        a, b, c = left[i - 1], left[i], left[(i + 1) % len(left)]
        turn = _turn(flat[a], flat[b], flat[c])
        if turn == 0 and straight is None:
            straight = i
        if turn > 0 and not _holds_corner(flat, (a, b, c), left):
            return i
    return straight


def _holds_corner(flat: np.ndarray, ear: tuple[int, int, int], left: list[int]) -> bool:
    a, b, c = (flat[i] for i in ear)
    others = [flat[i] for i in left if i not in ear]
    return any(
        _turn(a, b, p) >= 0 and _turn(b, c, p) >= 0 and _turn(c, a, p) >= 0
        for p in others
        if not any(np.array_equal(p, corner) for corner in (a, b, c))
    )


def _turn(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Twice the signed area of a triangle in the plane, positive counter-clockwise."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
