"""Boxes of the plane, rows (x0, y0, x1, y1), alone and in implicit binary trees.

The children of node k are 2 k and 2 k + 1. Not for: what lies in the boxes of
the last level (`arc_fit`, `hausdorff.segments`).
"""

from clearance.compile.decorators import by_type, inline


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


@by_type
def cut_sq(best):
    """The squared distance from which on a box is passed over."""
    raise TypeError


@by_type
def with_bucket(best, arrays, bucket, x, y):
    """The nearest so far, after what lies in a box of the last level.

    Args:
        arrays: what the boxes hold, and scratch.
    """
    raise TypeError


@inline
def nearest_in(boxes, x, y, best, arrays, stack):
    """The nearest to (x, y) of all that a tree of boxes holds, near boxes first.

    Args:
        best: what is nearest so far; its type says how distances are measured. stack: (n, 2) scratch.
    """
    size = boxes.shape[0] // 2
    stack[0, 0], stack[0, 1] = 1.0, 0.0
    top = 1
    while top > 0:
        top -= 1
        node = int(stack[top, 0])
        if stack[top, 1] >= cut_sq(best):
            continue
        if node >= size:
            best = with_bucket(best, arrays, node - size, x, y)
            continue
        a, b = box_gap_sq(boxes, 2 * node, x, y), box_gap_sq(boxes, 2 * node + 1, x, y)
        nearer = 2 * node if a <= b else 2 * node + 1
        stack[top, 0], stack[top, 1] = 4 * node + 1 - nearer, max(a, b)
        stack[top + 1, 0], stack[top + 1, 1] = nearer, min(a, b)
        top += 2
    return best
