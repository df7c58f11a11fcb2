"""The flat form of polyhedra in kernels: faces, the features that each face owns, and the tree.

Every vertex and edge is owned by the face of least index that holds it, so that a search over face pairs
meets each pair of features once (Curtis, Tamstorf & Manocha 2008, representative triangles) and ties fall
to the least index by themselves. Several bodies lie one after the other in one `Surface`, with `roots`.
"""

from typing import NamedTuple

import numpy as np

from clearance.compile.declared import (
    Bits16,
    Flags,
    Floats,
    Floats2,
    Integers,
    Integers2,
    Shorts,
    Shorts2,
    Singles2,
)
from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import WIDTH, lanes_at, number_at
from clearance.kernels.arithmetic.vec3 import Vec3, along

LISTED = 8
"""Corners that a face may have for `Surface.owns` to have a bit for each."""

ANYTHING = (1 << 2 * LISTED) - 1
"""All bits of `Surface.owns`."""


class Surface(NamedTuple):
    """Bodies as flat arrays; all indices are into these arrays.

    Attributes:
        vertices: (v, 3) [m], each in the frame of its body, ordered by coordinates.
        exact: (v, 3) [m] the vertices as given, where `vertices` are rounded differences; else the same.
        face_starts, face_vertices: (f + 1,), (c,) corners of the faces in order.
        normals: (f, 3) unit outward, zeros where a face is so slender that rounding decides them.
        blunt: (f,) the reciprocal of a lower bound on the sharpest corner's angle; 1 without a normal.
        width: (f,) [m] the greatest distance of the fan from its plane, or from its edges without one; where
            it bends inward, also by how much points over it may seem outside.
        bent: (f,) True where the corners are not exactly in one plane or the boundary turns the wrong way.
        corner_normals: (c, 3) in-plane unit normals of the edges that start at the corners, outward.
        vertex_starts, owned_vertices: (f + 1,), the vertices that each face owns.
        edge_starts, owned_edges: (f + 1,), (e, 2) the edges that each face owns, a bent one then its diagonals.
        owns: (f,) the same by bits: k of corner k, `LISTED` + k of the edge that starts there; all are set where a
            face has more than `LISTED` corners or is bent.
        centres: (3 g, 4) [m] of the boxes of the tree's nodes, in the body frame. Node n is lane n % 4 of group
            n // 4; lanes without a node repeat the first.
        boxes: (12 g, 4) in single precision, rounded outward: nine numbers of three axes, three half sizes [m].
        cones: (6 g, 4) in single precision: axis, cosine and sine of the half angle of each node's normal cone
            (`normal_cones`; its `NO_CONE` for the sine where there is none), and the radius of a ball about its
            box [m].
        children: (4 g, 2) of node n: a group and how many nodes of it, or for a leaf (face, 0). Of faces with the
            same corners, either way round, only the least has a leaf.
        roots: (bodies,) root nodes, each alone in its group.
        probe_starts, probes: (bodies + 1,), a vertex of each connected component of each body.
        turns: (f,) how often a face counts in a winding number: once for each copy that runs the same way, less
            those that run the other way; 0 in components that are neither closed and consistently oriented nor so
            but for a few faults.
        cap_starts, caps: (bodies + 1,), (3 k, 3) [m] the corners of the triangles that close those that are so but
            for a few faults, in the body frame. They count once in a winding number, and nowhere else.
        radii: (bodies,) [m] of the ball about each point of a cloud, 0 for other bodies. A cloud's faces have one
            corner each, no edges and no normal; its root's box holds the balls, other boxes their centres.
    """

    vertices: Floats2
    exact: Floats2
    face_starts: Integers
    face_vertices: Integers
    normals: Floats2
    blunt: Floats
    width: Floats
    bent: Flags
    corner_normals: Floats2
    vertex_starts: Integers
    owned_vertices: Integers
    edge_starts: Integers
    owned_edges: Integers2
    owns: Bits16
    centres: Floats2
    boxes: Singles2
    cones: Singles2
    children: Shorts2
    roots: Integers
    probe_starts: Integers
    probes: Integers
    turns: Shorts
    cap_starts: Integers
    caps: Floats2
    radii: Floats


class Box(NamedTuple):
    """All points centre + r x + s y + t z, |r|, |s|, |t| at most the half sizes; x, y, z almost orthonormal."""

    x: Vec3
    y: Vec3
    z: Vec3
    centre: Vec3
    half: Vec3


@inline(force=True)
def _point_at(numbers, first, k):
    return Vec3(
        number_at(numbers, first, k),
        number_at(numbers, first + 1, k),
        number_at(numbers, first + 2, k),
    )


@inline(force=True)
def box_at(boxes, centres, node):
    """The box of a node."""
    group, k = node // WIDTH, node % WIDTH
    first = 12 * group
    return Box(
        _point_at(boxes, first, k),
        _point_at(boxes, first + 3, k),
        _point_at(boxes, first + 6, k),
        _point_at(centres, 3 * group, k),
        _point_at(boxes, first + 9, k),
    )


@inline(force=True)
def box_of(surface, node):
    """The box of a node of the tree."""
    return box_at(surface.boxes, surface.centres, node)


@inline(force=True)
def _points_at(numbers, first):
    return Vec3(
        lanes_at(numbers, first), lanes_at(numbers, first + 1), lanes_at(numbers, first + 2)
    )


@inline(force=True)
def group_at(boxes, centres, group):
    """The boxes of the nodes of a group, in lanes."""
    first = 12 * group
    return Box(
        _points_at(boxes, first),
        _points_at(boxes, first + 3),
        _points_at(boxes, first + 6),
        _points_at(centres, 3 * group),
        _points_at(boxes, first + 9),
    )


@inline(force=True)
def group_of(surface, group):
    """The boxes of a group of the tree, in lanes."""
    return group_at(surface.boxes, surface.centres, group)


@inline(force=True)
def is_leaf(surface, node):
    """True if the node is of one face, which is `children[node, 0]`."""
    return np.int64(surface.children[node, 1]) == 0


@inline(force=True)
def corner_of(box, i):
    """Corner `i` (0 to 7) of a box."""
    x = along(box.centre, box.half.x if i & 1 else -box.half.x, box.x)
    x = along(x, box.half.y if i & 2 else -box.half.y, box.y)
    return along(x, box.half.z if i & 4 else -box.half.z, box.z)
