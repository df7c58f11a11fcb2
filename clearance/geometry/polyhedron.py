"""A solid as flat convex polygons: the one type in which all geometry is measured.

Faces are stored flat (`face_starts`, `face_vertices`), counter-clockwise as seen from outside where the
surface is consistently oriented. A `Polyhedron` that exists is valid: finite, with at least one face, and
every index in range. Not for: reading files (room `load`) and making shapes (`shapes`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadPolygon, BadShape, EmptyMesh, NotFinite


@dataclass(frozen=True, eq=False, init=False)
class Polyhedron:
    """A surface of flat convex polygons in its own body frame.

    Args:
        vertices: (n, 3) [m].
        faces: for each face the indices of its three or more vertices in order, as any sequence of
            sequences or as an (m, k) array.
        excess: [m] how far the surface may stand outside the shape it stands for (0: it is the shape).

    Raises:
        EmptyMesh: no faces. NotFinite: NaN or infinity. BadShape, BadPolygon: not as above.
    """

    vertices: np.ndarray
    face_starts: np.ndarray
    face_vertices: np.ndarray
    excess: float

    def __init__(
        self,
        vertices: np.ndarray,
        faces: Sequence[Sequence[int]] | np.ndarray,
        excess: float = 0.0,
    ) -> None:
        starts, flat = _flat_faces(faces)
        points = np.array(vertices, dtype=np.float64, order="C")
        _validate(points, starts, flat)
        for name, value in (("vertices", points), ("face_starts", starts), ("face_vertices", flat)):
            value.setflags(write=False)
            object.__setattr__(self, name, value)
        object.__setattr__(self, "excess", float(excess))

    @property
    def n_faces(self) -> int:
        """Number of polygons."""
        return len(self.face_starts) - 1

    @property
    def n_triangles(self) -> int:
        """Number of triangles that the polygons would be cut into."""
        return len(self.face_vertices) - 2 * self.n_faces

    def face(self, i_face: int) -> np.ndarray:
        """The (k, 3) corners [m] of one face, in order."""
        return self.vertices[self.face_vertices[self.face_starts[i_face] : self.face_starts[i_face + 1]]]

    @cached_property
    def bounds(self) -> np.ndarray:
        """(2, 3) [m] the least and greatest coordinates in the body frame."""
        return np.array([self.vertices.min(axis=0), self.vertices.max(axis=0)])


def _flat_faces(faces: Sequence[Sequence[int]] | np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    rows = [np.asarray(face, dtype=np.int64) for face in faces]
    if not rows:
        raise EmptyMesh("the mesh has no faces", valid="at least one polygon is needed")
    starts = np.zeros(len(rows) + 1, dtype=np.int64)
    np.cumsum([len(row) for row in rows], out=starts[1:])
    return starts, np.concatenate(rows)


def _validate(vertices: np.ndarray, starts: np.ndarray, flat: np.ndarray) -> None:
    if vertices.ndim != 2 or vertices.shape[1] != 3:
        raise BadShape(f"vertices have shape {vertices.shape}", valid="(n, 3) is needed")
    if not np.isfinite(vertices).all():
        i_bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise NotFinite(f"vertex {i_bad} is {vertices[i_bad].tolist()}", valid="finite coordinates")
    sizes = np.diff(starts)
    if sizes.min() < 3:
        i_bad = int(np.argmin(sizes))
        raise BadPolygon(f"face {i_bad} has {sizes[i_bad]} vertices", valid="three or more")
    if flat.min() < 0 or flat.max() >= len(vertices):
        raise BadPolygon(
            f"a face refers to vertex {int(flat.max() if flat.max() >= len(vertices) else flat.min())}",
            valid=f"0 to {len(vertices) - 1}",
        )
