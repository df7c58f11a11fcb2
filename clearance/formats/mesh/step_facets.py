"""How far facets stand off the surfaces of a CAD file that they were made from, as far as these are known.

The tessellator says of each triangle which face it is of, and of planes, cylinders, cones, spheres and tori what
they are. Not for: making facets (`step_file`); free-form faces, of which only the number is known.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from clearance.errors import BadSyntax
from clearance.formats.mesh.gltf_buffers import Buffers
from clearance.formats.mesh.gltf_mesh import mesh_pieces
from clearance.formats.mesh.gltf_object import GltfObject

_EXTENSION = "TM_brep_faces"

_STEPS = 4
"""A triangle is looked at in 15 points: its corners, and where each side is cut into four."""


class Facets(NamedTuple):
    """What is known of the facets of a file.

    Attributes:
        n_faces: faces that have a triangle. n_free: those of them that are of no known kind.
        off: [m] the farthest that a point of a triangle was found from its face.
        reach: [m] the largest coordinate.
    """

    n_faces: int
    n_free: int
    off: float
    reach: float


def facets_of(document: GltfObject, buffers: Buffers) -> Facets:
    """What is known of the facets in a GLB document with faces.

    Raises:
        BadSyntax: a face without a triangle, or triangles of no face.
    """
    found = [Facets(0, 0, 0.0, 0.0)]
    for i in range(len(document.items("meshes"))):
        mesh = document.item("meshes", i)
        pieces = mesh_pieces(mesh, None, buffers)
        for k, piece in enumerate(pieces):
            found.append(
                _of_piece(mesh.item("primitives", k), piece.vertices, piece.corners, buffers)
            )
    n_faces, n_free, off, reach = zip(*found, strict=True)
    return Facets(sum(n_faces), sum(n_free), max(off), max(reach))


def _of_piece(
    primitive: GltfObject, vertices: np.ndarray, corners: np.ndarray, buffers: Buffers
) -> Facets:
    known = primitive.object("extensions").object(_EXTENSION)
    faces = known.items("faces")
    of_face = buffers.read(known.index("faceIndices"), 1)[:, 0].astype(np.int64)
    if len(of_face) != len(corners) or (of_face >= len(faces)).any():
        raise BadSyntax("triangles of no face", valid="a face for each triangle")
    order = np.argsort(of_face, kind="stable")
    ends = np.searchsorted(of_face[order], np.arange(len(faces) + 1))
    n_free, off = 0, 0.0
    for i, face in enumerate(faces):
        own = order[ends[i] : ends[i + 1]]
        if not len(own):
            raise BadSyntax(f"face {i} of {len(faces)} has no facets", valid="a face that is sound")
        kind = face.get("type") if isinstance(face, dict) else None
        if kind not in _DISTANCES:
            n_free += 1
            continue
        points = _lattice(vertices[corners[own]])
        off = max(off, float(np.abs(_DISTANCES[kind](GltfObject(face, f"face {i}"), points)).max()))
    return Facets(len(faces), n_free, off, float(np.abs(vertices).max()))


def _lattice(triangles: np.ndarray) -> np.ndarray:
    """(n, 3) points of (m, 3, 3) triangles."""
    shares = [
        (i / _STEPS, k / _STEPS, (_STEPS - i - k) / _STEPS)
        for i in range(_STEPS + 1)
        for k in range(_STEPS + 1 - i)
    ]
    return np.einsum("pc,mcx->mpx", np.array(shares), triangles).reshape(-1, 3)


def _from_plane(face: GltfObject, points: np.ndarray) -> np.ndarray:
    return (points - face.numbers("origin", (), 3)) @ _unit(face, "normal")


def _from_cylinder(face: GltfObject, points: np.ndarray) -> np.ndarray:
    across, _ = _about(face, "origin", points)
    return across - _length(face, "radius")


def _from_cone(face: GltfObject, points: np.ndarray) -> np.ndarray:
    across, along = _about(face, "apex", points)
    angle = abs(_length(face, "semi_angle"))
    return across * np.cos(angle) - np.abs(along) * np.sin(angle)


def _from_sphere(face: GltfObject, points: np.ndarray) -> np.ndarray:
    return np.linalg.norm(points - face.numbers("center", (), 3), axis=1) - _length(face, "radius")


def _from_torus(face: GltfObject, points: np.ndarray) -> np.ndarray:
    across, along = _about(face, "center", points)
    return np.hypot(across - _length(face, "major_radius"), along) - _length(face, "minor_radius")


_DISTANCES: dict[str, Callable[[GltfObject, np.ndarray], np.ndarray]] = {
    "plane": _from_plane,
    "cylinder": _from_cylinder,
    "cone": _from_cone,
    "sphere": _from_sphere,
    "torus": _from_torus,
}
"""[m] the distances of points from a face's surface, inside or outside, by its kind."""


def _about(face: GltfObject, centre: str, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Distances of points from the axis, and along it."""
    axis = _unit(face, "axis")
    seen = points - face.numbers(centre, (), 3)
    along = seen @ axis
    return np.linalg.norm(seen - along[:, None] * axis, axis=1), along


def _unit(face: GltfObject, key: str) -> np.ndarray:
    vector = face.numbers(key, (), 3)
    return vector / np.linalg.norm(vector)


def _length(face: GltfObject, key: str) -> float:
    return float(GltfObject({key: [face.value.get(key)]}, face.place).numbers(key, (), 1)[0])
