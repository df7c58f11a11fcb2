"""A common point of two polytopes by the paper: GJK, then a step in one of 26 directions."""

from __future__ import annotations

import itertools

import numpy as np

from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope.gjk import COMMON, VertexGraph, gjk
from clearance.query.common_point import ROUNDING, CommonPoint, SeparationCertificate


def common_point_paper(a: Polytope, b: Polytope, warm: tuple = (0, 0)) -> CommonPoint:
    """A common point of two by GJK, moved inside by a step in one of 26 directions where it must be.

    The barycentric system gives the point on the simplex of either body. If it is not strictly inside both,
    steps of 1e-3 of the smaller size, halved up to 40 times, are tried in all 26 directions; where none
    leads inside, the relation is "touch". `warm` are the two vertices to begin with.

    Source: Tereshchenko (2013), sections 2.1-2.2.
    """
    limit = ROUNDING * max(a.size, b.size)
    graphs = (VertexGraph(body.vertices, *body.vertex_graph) for body in (a, b))
    status, n, k, ia, ib, shares, nearest = gjk(*graphs, *warm, limit)
    after = (int(ia[0]), int(ib[0]))
    gap = float(np.linalg.norm(nearest))
    if status != COMMON and gap > limit:
        return CommonPoint("apart", None, -gap, SeparationCertificate(
            np.zeros(0, int), np.zeros(0, int), np.zeros(0), -nearest / gap), n, 1, after)  # fmt: skip
    point = shares[:k] @ a.vertices[ia[:k]]
    inside = _stepped_inside(a, b, point)
    relation = "touch" if inside is None else "overlap"
    return CommonPoint(relation, point if inside is None else inside, 0.0, None, n, 1, after)


def _stepped_inside(a: Polytope, b: Polytope, point: np.ndarray) -> np.ndarray | None:
    """The point, or the first of the paper's 26 neighbours at shrinking steps, strictly inside both."""
    if _strictly_inside(a, point) and _strictly_inside(b, point):
        return point
    directions = np.array([d for d in itertools.product((-1.0, 0.0, 1.0), repeat=3) if any(d)])
    step = 1e-3 * min(a.size, b.size)
    for halving in range(40):
        for trial in point + step * 0.5**halving * directions:
            if _strictly_inside(a, trial) and _strictly_inside(b, trial):
                return trial
    return None


def _strictly_inside(body: Polytope, point: np.ndarray) -> bool:
    return bool(body.offsets_about(point).min() > ROUNDING / 4 * body.size)
