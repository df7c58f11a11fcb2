"""GLB: what the scene places is read as the specification says, or refused with its reason."""

import base64
import json
import struct

import numpy as np
import pytest

from clearance.errors import BadInput, BadSyntax
from clearance.formats.mesh import placing
from clearance.formats.mesh.mesh_file import mesh_from_bytes, triangles_from_bytes
from tests.formats.making import CUBE, CUBE_TRIANGLES, signed_volume
from tests.formats.making_glb import changed, cube_document, document_of, glb
from tests.formats.refusal import refusal

DOCUMENT, BINARY = cube_document()
PRIMITIVE = ("meshes", 0, "primitives", 0)


def load(document=DOCUMENT, binary=BINARY):
    return mesh_from_bytes(glb(document, binary), "m.glb")


def z_up(points) -> list:
    """The rows of a y-up file as they are read, sorted."""
    x, y, z = np.asarray(points, dtype=float).T
    return sorted(map(list, np.stack([x, -z, y], axis=1).tolist()))


def rows_of(triangles) -> list:
    return sorted(map(list, (triangles.vertices + 0.0).tolist()))


def test_a_chunk_without_padding_is_refused_for_that():
    text = json.dumps({"asset": {"version": "2.0"}}).encode()
    assert len(text) % 4
    chunk = struct.pack("<I4s", len(text), b"JSON") + text
    data = struct.pack("<4sII", b"glTF", 2, 12 + len(chunk)) + chunk
    with pytest.raises(BadSyntax, match=f"a chunk of {len(text)} bytes is not padded"):
        mesh_from_bytes(data, "m.glb")


def test_the_scene_that_is_read_is_told():
    scenes = [{"nodes": []}, {"nodes": [0]}]
    assert load(DOCUMENT | {"scenes": scenes, "scene": 1}).notes[1:] == (
        "scene 2 of its 2 is read",
    )


def test_an_animation_is_told_and_not_read():
    mesh = load(DOCUMENT | {"animations": [{"channels": [], "samplers": []}]})
    assert mesh.notes[1:] == ("its animations are not read: nodes stand as they are placed",)


@pytest.mark.parametrize(
    ("kind", "normalized", "divisor"),
    [
        ("<u2", True, 65535),
        ("<u1", True, 255),
        ("<i2", True, 32767),
        ("<i1", True, 127),
        ("<u2", False, 1),
    ],
)
def test_quantized_positions_are_decoded(kind, normalized, divisor):
    most = np.iinfo(kind).max
    corners = np.array([[0, 0, 0], [most, 0, 0], [0, most, 0], [0, 0, most // 2]]).astype(kind)
    padded = np.zeros((4, 4), kind)  # rows of four components: KHR_mesh_quantization aligns them
    padded[:, :3] = corners
    faces = np.array([0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3], dtype="<u1")
    document, binary = document_of(padded[:, :3].copy(), faces, primitive={"indices": 1})
    document["accessors"][0]["normalized"] = normalized
    document["extensionsUsed"] = document["extensionsRequired"] = ["KHR_mesh_quantization"]
    triangles = triangles_from_bytes(glb(document, binary), "m.glb")
    assert rows_of(triangles) == z_up(corners.astype(float) / divisor)


def test_interleaved_positions_are_read_with_their_stride():
    table = np.zeros((8, 6), dtype="<f4")
    table[:, 2:5] = CUBE
    table[:, [0, 1, 5]] = 9
    document, _ = cube_document()
    indices = CUBE_TRIANGLES.ravel().astype("<u2").tobytes()
    document["bufferViews"] = [
        {"buffer": 0, "byteOffset": 0, "byteLength": table.nbytes, "byteStride": 24},
        {"buffer": 0, "byteOffset": table.nbytes, "byteLength": len(indices)},
    ]
    document["accessors"][0]["byteOffset"] = 8
    document["buffers"][0]["byteLength"] = table.nbytes + len(indices)
    assert signed_volume(load(document, table.tobytes() + indices).shape) == 1


@pytest.mark.parametrize("has_base", [True, False])
def test_sparse_accessors_are_put_in(has_base):
    base = np.zeros((5, 3), dtype="<f4")
    rows, values = np.array([2, 3, 4], dtype="<u1"), np.diag([1, 2, 3]).astype("<f4")
    faces = np.array([1, 3, 2, 1, 2, 4, 1, 4, 3, 2, 3, 4], dtype="<u1")
    document, binary = document_of(base, faces, rows, values, primitive={"indices": 1})
    document["accessors"][0]["sparse"] = {
        "count": 3,
        "indices": {"bufferView": 2, "componentType": 5121},
        "values": {"bufferView": 3},
    }
    if not has_base:
        del document["accessors"][0]["bufferView"]
    assert signed_volume(load(document, binary).shape) == pytest.approx(1)


def test_strips_and_fans_are_triangles():
    corners = np.array([[0, 0, 0], [0, 2, 0], [1, 0, 0], [0, 0, 3]], dtype="<f4")
    strip = np.array([0, 1, 2, 3, 0, 1], dtype="<u2")  # 012 132 230 301
    document, binary = document_of(corners, strip, primitive={"indices": 1, "mode": 5})
    mesh = load(document, binary)
    assert mesh.n_triangles == 4
    assert mesh.shape.closed and mesh.shape.oriented
    assert signed_volume(mesh.shape) == pytest.approx(1)
    fan = np.array([0, 2, 3, 1], dtype="<u2")
    document, binary = document_of(corners, fan, primitive={"indices": 1, "mode": 6})
    triangles = triangles_from_bytes(glb(document, binary), "m.glb")
    assert triangles.corners.tolist() == [[0, 2, 3], [0, 3, 1]]


@pytest.mark.parametrize("place", ["node", "mesh"])
def test_morph_weights_move_the_points(place):
    corners = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype="<f4")
    moves = np.array([[0, 0, 0], [2, 0, 0], [0, 4, 0]], dtype="<f4")
    document, binary = document_of(corners, moves, primitive={"targets": [{"POSITION": 1}]})
    owner = document["nodes"][0] if place == "node" else document["meshes"][0]
    owner["weights"] = [0.5]
    triangles = triangles_from_bytes(glb(document, binary), "m.glb")
    assert rows_of(triangles) == z_up([[0, 0, 0], [2, 0, 0], [0, 3, 0]])


def test_node_transforms_are_applied_and_mirrors_keep_faces_outward():
    child = {"mesh": 0, "rotation": [0, 0, np.sqrt(0.5), np.sqrt(0.5)], "scale": [2, 3, -4]}
    matrix = np.eye(4)
    matrix[:3, 3] = [10, 20, 30]
    document = changed(
        DOCUMENT, "nodes", [{"children": [1], "matrix": matrix.T.ravel().tolist()}, child]
    )
    mesh = load(document)
    assert mesh.shape.bounds == pytest.approx(np.array([[8.5, -32, 19], [11.5, -28, 21]]))
    assert signed_volume(mesh.shape) == pytest.approx(24)


def test_points_and_lines_are_no_surface_and_data_may_be_embedded():
    document = changed(
        DOCUMENT, "meshes", 0, "primitives", [*DOCUMENT["meshes"][0]["primitives"]] * 1
    )
    document["meshes"][0]["primitives"].append({"attributes": {"POSITION": 0}, "mode": 1})
    uri = "data:application/octet-stream;base64," + base64.b64encode(BINARY).decode()
    document["buffers"][0]["uri"] = uri
    mesh = load(document, b"")
    left_out = "1 element of points or lines, which have no surface: not measured"
    assert mesh.n_triangles == 12 and mesh.notes[1:] == (left_out,)


REQUIRED = "extensionsRequired"
DRACO = {"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}}
MESHOPT = {"EXT_meshopt_compression": {"buffer": 1, "byteLength": 9, "mode": "ATTRIBUTES"}}
INSTANCES = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": 0}}}


@pytest.mark.parametrize(
    ("document", "says"),
    [
        (changed(DOCUMENT, REQUIRED, ["KHR_draco_mesh_compression"]), "requires the extension"),
        (changed(DOCUMENT, *PRIMITIVE, "extensions", DRACO), "KHR_draco_mesh_compression, which is not read"),
        (changed(DOCUMENT, "bufferViews", 0, "extensions", MESHOPT), "EXT_meshopt_compression"),
        (changed(DOCUMENT, "nodes", 0, "extensions", INSTANCES), "EXT_mesh_gpu_instancing"),
        (changed(DOCUMENT, "nodes", 0, "skin", 0), "skinned geometry"),
        (changed(DOCUMENT, "asset", "version", "1.0"), "glTF version '1.0'"),
        (changed(DOCUMENT, "scenes", []), "no scene"),
        (changed(DOCUMENT, "nodes", [{"mesh": 0, "children": [0]}]), "node 0 is placed twice"),
        (changed(DOCUMENT, "nodes", 0, "matrix", [*np.eye(4).ravel()[:15], 2.0]), "last row"),
        (changed(DOCUMENT, "nodes", 0, "rotation", [0, 0, 0, 0]), "a unit quaternion"),
        (changed(DOCUMENT, "nodes", 0, "scale", [1, 2]), "scale of nodes[0] is [1, 2]; 3 numbers"),
        (changed(DOCUMENT, "accessors", 0, "count", 9), "reaches beyond"),
        (changed(DOCUMENT, "accessors", 0, "componentType", 5130), "componentType 5130"),
        (changed(DOCUMENT, "accessors", 1, "componentType", 5122), "unsigned whole numbers"),
        (changed(DOCUMENT, "buffers", 0, "byteLength", 10**9), "168 are there"),
        (changed(DOCUMENT, "buffers", 0, "uri", "cube.bin"), "not in the file"),
        (changed(DOCUMENT, *PRIMITIVE, "mode", 7), "mode 7"),
    ],
)  # fmt: skip
def test_what_would_be_another_surface_is_refused(document, says):
    said = refusal(load, document, of=BadInput)
    assert says in said
    assert said.startswith("m.glb: ")


def test_an_accessor_without_data_is_refused():
    document = changed(DOCUMENT, "accessors", 0, "min", [0, 0, 0])
    del document["accessors"][0]["bufferView"]
    assert "has no data" in refusal(load, document, of=BadInput)


def test_meshes_placed_very_often_are_counted(monkeypatch):
    monkeypatch.setattr(placing, "MOST_COPIED_TRIANGLES", 1_000)
    nodes = [{"mesh": 0} for _ in range(100)]
    document = changed(DOCUMENT, "nodes", nodes)
    document["scenes"][0]["nodes"] = list(range(len(nodes)))
    assert "more than 1,000 copies of triangles" in refusal(load, document, of=BadSyntax)


def test_json_that_is_nested_without_end_is_refused():
    with pytest.raises(BadSyntax, match="JSON cannot be read"):
        text = b"[" * 100_000
        whole = json.dumps(DOCUMENT).encode()
        data = glb(DOCUMENT, BINARY).replace(whole, whole[:-1] + b',"x":' + text)
        size = len(data).to_bytes(4, "little")
        length = (int.from_bytes(data[12:16], "little") + 5 + len(text) - 1).to_bytes(4, "little")
        mesh_from_bytes(data[:8] + size + length + data[16:], "m.glb")
