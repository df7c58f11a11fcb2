"""Meshes of a glTF document to triangles: primitives of every mode, and morph targets.

Not for: the scene (`gltf_file`), accessors (`gltf_buffers`). Source: Khronos, glTF 2.0, chapter 3.7 (primitives,
morph targets).
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadSyntax, at
from clearance.formats.mesh.gltf_buffers import Buffers
from clearance.formats.mesh.gltf_object import GltfObject
from clearance.formats.mesh.strips import fan, strip
from clearance.formats.mesh.triangles import Triangles, refuse_missing_corners

_POINTS_AND_LINES = (0, 1, 2, 3)
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


def mesh_pieces(mesh: GltfObject, weights: np.ndarray | None, buffers: Buffers) -> list[Triangles]:
    """The triangles of each primitive of a mesh; points and lines have none.

    Args:
        weights: of the morph targets; None for the mesh's own.
    """
    used = mesh.numbers("weights", ()) if weights is None else weights
    pieces = []
    for i in range(len(mesh.items("primitives"))):
        with at(f"primitive {i}"):
            primitive = mesh.item("primitives", i)
            if primitive.index("mode", _TRIANGLES) not in _POINTS_AND_LINES:
                pieces.append(_piece(primitive, used, buffers))
    return pieces


def _piece(primitive: GltfObject, weights: np.ndarray, buffers: Buffers) -> Triangles:
    primitive.refuse_extension("KHR_draco_mesh_compression")
    vertices = buffers.read(primitive.object("attributes").index("POSITION"), 3).astype(np.float64)
    vertices = _morphed(vertices, primitive, weights, buffers)
    if "indices" in primitive.value:
        indices = buffers.read(primitive.index("indices"), 1)[:, 0]
        if indices.dtype.kind != "u":
            raise BadSyntax("indices are signed or fractions", valid="unsigned whole numbers")
        corners = indices.astype(np.int64)
    else:
        corners = np.arange(len(vertices))
    refuse_missing_corners(corners, len(vertices))
    return Triangles(vertices, _by_mode(primitive.index("mode", _TRIANGLES), corners))


def _by_mode(mode: int, corners: np.ndarray) -> np.ndarray:
    if mode == _TRIANGLES:
        if len(corners) % 3:
            raise BadSyntax(f"{len(corners)} corners of triangles", valid="three for each")
        return corners.reshape(-1, 3)
    if mode not in (_STRIP, _FAN):
        raise BadSyntax(f"mode {mode}", valid="0 to 6")
    return strip(corners) if mode == _STRIP else fan(corners)


def _morphed(
    vertices: np.ndarray, primitive: GltfObject, weights: np.ndarray, buffers: Buffers
) -> np.ndarray:
    """The vertices with each morph target's displacements added by its weight."""
    targets = primitive.items("targets")
    if len(weights) not in (0, len(targets)):
        raise BadSyntax(
            f"{len(weights)} weights", valid=f"{len(targets)}, one for each morph target"
        )
    for i in np.flatnonzero(weights):
        target = primitive.item("targets", int(i))
        if "POSITION" in target.value:
            moved = buffers.read(target.index("POSITION"), 3)
            if moved.shape != vertices.shape:
                raise BadSyntax(f"{target.place} has {len(moved)} points", valid=f"{len(vertices)}")
            vertices = vertices + weights[i] * moved
    return vertices
