"""How close two solids or two polygons come: the entry points for single questions."""

from __future__ import annotations

import numpy as np

from clearance.errors import BadInput, BadShape, Contradiction, NotFinite, at
from clearance.geometry.faces import check_convex
from clearance.geometry.point_cloud import require_surface
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.pose import validated_pose
from clearance.kernels.mesh.convex import seem_convex
from clearance.kernels.search.polygon_pair import PolygonPairAnswers, nearest_polygons
from clearance.query.one_pair import cached_pair
from clearance.query.result import Nearest

METHODS = ("exact", "paper")


def distance(
    a: Polyhedron,
    b: Polyhedron,
    *,
    pose_a: np.ndarray | None = None,
    pose_b: np.ndarray | None = None,
    method: str = "exact",
    tolerance: float | None = None,
) -> Nearest:
    """The global minimum distance of two polyhedra and where it is attained.

    Args:
        pose_a, pose_b: (4, 4) `world_from_body` [m]; the identity if not given.
        method: "exact", or "paper" for the first paper's algorithm as published.
        tolerance: [m] of the paper's rule 1: polygons whose bounding spheres are at least as far apart are left
            out, so that what is farther is not measured. None, as the paper leaves it open, leaves out none.

    Raises:
        BadPose: not a rigid motion. BadShape: no `Polyhedron`. BadInput: unknown method, or a tolerance with the
            exact one. BadDimension: a tolerance that is not above 0.

    Exactness: searched in float64, the candidates that can win measured in 106 bits, contact decided by
        exact predicates, for the float vertices and poses as given; `error_bound` is proven. Overlap, and a body
        wholly inside a closed one, is contact.
    Ties: the least face indices.
    """
    if _checked(method, tolerance) == "paper":
        from clearance.query.paper import NO_TOLERANCE, distance_paper

        require_surface(a, "a"), require_surface(b, "b")
        poses = [np.eye(4) if pose is None else validated_pose(pose) for pose in (pose_a, pose_b)]
        return distance_paper(
            a, b, *poses, tolerance=NO_TOLERANCE if tolerance is None else tolerance
        )
    return cached_pair(a, b).nearest(pose_a, pose_b)


def polygon_distance(p: np.ndarray, q: np.ndarray, *, method: str = "exact") -> Nearest:
    """The distance of two convex planar polygons and where it is attained.

    Args:
        p, q: (n, 3), (m, 3) corners in order [m], n, m >= 3; repeated ones, and all on a line, are allowed.

    Raises:
        BadShape, NotFinite: not as above. BadPolygon: clearly not convex.
    """
    p, q = _convex(_polygons(p, 2), "p"), _convex(_polygons(q, 2), "q")
    if _checked(method) == "paper":
        from clearance.query.paper import polygon_distance_paper

        return polygon_distance_paper(p, q)
    found = _measured(p[None], q[None])
    return Nearest(
        distance=float(found.distance[0]),
        point_a=found.points[0, 0],
        point_b=found.points[0, 1],
        face_a=0,
        face_b=0,
        contact=bool(found.contact[0]),
        error_bound=float(found.error[0]),
        tally={"polygons": 1, "exact_decisions": int(found.exact[0])},
    )


def polygon_distances(ps: np.ndarray, qs: np.ndarray, *, method: str = "exact") -> np.ndarray:
    """(k,) distances [m] of the polygon pairs `ps[i]`, `qs[i]`; shapes (k, n, 3) and (k, m, 3).

    Raises:
        BadShape, NotFinite, BadPolygon: as `polygon_distance`.
    """
    ps, qs = _polygons(ps, 3), _polygons(qs, 3)
    if len(ps) != len(qs):
        raise BadShape(f"{len(ps)} polygons against {len(qs)}", valid="as many of each")
    ps, qs = _convex(ps, "ps"), _convex(qs, "qs")
    if _checked(method) == "paper":
        from clearance.query.paper import polygon_distance_paper

        pairs = zip(ps, qs, strict=True)
        return np.array([polygon_distance_paper(p, q).distance for p, q in pairs])
    return _measured(ps, qs).distance


def _measured(ps: np.ndarray, qs: np.ndarray) -> PolygonPairAnswers:
    k = len(ps)
    flags = np.empty(k, dtype=np.bool_), np.empty(k, dtype=np.bool_)
    answers = PolygonPairAnswers(np.empty(k), np.empty(k), np.empty((k, 2, 3)), *flags)
    nearest_polygons(ps, qs, answers)
    return answers


def _polygons(points: np.ndarray, n_dimensions: int) -> np.ndarray:
    array = np.array(points, dtype=np.float64, order="C")
    if array.ndim != n_dimensions or array.shape[-1] != 3 or array.shape[-2] < 3:
        wanted = "(n, 3)" if n_dimensions == 2 else "(k, n, 3)"
        raise BadShape(f"polygon corners have shape {array.shape}", valid=f"{wanted} with n >= 3")
    if not np.isfinite(array).all():
        raise NotFinite("a polygon corner is NaN or infinite", valid="finite coordinates")
    return array


def _convex(polygons: np.ndarray, where: str) -> np.ndarray:
    """The polygons (…, n, 3), which are convex within `tolerance.FLATNESS`."""
    n = polygons.shape[-2]
    if n == 3 or seem_convex(polygons.reshape(-1, n, 3)):
        return polygons
    corners = polygons.reshape(-1, 3)
    with at(where):
        check_convex(corners, np.arange(0, len(corners) + 1, n), np.arange(len(corners)))
    return polygons


def _checked(method: str, tolerance: float | None = None) -> str:
    if method not in METHODS:
        raise BadInput(f"unknown method {method!r}", valid=f"one of {', '.join(METHODS)}")
    if tolerance is not None and method != "paper":
        raise Contradiction(
            f"method {method!r} has no tolerance", valid="only method 'paper' has one"
        )
    return method
