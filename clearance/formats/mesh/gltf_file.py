"""glTF 2.0 in one binary file (.glb) to triangles, z up: the container, its document, the scene's nodes and
meshes.

Own code, because the usual readers drop in silence what they do not know: a Draco mesh becomes a point, meshopt
and instances vanish, quantized positions come out 65,535 times too large. Here what is placed is read as the
specification says, or refused. Not for: accessors (`gltf_buffers`). Source: Khronos, glTF 2.0, chapters 3.5
(scenes and nodes), 3.7 (primitives, morph targets), 4.4 (binary container); 3.4 says y up.
"""

from __future__ import annotations

import json
from collections.abc import Hashable, Iterator
from typing import Any

import numpy as np

from clearance.errors import BadSyntax, EmptyMesh, NotFinite, at
from clearance.formats.mesh.gltf_buffers import Buffers, GltfObject
from clearance.formats.mesh.placing import Z_FROM_Y_UP, joined, placed
from clearance.formats.mesh.polygon_cut import fan, strip
from clearance.formats.mesh.triangles import (
    MeshRequest,
    Triangles,
    on_lines,
    refuse_missing_corners,
    rounded_by,
)
from clearance.geometry.pose import pose_from_quaternion

_HARMLESS = (
    "KHR_materials_",
    "KHR_texture_",
    "EXT_texture_",
    "MSFT_texture_",
    "KHR_lights_",
    "KHR_xmp",
)
"""Required extensions that have no bearing on shape, by the beginning of their names."""

_READ = ("KHR_mesh_quantization",)

_DEEPEST = 100


def read_glb(asked: MeshRequest) -> Triangles:
    """All triangles that the file's scene places, in metres; turned from y up to z up for `up_axis` "file".

    Raises:
        BadSyntax: not GLB, cut off, or something in it that is not read. EmptyMesh, BadPolygon, NotFinite.
    """
    document, binary = chunks(asked.data)
    _refuse_extensions(document)
    with np.errstate(all="ignore"):  # what overflows is refused when the whole is checked
        scene = _Scene(document, binary)
        surface = joined(scene.pieces())
        vertices, note = surface.vertices, "not turned from y up to z up, as in RViz and MoveIt"
        if asked.up_axis == "file":
            vertices, note = vertices @ Z_FROM_Y_UP.T, "turned from y up to z up, as glTF says"
    notes = (note, *on_lines(scene.n_lines))
    if len(document.items("scenes")) > 1:
        number, n = document.index("scene", 0) + 1, len(document.items("scenes"))
        notes += (f"scene {number} of its {n} is read",)
    if document.items("animations"):
        notes += ("its animations are not read: nodes stand as they are placed",)
    return Triangles(vertices, surface.corners, notes, rounded=surface.rounded)


def chunks(data: bytes) -> tuple[GltfObject, bytes]:
    """The document and the binary chunk, which may be empty."""
    words = np.frombuffer(data[: len(data) // 4 * 4], "<u4")
    if data[:4] != b"glTF" or len(words) < 5 or words[1] != 2:
        raise BadSyntax("not a GLB file that can be read", valid="glTF binary, version 2")
    if words[2] != len(data):
        raise BadSyntax(f"the GLB file has {len(data)} bytes, and its header says {words[2]}")
    chunks, place = [], 12
    while place + 8 <= len(data):
        length, kind = int(words[place // 4]), data[place + 4 : place + 8]
        if place + 8 + length > len(data):
            raise BadSyntax(f"a chunk of {length} bytes does not fit in the GLB file")
        if length % 4:
            raise BadSyntax(
                f"a chunk of {length} bytes is not padded to a multiple of 4",
                valid="another exporter: glTF 2.0, 4.4.3 asks for the padding",
            )
        chunks.append((kind, data[place + 8 : place + 8 + length]))
        place += 8 + length
    if place != len(data) or chunks[0][0] != b"JSON":
        raise BadSyntax("the first chunk of the GLB file is not JSON")
    binary = chunks[1][1] if len(chunks) > 1 and chunks[1][0] == b"BIN\0" else b""
    return GltfObject(_json(chunks[0][1]), "glTF"), binary


def _json(text: bytes) -> Any:
    try:
        return json.loads(text.decode("utf-8"))
    except (ValueError, RecursionError) as error:
        raise BadSyntax(f"the GLB file's JSON cannot be read: {error!s:.80}") from None


def _refuse_extensions(document: GltfObject) -> None:
    version = document.object("asset").value.get("version")
    if not isinstance(version, str) or not version.startswith("2."):
        raise BadSyntax(f"glTF version {version!r:.20}", valid="2.0")
    for name in document.items("extensionsRequired"):
        if name not in _READ and not str(name).startswith(_HARMLESS):
            raise BadSyntax(
                f"the file requires the extension {name!r:.60}, which is not read",
                valid="export without compression and extensions",
            )


class _Scene:
    """Walks the nodes of the document's scene; each mesh is made once for its weights."""

    def __init__(self, document: GltfObject, binary: bytes) -> None:
        self.document = document
        self.buffers = Buffers(document, binary)
        self.n_lines = 0
        self._visited: set[int] = set()
        self._made: dict[Hashable, list[Triangles]] = {}

    def pieces(self) -> Iterator[tuple[Hashable, Triangles]]:
        """Each placed piece, in the scene's order, with what it is a copy of."""
        if not self.document.items("scenes"):
            raise EmptyMesh("the file has no scene", valid="a scene that places a mesh")
        scene = self.document.item("scenes", self.document.index("scene", 0))
        for i_node in scene.indices("nodes"):
            yield from self._below(i_node, np.eye(4), 0)

    def _below(self, i_node: int, world_from_parent: np.ndarray, depth: int) -> Iterator:
        node = self.document.item("nodes", i_node)
        if i_node in self._visited or depth > _DEEPEST:
            raise BadSyntax(f"node {i_node} is placed twice", valid="a tree at most 100 deep")
        self._visited.add(i_node)
        with at(f"node {i_node}"):
            node.refuse_extension("EXT_mesh_gpu_instancing")
            if "skin" in node.value:
                raise BadSyntax(
                    "skinned geometry is not supported", valid="a mesh without its skeleton"
                )
            world_from_node = world_from_parent @ _matrix(node)
            yield from self._mesh(node, world_from_node)
        for child in node.indices("children"):
            yield from self._below(child, world_from_node, depth + 1)

    def _mesh(self, node: GltfObject, world_from_node: np.ndarray) -> Iterator:
        if "mesh" not in node.value:
            return
        i_mesh = node.index("mesh")
        weights = node.numbers("weights") if "weights" in node.value else None
        key = (i_mesh, None if weights is None else tuple(weights))
        if key not in self._made:
            with at(f"mesh {i_mesh}"):
                mesh = self.document.item("meshes", i_mesh)
                self._made[key] = mesh_pieces(mesh, weights, self.buffers)
                self.n_lines += len(mesh.items("primitives")) - len(self._made[key])
        for i, piece in enumerate(self._made[key]):
            yield (key, i), placed(piece, world_from_node)


def _matrix(node: GltfObject) -> np.ndarray:
    """(4, 4) a node's own transform."""
    if "matrix" not in node.value:
        return _moved_turned_scaled(node)
    matrix = node.numbers("matrix", length=16).reshape(4, 4).T
    if matrix[3].tolist() != [0, 0, 0, 1]:
        raise BadSyntax(f"the last row of its matrix is {matrix[3].tolist()}", valid="0 0 0 1")
    return matrix


def _moved_turned_scaled(node: GltfObject) -> np.ndarray:
    turn = node.numbers("rotation", (0.0, 0.0, 0.0, 1.0), 4)
    length = np.linalg.norm(turn)
    if not abs(length - 1.0) < 0.01:
        raise NotFinite(f"its rotation has the length {length:g}", valid="a unit quaternion")
    place = node.numbers("translation", (0.0, 0.0, 0.0), 3)
    matrix = pose_from_quaternion(place.tolist(), (turn / length).tolist())
    matrix[:3, :3] *= node.numbers("scale", (1.0, 1.0, 1.0), 3)
    return matrix


_POINTS_AND_LINES = (0, 1, 2, 3)
_TRIANGLES, _STRIP, _FAN = 4, 5, 6


def mesh_pieces(mesh: GltfObject, weights: np.ndarray | None, buffers: Buffers) -> list[Triangles]:
    """The triangles of each primitive of a mesh; points and lines have none.

    Args:
        weights: of the morph targets; None for the mesh's own.
    """
    used = mesh.numbers("weights") if weights is None else weights
    pieces = []
    for i in range(len(mesh.items("primitives"))):
        with at(f"primitive {i}"):
            primitive = mesh.item("primitives", i)
            if primitive.index("mode", _TRIANGLES) not in _POINTS_AND_LINES:
                pieces.append(_piece(primitive, used, buffers))
    return pieces


def _piece(primitive: GltfObject, weights: np.ndarray, buffers: Buffers) -> Triangles:
    primitive.refuse_extension("KHR_draco_mesh_compression")
    stored = buffers.read(primitive.object("attributes").index("POSITION"), 3)
    vertices = _morphed(stored.astype(np.float64), primitive, weights, buffers)
    if "indices" in primitive.value:
        indices = buffers.read(primitive.index("indices"), 1)[:, 0]
        if indices.dtype.kind != "u":
            raise BadSyntax("indices are signed or fractions", valid="unsigned whole numbers")
        corners = indices.astype(np.int64)
    else:
        corners = np.arange(len(vertices))
    refuse_missing_corners(corners, len(vertices))
    by_mode = _by_mode(primitive.index("mode", _TRIANGLES), corners)
    return Triangles(vertices, by_mode, rounded=rounded_by(stored))


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
