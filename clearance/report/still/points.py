"""Points of a cloud as small solids, so that a picture and a model of a moment show them as they show all else.

Not for: how large the balls about them are, which no replay holds.
"""

from __future__ import annotations

import numpy as np

HALF = 0.002
"""[m] From a point to the corners of its solid."""

MOST = 20_000
"""Points of a cloud that are shown, evenly spread: 160,000 triangles."""

_CORNERS = HALF * np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]])
_FACES = np.array(
    [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4], [2, 0, 5], [1, 2, 5], [3, 1, 5], [0, 3, 5]]
)


def as_solids(vertices: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Vertices and triangles of a shape; those of an octahedron about each point where it has no triangles."""
    if len(triangles):
        return vertices, triangles
    points = vertices[:: -(-len(vertices) // MOST)]
    corners = points[:, None] + _CORNERS
    faces = _FACES + len(_CORNERS) * np.arange(len(points))[:, None, None]
    return corners.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.int32)
