"""Boxes of the plane, rows (x0, y0, x1, y1), alone and in implicit binary trees.

The children of node k are 2 k and 2 k + 1. Not for: what lies in the boxes of
the last level (`arc_fit`, `hausdorff.segments`).
"""

from clearance.compile.decorators import inline


@inline
def box_gap_sq(boxes, node, x, y):
    """The squared distance from (x, y) to a box: a lower bound for all that is in it."""
    dx = max(boxes[node, 0] - x, 0.0, x - boxes[node, 2])
    dy = max(boxes[node, 1] - y, 0.0, y - boxes[node, 3])
    return dx * dx + dy * dy


@inline
def fill_inner_boxes(boxes):
    """Writes the inner nodes of a tree (2 P, 4) of which the P boxes of the last level are there."""
    for node in range(boxes.shape[0] // 2 - 1, 0, -1):
        for c in range(2):
            boxes[node, c] = min(boxes[2 * node, c], boxes[2 * node + 1, c])
            boxes[node, c + 2] = max(boxes[2 * node, c + 2], boxes[2 * node + 1, c + 2])
