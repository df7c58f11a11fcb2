"""The tree of boxes over some of the faces of a surface, in the arrays that kernels search."""

from __future__ import annotations

import numpy as np

from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.mesh.tree_build import build_tree, most_groups


def nodes_over(
    corner_points: np.ndarray, starts: np.ndarray, faces: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """`Surface.centres`, `boxes` and `children` of a tree over some `faces` (k,).

    Args:
        corner_points: (c, 3) [m] of all faces, which begin at `starts` (f + 1,).
    """
    most = most_groups(len(faces))
    centres = np.empty((3 * most, WIDTH))
    boxes = np.empty((12 * most, WIDTH), dtype=np.float32)
    children = np.empty((WIDTH * most, 2), dtype=np.int32)
    n = build_tree(corner_points, starts, faces.copy(), centres, boxes, children)
    return centres[: 3 * n].copy(), boxes[: 12 * n].copy(), children[: WIDTH * n].copy()
