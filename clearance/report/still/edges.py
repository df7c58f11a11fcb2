"""The edges of a mesh that are seen as such: where its faces turn, or end. Not for: drawing them."""

from __future__ import annotations

import math

import numpy as np

CREASE = math.radians(25.0)
"""By how much two faces are turned against one another at the least."""


def normals(corners: np.ndarray) -> np.ndarray:
    """(n, 3) of triangles (n, 3, 3), of length 1; 0 for those without area."""
    found = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    lengths = np.linalg.norm(found, axis=1, keepdims=True)
    return np.divide(found, lengths, out=np.zeros_like(found), where=lengths > 0.0)


def seen_edges(vertices: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """(k, 2) vertices at the ends of edges that two triangles with an angle share, or that not exactly two share.

    Vertices at the same place are one.
    """
    if not len(triangles):
        return np.empty((0, 2), dtype=np.int64)
    _, firsts, names = np.unique(vertices, axis=0, return_index=True, return_inverse=True)
    turned = normals(vertices.astype(np.float64)[triangles])
    pairs = np.sort(
        firsts[names.reshape(-1)[triangles]][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1
    )
    order = np.lexsort((pairs[:, 1], pairs[:, 0]))
    pairs, faces = pairs[order], np.repeat(np.arange(len(triangles)), 3)[order]
    starts = np.flatnonzero(np.append(True, (pairs[1:] != pairs[:-1]).any(axis=1)))
    counts = np.diff(np.append(starts, len(pairs)))
    others = np.minimum(starts + 1, len(pairs) - 1)
    cosines = (turned[faces[starts]] * turned[faces[others]]).sum(axis=1)
    is_seen = (counts != 2) | (cosines < math.cos(CREASE))
    return pairs[starts[is_seen & (pairs[starts, 0] != pairs[starts, 1])]]
