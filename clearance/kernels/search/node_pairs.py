"""A group of nodes against a node of the other body: lower bounds, and which node to open next."""

from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import (
    WIDTH,
    larger,
    marks_within,
    square_root,
)
from clearance.kernels.arithmetic.vec3 import RigidMotion, dot, inverse, move, sub
from clearance.kernels.features.bounds import (
    SeparatingDirection,
    direction_between,
    lower_bound_boxes,
    lower_bound_boxes_along_direction,
    opposite,
)
from clearance.kernels.mesh.normal_cones import normal_cones_of
from clearance.kernels.mesh.surface import box_at, box_of, group_at, is_leaf
from clearance.kernels.search.displacement import (
    movement_of_box,
    movement_of_box_along,
    still_turned_away,
)


class NodeGroup(NamedTuple):
    """Nodes of one body that lie in one group, and the node of the other body that they are paired with.

    Attributes:
        is_of_b: True if the group is of b. group: its number. other: the node of the other body.
    """

    is_of_b: bool
    group: int
    other: int


class RelativeView(NamedTuple):
    """Two bodies from the frame of one of them.

    Attributes:
        m: the motion from the frame of the other to its own.
        direction: the direction that best separates them so far.
    """

    m: RigidMotion
    direction: SeparatingDirection


class Views(NamedTuple):
    """Two bodies seen from the frame of a, and from that of b."""

    a: RelativeView
    b: RelativeView


@inline(force=True)
def views_along(direction, m):
    """The view from the frame of a and that from b."""
    return Views(RelativeView(m, direction), RelativeView(inverse(m), opposite(direction)))


@inline(force=True)
def views_of(best, m):
    """The views in which the best points so far separate the bodies."""
    return views_along(direction_between(best.p, best.q, m), m)


@inline(force=True)
def boxes_of_group(a, b, nodes):
    """The boxes of a group, and that of the node of the other body."""
    boxes, centres, boxes_across, centres_across = a.boxes, a.centres, b.boxes, b.centres
    if nodes.is_of_b:
        boxes, centres, boxes_across, centres_across = b.boxes, b.centres, a.boxes, a.centres
    return group_at(boxes, centres, nodes.group), box_at(boxes_across, centres_across, nodes.other)


@inline(force=True)
def _seen(a, b, views, nodes):
    """The boxes of a group, that of a node of the other body, and the view from the group's body."""
    p, q = boxes_of_group(a, b, nodes)
    return p, q, views.b if nodes.is_of_b else views.a


@inline(force=True)
def bounds_of_group(a, b, views, nodes, marks, displacement, cut):
    """[m] lower bounds on the distances of the nodes of a group to a node of the other body, in lanes.

    Only the cheap bounds along the direction, if these exclude all marked nodes.
    """
    p, q, view = _seen(a, b, views, nodes)
    side = 1 if nodes.is_of_b else 0
    direction, slack = view.direction, displacement.slack
    along_direction = (
        lower_bound_boxes_along_direction(p, q, direction)
        - slack
        - movement_of_box_along(displacement, p, side, direction.u)
        - movement_of_box_along(displacement, q, 1 - side, direction.v)
    )
    if marks & marks_within(along_direction, cut) == 0:
        return along_direction
    anyhow = (
        lower_bound_boxes(p, q, view.m, slack)
        - movement_of_box(displacement, p, side)
        - movement_of_box(displacement, q, 1 - side)
    )
    return larger(along_direction, anyhow)


@inline(force=True)
def _from_centres(p, q, view):
    """[m] from the centres of a group's boxes, in lanes, to that of a node of the other body; in their frame."""
    return sub(move(view.m, q.centre), p.centre)


@inline(force=True)
def between_centres(a, b, views, nodes):
    """[m] from the centres of a group's boxes to that of a node of the other body, in lanes."""
    p, q, view = _seen(a, b, views, nodes)
    d = _from_centres(p, q, view)
    return square_root(dot(d, d))


@inline(force=True)
def turned_away(a, b, views, nodes, marks, bounds, displacement):
    """Bits of the marked nodes of a group that hold no nearest points with the node across, at any instant."""
    p, q, view = _seen(a, b, views, nodes)
    cones, cones_across = a.cones, b.cones
    if nodes.is_of_b:
        cones, cones_across = b.cones, a.cones
    both = normal_cones_of(
        cones, nodes.group, cones_across, nodes.other, view.m, displacement.slack
    )
    return still_turned_away(displacement, both, _from_centres(p, q, view), marks, bounds)


@inline(force=True)
def _breadth(box):
    """Sum of the two smaller half sizes: splitting reduces it even where faces are long."""
    half = box.half
    return half.x + half.y + half.z - max(half.x, max(half.y, half.z))


@inline(force=True)
def opened(a, node_a, b, node_b):
    """The children to visit next for a node pair that is not two leaves: (a group, how many nodes it has)."""
    if is_leaf(a, node_a) or (
        not is_leaf(b, node_b) and _breadth(box_of(a, node_a)) < _breadth(box_of(b, node_b))
    ):
        group, count = np.int64(b.children[node_b, 0]), np.int64(b.children[node_b, 1])
        return NodeGroup(True, group, node_a), count
    group, count = np.int64(a.children[node_a, 0]), np.int64(a.children[node_a, 1])
    return NodeGroup(False, group, node_b), count


@inline(force=True)
def pair_in_group(nodes, k):
    """Node `k` of a group and the node across, that of a first."""
    node = WIDTH * nodes.group + k
    return (nodes.other, node) if nodes.is_of_b else (node, nodes.other)
