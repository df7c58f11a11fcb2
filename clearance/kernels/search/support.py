"""The farthest point of a body along a direction, and the faces near it: descents of one tree.

A node that is turned away from u holds no farthest point along u. Otherwise u or -u would be among the directions
of its normal cone, by the proof in `normal_cones`: nothing lies beyond a farthest point, as nothing lies between
nearest points. Not for: two trees at once (`descent`).
"""

import math
from typing import NamedTuple

import numpy as np

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH, first_of, lane, lanes_at, marks_within
from clearance.kernels.arithmetic.vec3 import Vec3, dot, row
from clearance.kernels.features.bounds import box_reach
from clearance.kernels.mesh.normal_cones import CONE_ROWS
from clearance.kernels.mesh.surface import group_of, is_leaf
from clearance.kernels.search.scratch import wait

TILT = 2.0**-9
"""[rad] The farthest point is found for all directions within this of the given one."""

UNLIKE_ANY = 2.0**-19
"""Makes `NO_CONE`, the sine of a node without a cone, exceed any cosine; others lose 2^-19."""


class SupportPoint(NamedTuple):
    """The corner of a body that is farthest along a direction.

    Attributes:
        height: [m] from the origin of the body's frame along the direction; -inf if there is none.
        face, corner: a face that has it, and its place in `Surface.face_vertices`.
    """

    height: float
    face: int
    corner: int


@inline(force=True)
def _top_of_face(surface, face, u):
    """The `SupportPoint` of one face."""
    top = SupportPoint(-math.inf, face, 0)
    for c in range(surface.face_starts[face], surface.face_starts[face + 1]):
        height = dot(u, row(surface.vertices, surface.face_vertices[c]))
        if height > top.height:
            top = SupportPoint(height, face, c)
    return top


@inline(force=True)
def _top_known(surface, face, u):
    """The `SupportPoint` of a face, none for -1."""
    return _top_of_face(surface, face, u) if face >= 0 else SupportPoint(-math.inf, face, 0)


@inline(force=True)
def _heights(surface, group, u):
    """[m] the greatest heights of the boxes of a group along `u`, in lanes."""
    boxes = group_of(surface, group)
    return dot(u, boxes.centre) + box_reach(boxes, u)


@inline(force=True)
def _turned_away(surface, group, u):
    """Bits of the nodes of a group that hold no farthest point along any direction within `TILT` of `u`."""
    cones, first = surface.cones, CONE_ROWS * group
    axis = Vec3(lanes_at(cones, first), lanes_at(cones, first + 1), lanes_at(cones, first + 2))
    cosine = lanes_at(cones, first + 3) - lanes_at(cones, first + 4) * UNLIKE_ANY
    return marks_within(abs(dot(axis, u)) - cosine, -TILT)


@inline(force=True)
def _open(surface, node, u, least, scratch, n_waiting):
    """Queues the children of a node that may reach a height [m], the highest last: (waiting, children)."""
    group, count = np.int64(surface.children[node, 0]), np.int64(surface.children[node, 1])
    depths = 0.0 - _heights(surface, group, u)
    near = marks_within(depths, -least) & ((1 << count) - 1) & ~_turned_away(surface, group, u)
    first = n_waiting
    while near:
        i = first_of(near)
        near &= near - 1
        n_waiting = wait(scratch, n_waiting, WIDTH * group + i, 0, lane(depths, i), first)
    return n_waiting, count


@inline(force=True)
def top_of(surface, root, u, face, tolerance, most, column, scratch):
    """The `SupportPoint` of a body along a unit vector `u` of its frame, and the leaves near it.

    Args:
        face: where to begin, or -1.
        tolerance: [m] how far below the top a leaf is still near; more than rounding.
        most: leaves to write into a column of `scratch.entries`; one more is counted where there are more.

    Returns: (the `SupportPoint`, how many leaves, nodes visited). Some of the leaves may be lower.
    """
    top = _top_known(surface, face, u)
    scratch.nodes[0, 0], scratch.bounds[0] = root, -math.inf
    n_waiting, n_nodes, n_found = 1, 1, 0
    while n_waiting > 0:
        n_waiting -= 1
        node = np.int64(scratch.nodes[n_waiting, 0])
        if -scratch.bounds[n_waiting] < top.height - tolerance:
            continue
        if not is_leaf(surface, node):
            n_waiting, count = _open(surface, node, u, top.height - tolerance, scratch, n_waiting)
            n_nodes += count
            continue
        found = _top_of_face(surface, np.int64(surface.children[node, 0]), u)
        if found.height < top.height - tolerance:
            continue
        if found.height > top.height:
            if found.height - tolerance > top.height:
                n_found = 0
            top = found
        if n_found <= most:
            scratch.entries[n_found, column] = node
            n_found += 1
    return top, n_found, n_nodes


@inline(force=True)
def high_corner(surface, root, u, face):
    """A corner that is high along `u`, perhaps not the `SupportPoint`; the nodes on the one path down to it."""
    top = _top_known(surface, face, u)
    node, n_nodes = np.int64(root), 1
    while not is_leaf(surface, node):
        group, count = np.int64(surface.children[node, 0]), np.int64(surface.children[node, 1])
        heights = _heights(surface, group, u)
        highest = 0
        for k in range(1, count):
            if lane(heights, k) > lane(heights, highest):
                highest = k
        node = WIDTH * group + highest
        n_nodes += count
    found = _top_of_face(surface, np.int64(surface.children[node, 0]), u)
    return (found if found.height > top.height else top), n_nodes
