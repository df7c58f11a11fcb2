"""GLB files written byte by byte, so that readers are tested against no other writer."""

from __future__ import annotations

import copy
import json
import struct

import numpy as np

from tests.formats.making import CUBE, CUBE_TRIANGLES


def glb(document: dict, binary: bytes) -> bytes:
    """A GLB file of a document and its binary chunk."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    binary += b"\0" * (-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def accessors(*arrays: np.ndarray) -> tuple[list[dict], list[dict], bytes]:
    """Accessors and views of arrays (n, 3) or (n,), one after the other in a binary chunk."""
    kinds = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
    made, views, binary = [], [], b""
    for i, array in enumerate(arrays):
        kind = "VEC3" if array.ndim == 2 else "SCALAR"
        code = kinds[array.dtype.str[1:]]
        made.append({"bufferView": i, "componentType": code, "count": len(array), "type": kind})
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": array.nbytes})
        binary += array.tobytes() + b"\0" * (-array.nbytes % 4)
    return made, views, binary


def document_of(*arrays: np.ndarray, primitive: dict | None = None) -> tuple[dict, bytes]:
    """A document with one node and one mesh of one primitive; accessor 0 is its positions."""
    made, views, binary = accessors(*arrays)
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, **(primitive or {})}]}],
        "accessors": made,
        "bufferViews": views,
        "buffers": [{"byteLength": len(binary)}],
    }
    return document, binary


def cube_document(corners: np.ndarray = CUBE) -> tuple[dict, bytes]:
    """The unit cube of `making`, or one that is moved, its axes as in the file."""
    indices = CUBE_TRIANGLES.ravel().astype("<u2")
    return document_of(corners.astype("<f4"), indices, primitive={"indices": 1})


def changed(document: dict, *path_and_value: object) -> dict:
    """A copy of the document with the value at a path of keys."""
    *path, key, value = path_and_value
    made = copy.deepcopy(document)
    place = made
    for step in path:
        place = place[step]
    place[key] = value
    return made
