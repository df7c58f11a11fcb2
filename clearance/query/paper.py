"""The first paper's distance, as published: `method="paper"`.

A method to be judged, not to be trusted: it answers the distance of two real points of the
two surfaces, hence (to rounding) never below their true distance, and often above it; `PAPER.md`
has the figures. It knows no contact: for overlapping bodies it answers what the iteration ends on,
0 or more, and often infinity, because rule 2 cuts the faces that have passed each other; for a body
inside another likewise. So `error_bound` is infinite, and an infinite distance means "nothing
measured".

Source: Lim, Oh, Kim, Kim & Kim, Development of an efficient algorithm for the minimum distance
calculation between general polyhedra, sections 2 to 4.
"""

from __future__ import annotations

import math
import weakref

import numpy as np

from clearance.errors import BadDimension, BadPolygon
from clearance.geometry.planes import planes_of
from clearance.geometry.polyhedron import Polyhedron
from clearance.kernels.paper.bodies import PaperBody, nearest_bodies_paper
from clearance.kernels.paper.polygons import nearest_polygons_paper
from clearance.query.result import Nearest

NO_TOLERANCE = math.inf
"""[m] Rule 1 then cuts nothing; the paper leaves the value to the user and names none."""

_bodies: weakref.WeakKeyDictionary[Polyhedron, PaperBody] = weakref.WeakKeyDictionary()


def polygon_distance_paper(p: np.ndarray, q: np.ndarray) -> Nearest:
    """The answer of the paper's section 3 for two convex polygons.

    Args:
        p, q: (n, 3), (m, 3) corners in order [m].

    Returns:
        `tally` has `passes` through step 2 and `not_converged` (0 or 1); `error_bound` is
        infinite.

    Raises:
        BadPolygon: all corners on one line; the paper needs polygons with area.
    """
    p, q = (np.asarray(corners, dtype=np.float64) for corners in (p, q))
    origin = p[0]  # differenced first, so that places far from the world's origin cost no digits
    near_p, near_q = np.ascontiguousarray(p - origin), np.ascontiguousarray(q - origin)
    found = nearest_polygons_paper(near_p, *_plane(near_p), near_q, *_plane(near_q))
    distance = math.dist(found.p, found.q)
    return Nearest(
        distance=distance,
        point_a=np.array(found.p) + origin,
        point_b=np.array(found.q) + origin,
        face_a=0,
        face_b=0,
        contact=distance == 0.0,
        error_bound=math.inf,
        tally={"passes": int(found.passes), "not_converged": int(not found.converged)},
    )


def distance_paper(
    a: Polyhedron,
    b: Polyhedron,
    pose_a: np.ndarray | None = None,
    pose_b: np.ndarray | None = None,
    *,
    tolerance: float = NO_TOLERANCE,
    rule_1: bool = True,
    rule_2: bool = True,
) -> Nearest:
    """The answer of the paper's section 4 for two bodies; cheap enough to call for each pair of
    each step.

    Args:
        pose_a, pose_b: (4, 4) `world_from_body`, valid rotations; the identity if not given.
        tolerance: [m] of rule 1: face pairs whose bounding spheres are at least so far from each other are
        cut. rule_1, rule_2: False leaves the rule out.

    Returns:
        `distance` is infinite, the points NaN and the faces -1 where the rules cut every face
        pair; the paper's "positive big number". `tally`: `pairs`, `cut_by_rule_1`,
        `cut_by_rule_2`, `measured`, `passes_1` ... `passes_5_or_more`, `not_converged`.

    Raises:
        BadDimension: the tolerance is not above 0.

    Ties: the least face of a, then of b.
    """
    checked_tolerance(tolerance)
    world_from_a = _pose(pose_a)
    found = nearest_bodies_paper(
        _flat(a), _flat(b), world_from_a, _pose(pose_b), float(tolerance), rule_1, rule_2
    )
    rotation, origin = world_from_a[:3, :3], world_from_a[:3, 3]
    return Nearest(
        distance=math.sqrt(found.gap_sq),
        point_a=rotation @ np.array(found.p) + origin,
        point_b=rotation @ np.array(found.q) + origin,
        face_a=int(found.face_a),
        face_b=int(found.face_b),
        contact=found.gap_sq == 0.0,
        error_bound=math.inf,
        tally=_tally(a.n_faces * b.n_faces, found),
    )


def checked_tolerance(tolerance: float) -> float:
    """The tolerance of rule 1 [m], infinite for none.

    Raises:
        BadDimension: not a length above 0.
    """
    if not isinstance(tolerance, int | float) or not tolerance > 0.0:
        raise BadDimension(
            f"tolerance is {tolerance!r:.60}", where="tolerance", valid="a length above 0 [m]"
        )
    return float(tolerance)


def _tally(n_pairs: int, found) -> dict[str, int]:
    names = ("passes_1", "passes_2", "passes_3", "passes_4", "passes_5_or_more", "not_converged")
    return {
        "pairs": n_pairs,
        "cut_by_rule_1": int(found.cut_by_rule_1),
        "cut_by_rule_2": int(found.cut_by_rule_2),
        "measured": int(found.measured),
        **{name: int(count) for name, count in zip(names, found.passes, strict=True)},
    }


def _flat(body: Polyhedron) -> PaperBody:
    """The body as the kernel wants it, made once."""
    if body not in _bodies:
        _bodies[body] = PaperBody(
            np.ascontiguousarray(body.vertices[body.face_vertices]),
            body.face_starts,
            np.ascontiguousarray(body.normals),
            np.ascontiguousarray(body.centres),
            np.ascontiguousarray(body.radii),
        )
    return _bodies[body]


def _pose(pose: np.ndarray | None) -> np.ndarray:
    return np.eye(4) if pose is None else np.ascontiguousarray(pose, dtype=np.float64)


def _plane(corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(1, 3) unit normal and (1, 3) mean of the corners: the reference point of step 1."""
    n_corners = len(corners)
    planes = planes_of(corners, np.array([0, n_corners]), np.arange(n_corners))
    if not planes.normals.any():
        raise BadPolygon(
            "the polygon has no area",
            valid="method 'paper' needs corners that are not all on one line",
        )
    return planes.normals, planes.centres
