"""Which nodes can hold the nearest points of two bodies, by the normals of their faces: normal cones.

Let p and q be nearest, at a distance above 0, and d the direction from p to q. Let the faces round the vertex or
edge that p is on be planar and convex, and meet two by two, in opposite directions, along each edge there. Then d
or -d is in the convex cone of their normals:

- In a face, d is its normal or the opposite.
- On an edge, d is at a right angle or more to both faces. Such directions are the arc between the two normals on
  the side where the faces bend away, or the arc of the opposites.
- At a vertex, d is at a right angle or more to all faces there, so it is a sum of outward normals m of the convex
  hull of these faces. A facet of that hull holds edges or faces of the surface, for which m is as above. If all
  normals are less than a right angle from some axis, m is on the side of the normals or of their opposites, not
  both, and facets that meet do so along an edge or face of the surface, which says the same of both.

The same is true of -d at q. A face's cone holds the normals round each vertex and edge that it answers for
(`Surface`), and that of a node each of these cones or its opposite. So two nodes without a common point hold no
nearest points if their cones, taken both ways, have no direction in common, or if one of them has none in common
with the directions from the one box to the other. It does not matter which side is inside, whether the surface is
closed, or whether it cuts itself elsewhere.

While a body moves, its normals turn by no more than the motion does. Two nodes that are turned away in all of an
interval hold the nearest points at no instant of it before the bodies meet. If the others keep some distance, so
do the bodies. Their distance is above 0 at first, equals that of the others while above 0, and cannot leap.

Source: Johnson & Cohen, Spatialized normal cone hierarchies, 2001 (local minimum distances).
"""

from typing import NamedTuple

from clearance.compile.decorators import inline
from clearance.kernels.arithmetic.lanes import (
    WIDTH,
    lanes_at,
    larger,
    marks_within,
    number_at,
    square_root,
    where_positive,
)
from clearance.kernels.arithmetic.vec3 import Vec3, dot, turn

MARGIN = 2.0**-8
"""[rad] more than the turn of normals, cones and directions by rounding, and by poses off orthonormal."""

WIDEST = 1.2
"""[rad] Greatest half angle of a cone, less than a right angle; a wider one is no cone."""

NO_CONE = 1e6
"""Stands for the sine of a node without a cone: no angle is too wide for it."""

FARTHEST = 1e300
"""[m] The reach of boxes that may overlap: they may lie in any direction from one another."""

CONE_ROWS = 6
"""Rows of a group in `Surface.cones`."""

NOTHING = 1e-300
"""The least number that is more than none."""


class NormalCones(NamedTuple):
    """The cones of a group p, in lanes, and of a node q of the other body, in the frame of p.

    Attributes:
        u, v: the axes of p and q. cos_u, sin_u, cos_v, sin_v: of the angles to either side.
        reach: [m] of both boxes from their centres.
    """

    u: Vec3
    cos_u: float  # in lanes
    sin_u: float  # in lanes
    v: Vec3
    cos_v: float
    sin_v: float
    reach: float  # in lanes


@inline(force=True)
def normal_cones_of(cones_p, group, cones_q, other, m, slack):
    """The normal cones of a group and of a node of the other body.

    Args:
        cones_p, cones_q: `Surface.cones` of the group's body and the other. m: from the frame of q to that of p.
        slack: [m] rounding of coordinates.
    """
    first, across, k = CONE_ROWS * group, CONE_ROWS * (other // WIDTH), other % WIDTH
    u = Vec3(lanes_at(cones_p, first), lanes_at(cones_p, first + 1), lanes_at(cones_p, first + 2))
    cos_u, sin_u = lanes_at(cones_p, first + 3), lanes_at(cones_p, first + 4)
    v = Vec3(
        number_at(cones_q, across, k),
        number_at(cones_q, across + 1, k),
        number_at(cones_q, across + 2, k),
    )
    v = turn(m, v)
    cos_v, sin_v = number_at(cones_q, across + 3, k), number_at(cones_q, across + 4, k)
    reach = lanes_at(cones_p, first + 5) + (number_at(cones_q, across + 5, k) + slack)
    return NormalCones(u, cos_u, sin_u, v, cos_v, sin_v, reach)


@inline(force=True)
def while_moving(cones, cos_turn, sin_turn, movement):
    """The cones that are valid at every instant of a motion.

    Args:
        cos_turn, sin_turn: of the greatest turn of the bodies, less than a right angle with `WIDEST`.
        movement: [m] the greatest motion of any point.
    """
    u, cos_u, sin_u, v, cos_v, sin_v, reach = cones
    return NormalCones(
        u, cos_u * cos_turn - sin_u * sin_turn, sin_u * cos_turn + cos_u * sin_turn,
        v, cos_v * cos_turn - sin_v * sin_turn, sin_v * cos_turn + cos_v * sin_turn,
        reach + movement,
    )  # fmt: skip


@inline(force=True)
def marks_turned_away(cones, d):
    """Bits of the nodes of a group that hold no nearest points with a node they have no point in common with.

    Args:
        d: [m] from the centres of the group's boxes, in lanes, to that of the other node, in the frame of p.
    """
    u, cos_u, sin_u, v, cos_v, sin_v, reach = cones
    onward_sq = dot(d, d) - reach * reach
    onward = square_root(larger(onward_sq, 0.0))
    reach = where_positive(onward_sq, reach, FARTHEST)
    beyond = larger(
        cos_u * cos_v - sin_u * sin_v - abs(dot(u, v)),
        larger(
            cos_u * onward - sin_u * reach - abs(dot(u, d)),
            cos_v * onward - sin_v * reach - abs(dot(v, d)),
        ),
    )
    return marks_within(0.0 - beyond, -NOTHING)
