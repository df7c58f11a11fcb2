"""MoveIt's CollisionObject messages, and its shapes there and in `.scene` files, to rows of a YAML scene. Not
for: what they are attached to.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from clearance.errors import BadDimension, BadScene, BadShape, at, nearest_name
from clearance.formats.files.found_files import FoundFiles
from clearance.formats.mesh.octree_file import file_of_message, octree_of
from clearance.formats.mesh.off_file import off_text
from clearance.formats.message.values import (
    Message,
    Poses,
    items,
    message,
    messages,
    number,
    numbers,
    require_fields,
    text,
)
from clearance.formats.scene.request import SceneRequest, mesh_row, pose_row

_FIELDS = (
    "header", "pose", "id", "type", "primitives", "primitive_poses", "meshes", "mesh_poses", "planes",
    "plane_poses", "subframe_names", "subframe_poses", "operation",
)  # fmt: skip
_FIELDS_OF_SHAPE = ("type", "dimensions", "polygon", "resource", "vertices", "triangles")

_ADD = (None, 0, "0", "add", "ADD", "\0", "")


def object_rows(given: Message, frame: np.ndarray, meshes: SceneMeshes, poses: Poses) -> list[Row]:
    """The obstacles of an object: its name for its only shape, name/0, name/1, … for several.

    Args:
        frame: (4, 4) [m] of what its pose is given in.

    Raises:
        BadInput: a shape or an operation that is not read; shapes and poses that are not as many.
    """
    name = text(given, "id")
    with at(repr(name)):
        require_fields(given, *_FIELDS)
        if given.get("operation") not in _ADD:
            raise BadScene(
                f"{given['operation']!r:.40} is given", where="operation", valid="ADD (0)"
            )
        if items(given, "planes"):
            raise BadScene("a plane, which has no end, is not read", where="planes", valid="a box")
        from_object = frame @ poses.read(message(given, "pose"))
        shapes = [*_placed(given, "primitives", "primitive_poses", meshes, poses)]
        shapes += _placed(given, "meshes", "mesh_poses", meshes, poses)
        if not shapes:
            raise BadScene("it has no shape", valid="primitives or meshes")
    return named_rows(name, [(row, from_object @ local) for row, local in shapes])


def named_rows(name: str, shapes: list[tuple[Row, np.ndarray]]) -> list[Row]:
    """The obstacles of an object's shapes at their (4, 4) poses [m]."""
    names = [name] if len(shapes) == 1 else [f"{name}/{i}" for i in range(len(shapes))]
    return [
        {"name": own, **row, "pose": pose_row(place)}
        for own, (row, place) in zip(names, shapes, strict=True)
    ]


def _placed(
    given: Message, key: str, poses_key: str, meshes: SceneMeshes, poses: Poses
) -> Iterator[tuple[Row, np.ndarray]]:
    """The shapes of a list, and where each is in the object; all at its origin where no poses are given."""
    placed = []
    for where, one in messages(given, poses_key):
        with at(where):
            placed.append(poses.read(one))
    n_shapes = len(items(given, key))
    meshes.take(100 * n_shapes)
    if placed and len(placed) != n_shapes:
        raise BadShape(f"{len(placed)} {poses_key} of {n_shapes} {key}", valid="one for each")
    for i, (where, shape) in enumerate(messages(given, key)):
        with at(where):
            require_fields(shape, *_FIELDS_OF_SHAPE)
            row = _primitive(shape) if key == "primitives" else _mesh(shape, meshes)
        yield row, placed[i] if placed else np.eye(4)


def _primitive(given: Message) -> Row:
    kind = given.get("type")
    if isinstance(kind, int) and kind in KINDS:
        kind = KINDS[kind]
    if not isinstance(kind, str):
        raise BadScene(f"{kind!r:.40} is given", where="type", valid="box, sphere or cylinder")
    dimensions = [number(value, "dimensions") for value in items(given, "dimensions")]
    return primitive(kind.lower(), dimensions)


def _mesh(given: Message, meshes: SceneMeshes) -> Row:
    if given.get("resource") is not None:
        scale = given.get("dimensions")
        factors = [1.0] * 3 if scale is None else numbers(scale, "xyz", "dimensions")
        return meshes.named(text(given, "resource"), factors)
    meshes.take(len(items(given, "vertices")) + len(items(given, "triangles")))
    vertices = [numbers(value, "xyz", "vertices") for value in items(given, "vertices")]
    triangles = [_corners(value) for value in items(given, "triangles")]
    return meshes.inline(vertices, triangles)


def _corners(value: object) -> list[int]:
    corners = value.get("vertex_indices") if isinstance(value, dict) else value
    if not isinstance(corners, list) or [type(corner) for corner in corners] != [int] * 3:
        raise BadShape(f"{value!r:.60} is given", where="triangles", valid="3 vertex_indices")
    return corners


Row = dict[str, Any]

KINDS = {1: "box", 2: "sphere", 3: "cylinder", 4: "cone", 5: "prism"}
"""`SolidPrimitive.type`, by number."""

MOST_VALUES = 3_000_000
"""Vertices and triangles written out in one scene; a shape counts as a hundred."""

_N_DIMENSIONS = {"box": 3, "sphere": 1, "cylinder": 2}


def primitive(kind: str, dimensions: Sequence[float]) -> Row:
    """A box of three lengths, a sphere of a radius, or a cylinder of height and radius.

    Raises:
        BadInput: another kind. BadShape, BadDimension: no such dimensions.
    """
    if kind not in _N_DIMENSIONS:
        if kind in ("cone", "prism", "plane"):
            raise BadScene(f"a {kind} is not read", valid="a mesh of the same shape, or a box")
        raise BadScene(f"{kind!r:.40} is no kind of shape", valid=nearest_name(kind, _N_DIMENSIONS))
    needed = _N_DIMENSIONS[kind]
    if len(dimensions) != needed:
        raise BadShape(f"{len(dimensions)} dimensions of a {kind}", valid=f"{needed} are needed")
    if not all(length > 0.0 for length in dimensions):
        raise BadDimension(f"dimensions {list(dimensions)} of a {kind}", valid="above 0 m")
    if kind == "box":
        return {"box": {"size": list(dimensions)}}
    if kind == "sphere":
        return {"sphere": {"radius": dimensions[0]}}
    return {"cylinder": {"radius": dimensions[1], "length": dimensions[0]}}


class SceneMeshes:
    """The meshes of one scene: those written out in it, and those that it names.

    Args:
        asked: the scene.
    """

    def __init__(self, asked: SceneRequest) -> None:
        self._asked = asked
        self._n_inline = 0
        self._n_left = MOST_VALUES
        self.found = FoundFiles(asked.files, asked.package_dirs)

    def take(self, n: int) -> None:
        """Counts what is read: a file may name one part of itself again and again.

        Raises:
            BadInput: it is too much.
        """
        self._n_left -= n
        if self._n_left < 0:
            most = f"{MOST_VALUES} vertices and triangles, or {MOST_VALUES // 100} shapes"
            raise BadScene(f"more than {most}", valid="fewer")

    def inline(self, vertices: list[list[float]], triangles: list[list[int]]) -> Row:
        """A mesh written out in the scene, which is kept as a file beside it that is not on disk.

        Raises:
            BadShape: a corner that is not there.
        """
        for triangle in triangles:
            if not all(0 <= corner < len(vertices) for corner in triangle):
                raise BadShape(
                    f"triangle {triangle} of {len(vertices)} vertices",
                    valid="corners that are there",
                )
        name = f"{self._asked.path.name}.mesh{self._n_inline}.off"
        self._n_inline += 1
        self._asked.files.put(self._asked.path.parent / name, off_text(vertices, triangles))
        return {"mesh": {"file": name}}

    def octomap(self, given: Message) -> Row | None:
        """An octomap written out in the scene, kept likewise; None where no cell of it is occupied.

        Raises:
            BadInput: another kind of map, data that are no bytes, or a tree that is cut off.
        """
        data = items(given, "data")
        if not all(type(byte) is int and -128 <= byte <= 255 for byte in data):
            raise BadScene("a byte is no whole number of -128 to 255", where="data", valid="bytes")
        content = file_of_message(
            bytes(byte & 255 for byte in data),
            text(given, "id"),
            number(given.get("resolution"), "resolution"),
            is_binary=given.get("binary") is True,
        )
        if not len(octree_of(content).sizes):
            return None
        name = f"{self._asked.path.name}.octomap.bt"
        self._asked.files.put(self._asked.path.parent / name, content)
        return {"mesh": {"file": name}}

    def named(self, uri: str, scale: list[float]) -> Row:
        """A mesh file.

        Raises:
            MissingFile: it is not there. BadDimension: a scale of 0.
        """
        if 0.0 in scale:
            raise BadDimension(f"scale {scale}", valid="a scale is not zero")
        folder = self._asked.path.parent
        path = self.found.mesh(uri, folder)
        return mesh_row(os.path.relpath(path, folder), scale)
