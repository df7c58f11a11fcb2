"""Flat lists of faces: made from what callers give, checked, and split where a face is not flat.

`starts` (m + 1,) says where each face begins in `flat`, the vertex indices of all faces.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain

import numpy as np

from clearance.errors import BadDimension, BadPolygon, BadShape, EmptyMesh, NotFinite
from clearance.geometry.edges import rings_of
from clearance.geometry.planes import Planes, planes_of
from clearance.tolerance import FLATNESS, LARGEST, UNIT_ROUNDOFF


def checked_vertices(given: np.ndarray) -> np.ndarray:
    """The (n, 3) vertices [m] as a C-ordered float64 copy.

    Raises:
        BadShape, NotFinite: not (n, 3) finite numbers. BadDimension: one that no arithmetic can square.
    """
    try:
        vertices = np.array(given, dtype=np.float64, order="C")
    except (TypeError, ValueError):
        raise BadShape(
            "the vertices are not an array of numbers", valid="(n, 3) is needed"
        ) from None
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise BadShape(f"the vertices have shape {vertices.shape}", valid="(n, 3) is needed")
    finite = np.isfinite(vertices).all(axis=1)
    if not finite.all():
        i_bad = int(np.argmin(finite))
        raise NotFinite(f"vertex {i_bad} is {vertices[i_bad].tolist()}", valid="finite coordinates")
    if len(vertices) and np.abs(vertices).max() > LARGEST:
        reach = float(np.abs(vertices).max())
        raise BadDimension(f"a vertex reaches {reach:g} m", valid=f"{LARGEST:g} m or less")
    return vertices


def flat_faces(faces: Sequence[Sequence[int]] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(starts, flat) of faces given as an (m, k) array or as rows of indices.

    Raises:
        EmptyMesh: no faces. BadPolygon: a face without vertices, or with an index that is no whole number.
    """
    if len(faces) == 0:
        raise EmptyMesh("the mesh has no faces", valid="at least one polygon is needed")
    if isinstance(faces, np.ndarray) and faces.ndim == 2:
        m, k = faces.shape
        return np.arange(m + 1) * k, _whole(faces.reshape(-1))
    try:
        sizes = [len(face) for face in faces]
        flat = _whole(np.array(list(chain.from_iterable(faces))))
    except (TypeError, ValueError):
        raise BadPolygon("a face is not a row of vertex indices", valid="whole numbers") from None
    return np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64), flat


def _whole(indices: np.ndarray) -> np.ndarray:
    if indices.size and indices.dtype.kind not in "iu":
        raise BadPolygon(
            f"vertex indices are of type {indices.dtype}", valid="whole numbers are needed"
        )
    return np.array(indices, dtype=np.int64)


def check_indices(
    n_vertices: int, starts: np.ndarray, flat: np.ndarray, *, allow_repeated: bool = False
) -> None:
    """Refuses faces that are no polygons, whatever the vertices are.

    Raises:
        BadPolygon: fewer than three vertices, an index out of range, the same index twice in a row (unless
            `allow_repeated`).
    """
    sizes = np.diff(starts)
    if sizes.min() < 3:
        i_bad = int(np.argmax(sizes < 3))
        raise BadPolygon(f"face {i_bad} has {sizes[i_bad]} vertices", valid="three or more")
    outside = (flat < 0) | (flat >= n_vertices)
    ring = rings_of(starts)
    if outside.any():
        i = int(np.argmax(outside))
        raise BadPolygon(
            f"face {ring.face[i]} refers to vertex {flat[i]}", valid=f"0 to {n_vertices - 1}"
        )
    repeated = flat == flat[ring.ahead]
    if repeated.any() and not allow_repeated:
        i = int(np.argmax(repeated))
        raise BadPolygon(
            f"face {ring.face[i]} has vertex {flat[i]} twice in a row", valid="each once in a row"
        )


def check_flat_and_convex(vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray) -> None:
    """Refuses faces of four or more vertices that are clearly warped or not convex.

    Raises:
        BadPolygon: by more than `tolerance.FLATNESS` of the face's size and the rounding of its coordinates.
    """
    many = np.diff(starts) > 3
    if not many.any():
        return
    which = np.flatnonzero(many)
    sub_starts = np.concatenate([[0], np.cumsum(np.diff(starts)[which])])
    sub_flat = flat[np.repeat(many, np.diff(starts))]
    planes = planes_of(vertices, sub_starts, sub_flat)
    for bad, problem in (
        (_warp(vertices, sub_starts, sub_flat, planes) > 1.0, "is not flat"),
        (_bends_inward(vertices, sub_starts, sub_flat, planes), "is not convex"),
    ):
        if bad.any():
            raise BadPolygon(
                f"face {which[np.argmax(bad)]} {problem}", valid="flat convex polygons; split it"
            )


def check_convex(vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray) -> None:
    """Refuses faces that are clearly not convex, seen along their normal; warped ones are the union of their fans.

    Raises:
        BadPolygon: a corner turns inward by more than `tolerance.FLATNESS`, or the boundary runs round twice or
            crosses itself.
    """
    planes = planes_of(vertices, starts, flat)
    bad = _bends_inward(vertices, starts, flat, planes)
    bad |= ~planes.normals.any(axis=1) & (_warp(vertices, starts, flat, planes) > 1.0)
    if bad.any():
        raise BadPolygon(
            f"polygon {int(np.argmax(bad))} is not convex", valid="convex polygons; split it"
        )


def _allowance(vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray) -> np.ndarray:
    """(m,) [m] how far rounding alone may have moved a face's vertices."""
    largest = np.maximum.reduceat(np.abs(vertices[flat]).max(axis=1), starts[:-1])
    return 16.0 * UNIT_ROUNDOFF * largest


def _warp(vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray, planes: Planes) -> np.ndarray:
    """(m,) how far vertices are off their face's plane (off its line without one), in units of what is allowed."""
    ring = rings_of(starts)
    offsets = vertices[flat] - planes.centres[ring.face]
    heights = np.abs((offsets * planes.normals[ring.face]).sum(axis=1))
    no_plane: np.ndarray = ~np.any(planes.normals, axis=1)[ring.face]
    if no_plane.any():
        heights = np.where(no_plane, _off_line(offsets, starts, ring.face), heights)
    allowed = FLATNESS * planes.radii + _allowance(vertices, starts, flat)
    worst = np.maximum.reduceat(heights, starts[:-1])
    return np.divide(worst, allowed, out=np.zeros(len(worst)), where=worst > 0.0)


def _off_line(offsets: np.ndarray, starts: np.ndarray, face: np.ndarray) -> np.ndarray:
    """(n,) distance of each corner from the line through its face's centre and farthest corner."""
    lengths = np.linalg.norm(offsets, axis=1)
    farthest = np.maximum.reduceat(lengths, starts[:-1])
    is_farthest = np.flatnonzero(lengths == farthest[face])
    first = is_farthest[np.unique(face[is_farthest], return_index=True)[1]]
    lines = offsets[first] / np.where(farthest > 0.0, farthest, 1.0)[:, None]
    return np.linalg.norm(np.cross(offsets, lines[face]), axis=1)


def _bends_inward(
    vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray, planes: Planes
) -> np.ndarray:
    """(m,) True where a corner clearly turns in the wrong sense, or the boundary runs round more than once."""
    ring = rings_of(starts)
    arriving = vertices[flat] - vertices[flat[ring.behind]]
    leaving = vertices[flat[ring.ahead]] - vertices[flat]
    bends = (np.cross(arriving, leaving) * planes.normals[ring.face]).sum(axis=1)
    a, b = np.linalg.norm(arriving, axis=1), np.linalg.norm(leaving, axis=1)
    allowed = FLATNESS * a * b + _allowance(vertices, starts, flat)[ring.face] * (a + b)
    turns = np.arctan2(bends, (arriving * leaving).sum(axis=1))
    around = np.add.reduceat(np.abs(turns), starts[:-1]) > 3.0 * np.pi
    return (np.logical_or.reduceat(bends < -allowed, starts[:-1]) | around) & planes.normals.any(
        axis=1
    )
