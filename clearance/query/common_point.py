"""A point strictly inside several polytopes, or a certificate that there is none.

`common_point` finds the deepest point: the x with the greatest t such that x is inside by t times each face's
distance from its own centroid.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.errors import BadShape, EmptyMesh, NotFinite
from clearance.geometry.polytope import Polytope
from clearance.kernels.polytope.depth import (
    COLD,
    FACES,
    N_ROWS,
    SHARES,
    SOLUTION,
    WARM,
    T,
    deepen_all,
)
from clearance.kernels.polytope.gjk import COMMON, VertexGraph, gjk

ROUNDING = 16 * 2.0**-53
"""[-] What counts as touching, relative to the bodies' size: a few roundings of the planes' offsets."""

PLAINLY = 2.0 * ROUNDING
"""[-] Depth beyond which bodies overlap whatever faces the point lies between, relative to all sizes together."""

MARGIN = 1e-13
"""[-] How far beyond a face, in parts of its distance from the centroid, the deepest point may stay."""

MAX_PASSES = 256
"""[-] Rounds over all bodies, each of at most eight faces a pair (sixteen where there are more than two)."""

_STILL = np.eye(4)[None]


@dataclass(frozen=True)
class SeparationCertificate:
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
    """The common point of bodies.

    Args:
        relation: "overlap" (the point is strictly inside all), "touch" or "apart".
        point: (3,) [m], None when apart.
        level: [-] not a length: 1 if the point is a body's centroid, about 0 when touching, below 0 when separate.
        certificate: the faces that forbid an inner point; None on overlap.
        n_faces: faces (for GJK: support points) visited; passes: rounds over all bodies.
        warm: the basis: what a next call on the same bodies, moved, may begin with.
    """

    relation: str
    point: np.ndarray | None
    level: float
    certificate: SeparationCertificate | None
    n_faces: int
    passes: int
    warm: tuple = ()


def checked_bodies(polytopes: Sequence[Polytope]) -> list[Polytope]:
    """The bodies as a list.

    Raises:
        EmptyMesh: none. BadShape: something else than a `Polytope`.
    """
    if not isinstance(polytopes, Iterable):
        raise BadShape(f"a {type(polytopes).__name__} is given", valid="a list of Polytopes")
    bodies = list(polytopes)
    if not bodies:
        raise EmptyMesh("there are no polytopes", valid="one or more")
    for i, body in enumerate(bodies):
        if not isinstance(body, Polytope):
            raise BadShape(f"item {i} is a {type(body).__name__}", valid="a Polytope")
    return bodies


def checked_poses(poses: Sequence[np.ndarray], n_bodies: int) -> np.ndarray:
    """The poses as (n_bodies, 4, 4) float64.

    Raises:
        BadShape: another number or shape. NotFinite: NaN or infinity.
    """
    frames = np.ascontiguousarray(poses, dtype=np.float64)
    if frames.shape != (n_bodies, 4, 4):
        raise BadShape(f"the poses have shape {frames.shape}", valid=f"({n_bodies}, 4, 4)")
    if not np.isfinite(frames).all():
        raise NotFinite("a pose is not finite", valid="finite numbers")
    return frames


def common_point(
    polytopes: Sequence[Polytope], poses: Sequence[np.ndarray] | None = None, warm: tuple = ()
) -> CommonPoint:
    """The deepest point common to all, or the faces that prove there is none.

    Args:
        poses: `world_from_body` (4, 4) of each; all at rest if None. Bodies are not copied: the map to
            follow a trajectory.
        warm: the `warm` of an answer for the same bodies in a near pose. The answer is the same without.

    Raises:
        EmptyMesh: no bodies. BadShape: not polytopes, poses of another shape or number.
        NotFinite: a pose that is not.

    Exactness: "overlap" is never said of bodies whose inner points are fewer than rounding
        (`ROUNDING` times the size) deep; each body's faces are visited through a map that misses none; at
        most `MAX_PASSES` rounds, counted.
    Source: Tereshchenko (2013), section 2.2 needs the point; the linear programme in four unknowns with
        faces on demand is the simplex method (Dantzig 1963) on its dual.
    """
    bodies = checked_bodies(polytopes)
    frames = _STILL if poses is None else checked_poses(poses, len(bodies))
    origin = (
        bodies[0].centroid if poses is None else frames[0][:3] @ np.append(bodies[0].centroid, 1.0)
    )
    known = len(bodies) < 3 and len(warm) == 4 and all(_names_a_face(bodies, name) for name in warm)
    block, names = np.empty((N_ROWS, 4)), np.array(warm if known else (-4, -3, -2, -1))
    begin = WARM if known else COLD
    rows = np.array([body.packed_at for body in bodies])
    settled, n_faces, passes = deepen_all(
        rows, frames, origin, block, names, MARGIN, begin, MAX_PASSES
    )
    if not settled and block[SOLUTION, T] > 0.0:
        _lower_to_what_is_sure(bodies, frames, origin, block[SOLUTION])
    return _judged(bodies, origin, block, names, n_faces, passes)


def _names_a_face(bodies: list[Polytope], name: int) -> bool:
    return name >= 0 and name >> 32 < len(bodies) and name & 0xFFFFFFFF < bodies[name >> 32].n_faces


def _lower_to_what_is_sure(
    bodies: list[Polytope], frames: np.ndarray, origin: np.ndarray, solution: np.ndarray
) -> None:
    """Sets t to the point's least share of all faces, where the simplex method did not end."""
    point = solution[:T] + origin
    for i, body in enumerate(bodies):
        frame = frames[min(i, len(frames) - 1)]
        there = frame[:3, :3].T @ (point - frame[:3, 3])
        solution[T] = min(solution[T], (body.offsets_about(there) / body.face_widths).min())


def _judged(
    bodies: list[Polytope],
    origin: np.ndarray,
    block: np.ndarray,
    face_names: np.ndarray,
    n_faces: int,
    passes: int,
) -> CommonPoint:
    shares, names, level = block[SHARES].tolist(), face_names.tolist(), float(block[SOLUTION, T])
    point, warm = block[SOLUTION, :T] + origin, tuple(names) if min(names) >= 0 else ()
    if level > PLAINLY * sum(shares) * sum([body.size for body in bodies]):
        return CommonPoint("overlap", point, level, None, n_faces, passes, warm)
    most = 1e-9 * max(shares)
    real = [j for j in range(4) if names[j] >= 0 and shares[j] > most]
    limit = ROUNDING * max((bodies[names[j] >> 32].size for j in real), default=0.0) * sum(shares)
    if level > limit:
        return CommonPoint("overlap", point, level, None, n_faces, passes, warm)
    proof = _certificate(len(bodies), block, face_names, real)
    if level >= -limit:
        return CommonPoint("touch", point, level, proof, n_faces, passes, warm)
    return CommonPoint("apart", None, level, proof, n_faces, passes, warm)


def _certificate(
    n_bodies: int, block: np.ndarray, names: np.ndarray, real: list[int]
) -> SeparationCertificate:
    parts, faces = names >> 32, names & 0xFFFFFFFF
    normal = None
    if n_bodies == 2:
        own = [j for j in real if parts[j] == 0]
        total = block[SHARES, own] @ block[FACES][own, :T]
        length = np.linalg.norm(total)
        normal = total / length if length > 0.0 else None
    return SeparationCertificate(parts[real], faces[real], block[SHARES, real], normal)


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
