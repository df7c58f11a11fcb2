"""A cloud of points in the form that kernels search: a face of one corner for each point, and a tree over them.

Such a face owns its corner and has no edge, no normal and no cone, so that the search for surfaces serves clouds
as it is. Not for: bodies with a surface (`tree`).
"""

from __future__ import annotations

import numpy as np

from clearance.geometry.cones import no_cones
from clearance.geometry.point_cloud import PointCloud
from clearance.geometry.tree_nodes import nodes_over
from clearance.kernels.arithmetic.lanes import WIDTH
from clearance.kernels.mesh.surface import Surface
from clearance.ordered import ascending

_OWNS_ITS_CORNER = 1

_ROUNDED_UP = 1.0 + 2.0**-21


def cloud_surface(cloud: PointCloud) -> Surface:
    """The searchable form of a cloud."""
    points, n = cloud.vertices.copy(), cloud.n_points
    starts, each = np.arange(n + 1), np.arange(n)
    nothing = np.zeros((n, 3))
    centres, boxes, children = nodes_over(points, starts, each)
    _, firsts = np.unique(cloud.face_component, return_index=True)
    probes = ascending(np.sort(firsts))  # halved to test whether a point is one
    return Surface(
        vertices=points,
        exact=points,
        face_starts=starts,
        face_vertices=each,
        normals=nothing,
        blunt=np.ones(n),
        width=np.zeros(n),
        bent=np.zeros(n, dtype=np.bool_),
        corner_normals=nothing,
        vertex_starts=starts,
        owned_vertices=each,
        edge_starts=np.zeros(n + 1, dtype=np.int64),
        owned_edges=np.empty((0, 2), dtype=np.int64),
        owns=np.full(n, _OWNS_ITS_CORNER, dtype=np.uint16),
        centres=centres,
        boxes=_with_balls(boxes, cloud.ball_radius),
        cones=no_cones(boxes),
        children=children,
        roots=np.zeros(1, dtype=np.int64),
        probe_starts=np.array([0, len(probes)]),
        probes=probes.astype(np.int64),
        turns=np.zeros(n, dtype=np.int32),
        cap_starts=np.zeros(2, dtype=np.int64),
        caps=np.empty((0, 3)),
        radii=np.array([cloud.ball_radius]),
    )


def _with_balls(boxes: np.ndarray, radius: float) -> np.ndarray:
    """The boxes, with that of the root and its equivalents large enough for the balls."""
    grown = boxes.copy()
    grown[9:12, :WIDTH] += np.float32(radius * _ROUNDED_UP)
    grown[9:12, :WIDTH] *= np.float32(_ROUNDED_UP)
    return grown
