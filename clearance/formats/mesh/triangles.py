"""What is asked of a reader of mesh files, and triangles as a file has them, before they become a solid: checked,
scaled, mirrored.

No point is moved except by the scale. Not for: file formats; equal points, flat triangles and
coplanar neighbours (`geometry.coplanar`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Literal, NamedTuple

import numpy as np

from clearance.errors import BadDimension, BadPolygon, EmptyMesh, NotFinite
from clearance.formats.text.notes import counted
from clearance.geometry.edges import distinct_vertices
from clearance.tolerance import TESSELLATION

_ODD = np.array([0x9E3779B97F4A7C15, 0xC2B2AE3D27D4EB4F, 0x165667B19E3779F9], dtype=np.uint64)
"""Factors of a hash: odd, with bits all over."""


UpAxis = Literal["file", "ros"]
"""Which way is up in COLLADA and GLB: "file" turns as `<up_axis>` and glTF say, "ros" leaves files as they lie, as
RViz and MoveIt do."""


class MeshRequest(NamedTuple):
    """The content of a file, and how it is to be read.

    Attributes:
        up_axis: of COLLADA and GLB. tolerance: [m] how far the facets of a CAD file may be off its surface.
    """

    data: bytes
    up_axis: UpAxis = "file"
    tolerance: float = TESSELLATION


class Triangles(NamedTuple):
    """A triangulated surface.

    Attributes:
        vertices: (n, 3) [m] in the file's frame.
        corners: (m, 3) vertex indices, counter-clockwise from outside.
        notes: what reading had to mend or decide, one line each.
        off: [m] how far the triangles may be off the surface that they stand for, either way.
        rounded: [m] how far rounding to single precision may have moved a vertex.
    """

    vertices: np.ndarray
    corners: np.ndarray
    notes: tuple[str, ...] = ()
    off: float = 0.0
    rounded: float = 0.0


COUNTED = 1e-5
"""[m] Rounding of a file's numbers takes nothing off a clearance up to here: it is less 128 m from the origin."""


def as_points(columns: Sequence[np.ndarray]) -> np.ndarray:
    """(n, 3) columns of numbers as points, of single precision where all of them are, else of double."""
    points = np.stack(columns, axis=1)
    is_single = points.dtype.kind == "f" and points.dtype.itemsize == 4
    return points.astype(np.float32 if is_single else np.float64)


def rounded_by(points: np.ndarray) -> float:
    """How far rounding may have moved points (n, 3) of single precision, in their unit; 0 for all others.

    Values that are not finite do not count.
    """
    if points.dtype != np.float32:
        return 0.0
    largest = np.abs(points).max(axis=0, initial=0.0, where=np.isfinite(points))
    return float(np.linalg.norm(0.5 * np.spacing(largest).astype(np.float64)))


def on_rounding(rounded: float, taken: str) -> Iterator[str]:
    """The note on rounding that counts."""
    if rounded > COUNTED:
        yield (
            f"single precision so far from the origin: up to {rounded * 1e3:.3g} mm off, which {taken}"
        )


def on_lines(n: int) -> Iterator[str]:
    """The note on elements of points and lines."""
    if n:
        yield f"{counted(n, 'element')} of points or lines, which have no surface: not measured"


def checked(triangles: Triangles) -> Triangles:
    """The triangles as float64 and int64, once they can be a surface; points that no face uses are
    left out.

    Raises:
        EmptyMesh: no triangle. BadPolygon: a corner that does not exist. NotFinite: NaN or
        infinity.
    """
    given = np.asarray(triangles.vertices).reshape(-1, 3)
    vertices = given.astype(np.float64)
    corners = np.asarray(triangles.corners, dtype=np.int64).reshape(-1, 3)
    if not len(corners):
        raise EmptyMesh("the mesh has no faces", valid="at least one triangle is needed")
    refuse_missing_corners(corners, len(vertices))
    broken = ~np.isfinite(vertices[corners]).all(axis=(1, 2))
    if broken.any():
        i_bad = int(np.flatnonzero(broken)[0])
        raise NotFinite(f"face {i_bad} has a coordinate that is not a finite number")
    used, new_index = np.unique(corners, return_inverse=True)
    rounded = max(triangles.rounded, rounded_by(given[used]))
    corners = new_index.reshape(-1, 3)
    return triangles._replace(vertices=vertices[used], corners=corners, rounded=rounded)


def refuse_missing_corners(corners: np.ndarray, n_vertices: int) -> None:
    """Refuses corners, of any shape, that are not among the vertices.

    Raises:
        BadPolygon: with the first of them.
    """
    outside = (corners < 0) | (corners >= n_vertices)
    if outside.any():
        raise BadPolygon(
            f"a face refers to vertex {int(corners[outside][0])}", valid=f"0 to {n_vertices - 1}"
        )


def scaled(triangles: Triangles, scale: float | Sequence[float]) -> Triangles:
    """The triangles with each axis multiplied; an odd number of mirrored axes turns the corners
    round.

    Raises:
        BadDimension: as `scaled_points`.
    """
    vertices, factors = scaled_points(triangles.vertices, scale)
    mirrored = np.count_nonzero(factors < 0) % 2 == 1
    corners = triangles.corners[:, :: -1 if mirrored else 1]
    most = float(np.abs(factors).max())
    return triangles._replace(
        vertices=vertices,
        corners=corners,
        off=triangles.off * most,
        rounded=triangles.rounded * most,
    )


def scaled_points(
    points: np.ndarray, scale: float | Sequence[float]
) -> tuple[np.ndarray, np.ndarray]:
    """(n, 3) points with each axis multiplied, and the (3,) factors.

    Raises:
        BadDimension: not one or three factors, one that is zero or not finite, or so large that
            coordinates overflow.
    """
    factors = np.asarray(scale, dtype=np.float64)
    if factors.shape not in ((), (3,)) or not np.isfinite(factors).all() or not factors.all():
        raise BadDimension(
            f"scale {factors.tolist()} is given", valid="one or three factors, none zero"
        )
    with np.errstate(over="ignore"):
        made = points * factors
    if not np.isfinite(made).all():
        raise BadDimension(f"scale {factors.tolist()} makes coordinates overflow")
    return made, np.broadcast_to(factors, 3)


def without_copies(triangles: Triangles) -> Triangles:
    """The triangles without those that come again, same corners, same way round.

    A triangle that is there once for each side is no copy. Equal corners are equal bit for bit.
    """
    if not _may_hold_copies(triangles):
        return triangles
    _, kinds = distinct_vertices(triangles.vertices)
    corners = kinds[triangles.corners]
    least = np.argmin(corners, axis=1)[:, None]
    a, b, c = np.take_along_axis(corners, (least + np.arange(3)) % 3, axis=1).T
    order = np.lexsort((c, b, a))
    rows = np.stack([a, b, c], axis=1)[order]
    again = np.zeros(len(rows), dtype=bool)
    again[order[1:]] = (rows[1:] == rows[:-1]).all(
        axis=1
    )  # lexsort is stable: the first of its kind stays
    return triangles._replace(corners=triangles.corners[~again])


def _may_hold_copies(triangles: Triangles) -> bool:
    """False if no two triangles have the same corners, in any order; decided by a hash, to save time."""
    bits = np.ascontiguousarray(triangles.vertices + 0.0).view(np.uint64)
    mixed = (bits * _ODD).sum(axis=1, dtype=np.uint64)
    mixed = (mixed ^ (mixed >> np.uint64(29))) * _ODD[0]
    found = np.sort(mixed[triangles.corners].sum(axis=1, dtype=np.uint64))
    return bool((found[1:] == found[:-1]).any())


def n_without_area(triangles: Triangles) -> int:
    """How many triangles have all corners on one line.

    Exactness: never misses one whose coordinates are single precision, as in STL files; else it
    may.
    """
    a, b, c = (triangles.vertices[triangles.corners[:, i]] for i in range(3))
    with np.errstate(over="ignore", invalid="ignore"):
        return int(np.count_nonzero((np.cross(b - a, c - a) == 0).all(axis=1)))
