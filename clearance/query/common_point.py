"""A point strictly inside several polytopes, or a certificate that there is none.

`common_point` asks for the deepest point: the x with the greatest t such that x keeps t times each face's
distance from its own centroid. `common_point_paper` is GJK with the paper's step in 26 directions, for two.
Not for: the shared region (`intersection`).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadShape, EmptyMesh
from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope_depth import INSIDE, deepen
from clearance.kernels.polytope_gjk import COMMON, gjk

ROUNDING = 16 * 2.0**-53
"""[-] What counts as touching, relative to the bodies' size: a few roundings of the planes' offsets."""

MAX_PASSES = 64


@dataclass(frozen=True)
class Certificate:
    """At most four faces whose half-spaces have no common inner point: sum(weight n) = 0, sum(weight d) <= 0.

    Args:
        parts, faces: (k,) which body and which of its faces. weights: (k,) positive.
        normal: (3,) for two bodies, a unit vector along which the second lies beyond the first; else None.
    """

    parts: np.ndarray
    faces: np.ndarray
    weights: np.ndarray
    normal: np.ndarray | None = None


@dataclass(frozen=True)
class CommonPoint:
    """Where bodies meet.

    Args:
        relation: "overlap" (the point is strictly inside all), "touch" or "apart".
        point: (3,) [m], None when apart.
        depth: [-] the t reached, 1 at a body's centroid; about 0 when touching, below 0 when apart.
        certificate: the faces that forbid an inner point; None on overlap.
        n_faces: faces (for GJK: support points) looked at; passes: rounds over all bodies.
        warm: what a next call on moved bodies may begin with.
    """

    relation: str
    point: np.ndarray | None
    depth: float
    certificate: Certificate | None
    n_faces: int
    passes: int
    warm: tuple = ()


def checked_bodies(polytopes: Sequence[Polytope]) -> list[Polytope]:
    """The bodies as a list.

    Raises:
        EmptyMesh: none. BadShape: something else than a `Polytope`.
    """
    bodies = list(polytopes)
    if not bodies:
        raise EmptyMesh("there are no polytopes", valid="one or more")
    for i, body in enumerate(bodies):
        if not isinstance(body, Polytope):
            raise BadShape(f"item {i} is a {type(body).__name__}", valid="a Polytope")
    return bodies


@dataclass
class _Basis:
    rows: np.ndarray
    bounds: np.ndarray
    names: np.ndarray
    inverse: np.ndarray
    point: np.ndarray
    shares: np.ndarray

    @classmethod
    def around(cls, bodies: list[Polytope]) -> _Basis:
        """A tetrahedron far around the first body; t at its middle is 1."""
        normals = np.array([[1, 1, 1], [1, -1, -1], [-1, 1, -1], [-1, -1, 1]]) / np.sqrt(3.0)
        reach = 16.0 * max(body.size for body in bodies)
        centre = bodies[0].centroid
        rows = np.column_stack([normals, np.full(4, reach)])
        inverse = np.linalg.inv(rows)
        bounds = normals @ centre + reach
        point = np.append(centre, 1.0)
        return cls(rows, bounds, np.arange(-4, 0), inverse, point, inverse[3].copy())


def common_point(polytopes: Sequence[Polytope]) -> CommonPoint:
    """The deepest point common to all, or the faces that prove there is none.

    Raises:
        EmptyMesh: no bodies. BadShape: not polytopes.

    Exactness: "overlap" is never said of bodies whose inner points are fewer than rounding
        (`ROUNDING` times the size) deep; at most 64 passes of 256 faces each, counted.
    Source: Tereshchenko (2013), section 2.2 asks for the point; the linear programme in four unknowns with
        faces on demand is the simplex method (Dantzig 1963) on its dual.
    """
    bodies = checked_bodies(polytopes)
    basis = _Basis.around(bodies)
    faces = [0] * len(bodies)
    n_entered, passes, unsettled = 0, 0, False
    for passes in range(1, MAX_PASSES + 1):
        quiet, unsettled = True, False
        for k, body in enumerate(bodies):
            status, n, faces[k] = deepen(
                body.normals, body.face_widths, *body.face_graph, body.centroid, k, faces[k], 1e-13,
                basis.rows, basis.bounds, basis.names, basis.inverse, basis.point, basis.shares,
            )  # fmt: skip
            n_entered += n
            quiet = quiet and n == 0
            unsettled = unsettled or status != INSIDE
            if basis.point[3] < -1e-6 and basis.names.min() >= 0:
                return _judged(bodies, basis, n_entered, passes)
        if quiet:
            break
    if (unsettled or not quiet) and basis.point[3] > 0.0:
        _keep_what_is_sure(bodies, basis)
    return _judged(bodies, basis, n_entered, passes)


def _keep_what_is_sure(bodies: list[Polytope], basis: _Basis) -> None:
    """Sets t to what the point really keeps of every face, where the simplex method came to no end."""
    kept = [(body.offsets_about(basis.point[:3]) / body.face_widths).min() for body in bodies]
    basis.point[3] = min(basis.point[3], *kept)


def _judged(bodies: list[Polytope], basis: _Basis, n_entered: int, passes: int) -> CommonPoint:
    depth = float(basis.point[3])
    parts, faces = basis.names >> 32, basis.names & 0xFFFFFFFF
    real = (basis.names >= 0) & (basis.shares > 1e-9 * basis.shares.max())
    reach = max(bodies[k].size for k in parts[real]) if real.any() else 0.0
    limit = ROUNDING * reach * float(basis.shares.sum())
    if depth > limit:
        return CommonPoint("overlap", basis.point[:3].copy(), depth, None, n_entered, passes)
    normal = None
    if len(bodies) == 2:
        own = real & (parts == 0)
        total = basis.shares[own] @ basis.rows[own, :3]
        length = np.linalg.norm(total)
        normal = total / length if length > 0.0 else None
    proof = Certificate(parts[real], faces[real], basis.shares[real].copy(), normal)
    point = basis.point[:3].copy() if depth >= -limit else None
    relation = "apart" if point is None else "touch"
    return CommonPoint(relation, point, depth, proof, n_entered, passes)


def common_point_paper(a: Polytope, b: Polytope, warm: tuple = (0, 0)) -> CommonPoint:
    """A common point of two by GJK, moved inside by a step in one of 26 directions where it must be.

    The barycentric system gives the point on the simplex of either body. If it is not strictly inside both,
    steps of 1e-3 of the smaller size, halved up to 40 times, are tried in all 26 directions; where none
    leads inside, the relation is "touch". `warm` are the two vertices to begin with.

    Source: Tereshchenko (2013), sections 2.1-2.2.
    """
    limit = ROUNDING * max(a.size, b.size)
    status, n, k, ia, ib, shares, nearest = gjk(
        a.vertices, *a.vertex_graph, b.vertices, *b.vertex_graph, *warm, limit
    )
    after = (int(ia[0]), int(ib[0]))
    gap = float(np.linalg.norm(nearest))
    if status != COMMON and gap > limit:
        return CommonPoint("apart", None, -gap, Certificate(
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
