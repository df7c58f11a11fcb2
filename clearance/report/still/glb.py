"""A GLB file of the worst moment, for slides and CAD: a node for each body under its name, and the line.

glTF holds positions as float32 (off by 6e-8 of a length: 0.06 µm in 1 m), and is y up: the root node turns z up to
y up, and all below it is as in the world of the case. The witness points stand in the line's `extras` as they were
measured. Not for: reading GLB (`formats.mesh.gltf_file`).

Source: Khronos, glTF 2.0, 3.4 to 3.9 and 4.4.
"""

from __future__ import annotations

import json
import math
import struct
from collections.abc import Collection
from typing import Any

import numpy as np

from clearance import __version__
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import cylinder, sphere
from clearance.record.record import Record
from clearance.record.replay import Replay
from clearance.report.still.scene import Still, StillBody, still_of

FLOAT, UNSIGNED = 5126, 5125
VERTICES, INDICES = 34962, 34963

Z_UP_TO_Y_UP = [-math.sqrt(0.5), 0.0, 0.0, math.sqrt(0.5)]
"""quat_xyzw: a quarter turn about x."""

LINE_SHARE, DOT_SHARE = 1 / 1200, 1 / 500
"""Radii of the line and its dots, of the room's diagonal."""


def glb_of(record: Record, replay: Replay) -> bytes:
    """The file; the same record gives the same bytes."""
    still, worst = still_of(replay), record.worst
    taken = {body.name for body in still.bodies}
    document = _Document(free_name(record.case.name, taken))
    bodies = [document.add_body(still, body) for body in still.bodies]
    line = document.add_line(still, taken) | {
        "extras": {
            "clearance": worst.clearance,
            "time": worst.time,
            "bodies": [worst.link, worst.obstacle],
            "points": still.line.tolist(),
            "frame": "world of the case, z up",
            "rule": worst.rule,
            "status": record.status_of(worst),
        }
    }
    return document.content([*bodies, line])


class _Document:
    """A glTF document that grows; what is there once is written once."""

    def __init__(self, name: str) -> None:
        self._name = name
        self._bytes = bytearray()
        self._views: list[dict[str, Any]] = []
        self._accessors: list[dict[str, Any]] = []
        self._materials: list[dict[str, Any]] = []
        self._meshes: list[dict[str, Any]] = []
        self._known: dict[tuple[object, ...], int] = {}

    def add_body(self, still: Still, body: StillBody) -> dict[str, Any]:
        """The node of a body."""
        colour = (*body.colour.tolist(), body.opacity)
        mesh = self._mesh(*still.shapes[body.i_shape], ("shape", body.i_shape), colour)
        return {"name": body.name, "mesh": mesh, **_placed(body.pose)}

    def add_line(self, still: Still, taken: Collection[str]) -> dict[str, Any]:
        """The node of the line and its dots, solid so that every program shows them."""
        colour = (*still.colour.tolist(), 1.0)
        length = float(np.linalg.norm(still.line[1] - still.line[0]))
        dot = sphere(still.size * DOT_SHARE, 0.05 * still.size * DOT_SHARE)
        name = free_name("witness line", taken)
        parts = [
            _node(f"{name}: {side}", self._mesh_of(dot, "dot", colour), _moved(end))
            for side, end in zip(("first point", "second point"), still.line, strict=True)
        ]
        if length > 0.0:
            tube = cylinder(still.size * LINE_SHARE, length, sections=12)
            parts.append(
                _node(f"{name}: segment", self._mesh_of(tube, "tube", colour), _along(still.line))
            )
        return {"name": name, "parts": parts}

    def content(self, nodes: list[dict[str, Any]]) -> bytes:
        """The file with these nodes below one that turns it up."""
        listed: list[dict[str, Any]] = [{"name": self._name, "rotation": Z_UP_TO_Y_UP}]
        listed[0]["children"] = [_add(listed, node) for node in nodes]
        document = {
            "asset": {"version": "2.0", "generator": f"clearance {__version__}"},
            "scene": 0,
            "scenes": [{"name": self._name, "nodes": [0]}],
            "nodes": listed,
            "meshes": self._meshes,
            "materials": self._materials,
            "accessors": self._accessors,
            "bufferViews": self._views,
            "buffers": [{"byteLength": len(self._bytes)}],
        }
        text = json.dumps(document, ensure_ascii=False, sort_keys=True, allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        chunks = struct.pack("<I4s", len(text), b"JSON") + text
        chunks += struct.pack("<I4s", len(self._bytes), b"BIN\0") + bytes(self._bytes)
        return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks

    def _mesh_of(self, shape: Polyhedron, key: str, colour: tuple[float, ...]) -> int:
        return self._mesh(shape.vertices, shape.triangles(), (key,), colour)

    def _mesh(
        self,
        vertices: np.ndarray,
        triangles: np.ndarray,
        key: tuple[object, ...],
        colour: tuple[float, ...],
    ) -> int:
        if ("mesh", key, colour) not in self._known:
            primitive = {
                "attributes": {"POSITION": self._positions(vertices, key)},
                "indices": self._indices(triangles, key),
                "material": self._material(colour),
            }
            self._known["mesh", key, colour] = len(self._meshes)
            self._meshes.append({"primitives": [primitive]})
        return self._known["mesh", key, colour]

    def _positions(self, vertices: np.ndarray, key: tuple[object, ...]) -> int:
        values = vertices.astype("<f4")
        ends = {"min": values.min(axis=0).tolist(), "max": values.max(axis=0).tolist()}
        return self._accessor(
            ("positions", key), values, FLOAT, "VEC3", VERTICES, len(values), ends
        )

    def _indices(self, triangles: np.ndarray, key: tuple[object, ...]) -> int:
        values = triangles.astype("<u4")
        return self._accessor(
            ("indices", key), values, UNSIGNED, "SCALAR", INDICES, values.size, {}
        )

    def _accessor(
        self, key: tuple[object, ...], values: np.ndarray, kind: int, shape: str, target: int, count: int,
        ends: dict[str, list[float]],
    ) -> int:  # fmt: skip
        if key not in self._known:
            view = {
                "buffer": 0,
                "byteOffset": len(self._bytes),
                "byteLength": values.nbytes,
                "target": target,
            }
            self._views.append(view)
            self._bytes += values.tobytes()
            self._known[key] = len(self._accessors)
            accessor = {
                "bufferView": len(self._views) - 1,
                "componentType": kind,
                "count": count,
                "type": shape,
            }
            self._accessors.append(accessor | ends)
        return self._known[key]

    def _material(self, colour: tuple[float, ...]) -> int:
        if ("material", colour) not in self._known:
            look: dict[str, Any] = {
                "pbrMetallicRoughness": {
                    "baseColorFactor": [*map(_linear, colour[:3]), colour[3]],
                    "metallicFactor": 0.0,
                    "roughnessFactor": 0.8,
                },
                "doubleSided": True,
            }
            self._known["material", colour] = len(self._materials)
            self._materials.append(look if colour[3] == 1.0 else look | {"alphaMode": "BLEND"})
        return self._known["material", colour]


def free_name(wanted: str, taken: Collection[str]) -> str:
    """The name, with as many lines behind it as it takes to be no body's."""
    while wanted in taken:
        wanted += "_"
    return wanted


def _add(listed: list[dict[str, Any]], node: dict[str, Any]) -> int:
    """Adds a node, and its parts below it; its place."""
    parts = node.pop("parts", [])
    listed.append(node)
    place = len(listed) - 1
    if parts:
        node["children"] = [_add(listed, part) for part in parts]
    return place


def _node(name: str, mesh: int, pose: np.ndarray) -> dict[str, Any]:
    return {"name": name, "mesh": mesh, **_placed(pose)}


def _placed(pose: np.ndarray) -> dict[str, list[float]]:
    from scipy.spatial.transform import Rotation

    rotation = Rotation.from_matrix(pose[:3, :3]).as_quat(canonical=True)
    return {"translation": pose[:3, 3].tolist(), "rotation": rotation.tolist()}


def _moved(point: np.ndarray) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = point
    return pose


def _along(line: np.ndarray) -> np.ndarray:
    """The pose of a cylinder about z whose axis is the line."""
    way = (line[1] - line[0]) / np.linalg.norm(line[1] - line[0])
    side = np.cross(way, np.eye(3)[np.argmin(np.abs(way))])
    side /= np.linalg.norm(side)
    pose = _moved(line.mean(axis=0))
    pose[:3, :3] = np.column_stack([side, np.cross(way, side), way])
    return pose


def _linear(value: float) -> float:
    """A component of sRGB without its gamma, as glTF has colours."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
