"""Exact distances and predicates by rational arithmetic: the slow, obvious truth that the package
is tested against.

It shares no code with the package. Floats are taken as the exact rationals that they are, posed
points are R v + t without rounding, and all answers are exact: squared distances are `Fraction`s.
Nothing here has a tolerance, so that scale, distance from the origin and degeneracy cannot matter.

    from tests import oracle

    oracle.segment_distance_sq(p0, p1, q0, q1)          four points
    oracle.point_polygon_distance_sq(point, polygon)    (3,) and (n, 3)
    oracle.polygon_distance_sq(p, q)                    (n, 3) and (m, 3)
    oracle.polygons_touch(p, q)                         True if they share a point
    oracle.polyhedron_distance_sq(                      of the two surfaces
        verts_a, faces_a, verts_b, faces_b, pose_a, pose_b)
    oracle.nearest_faces(...the same...)                that, and the pairs of faces so near
    oracle.solid_distance_sq(...the same...)            0 also where one holds the other
    oracle.contains(point, verts, faces, pose)          boundary included; closed surfaces
    oracle.winding_number(point, verts, faces, pose)    for a point off the surface
    oracle.root(sq, digits=50)                          square root, rounded down
    oracle.error(distance, sq)                          |distance - root(sq)|, to 50 digits

A pair of triangles takes about 0.2 ms, of 64-gons 70 ms, of spheres of 1280 triangles 0.4 s.

Coordinates may be floats, ints or Fractions. Faces are sequences of vertex indices; poses are
(4, 4) world_from_body with any 3 x 3 block, None for identity.

**What a polygon is here.** The union of its fan triangles (v0, v1, v2), (v0, v2, v3), ..., each
the convex hull of its three corners. For planar convex polygons, and for polygons whose corners
are all on one line or in one point, that is the convex hull of the vertices, whatever is repeated
or collinear. For a polygon that rounding has bent out of its plane it is one surface through its
edges, within the warp of any other.
"""

from tests.oracle.polygons import point_polygon_distance_sq, polygon_distance_sq, polygons_touch
from tests.oracle.polyhedra import (
    contains,
    nearest_faces,
    polyhedron_distance_sq,
    solid_distance_sq,
    winding_number,
)
from tests.oracle.rationals import error, root
from tests.oracle.simplices import segment_distance_sq

__all__ = [
    "contains",
    "error",
    "nearest_faces",
    "point_polygon_distance_sq",
    "polygon_distance_sq",
    "polygons_touch",
    "polyhedron_distance_sq",
    "root",
    "segment_distance_sq",
    "solid_distance_sq",
    "winding_number",
]
