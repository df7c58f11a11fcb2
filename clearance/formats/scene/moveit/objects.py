"""MoveIt's CollisionObject messages to rows of a YAML scene. Not for: what they are attached to."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.errors import BadInput, BadShape, at
from clearance.formats.message.values import (
    Message,
    Poses,
    items,
    message,
    messages,
    number,
    numbers,
    text,
)
from clearance.formats.scene.moveit.shapes import KINDS, Row, SceneMeshes, primitive
from clearance.formats.scene.pose_row import pose_row

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
        if given.get("operation") not in _ADD:
            raise BadInput(
                f"{given['operation']!r:.40} is given", where="operation", valid="ADD (0)"
            )
        if items(given, "planes"):
            raise BadInput("a plane, which has no end, is not read", where="planes", valid="a box")
        from_object = frame @ poses.read(message(given, "pose"))
        shapes = [*_placed(given, "primitives", "primitive_poses", meshes, poses)]
        shapes += _placed(given, "meshes", "mesh_poses", meshes, poses)
        if not shapes:
            raise BadInput("it has no shape", valid="primitives or meshes")
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
            row = _primitive(shape) if key == "primitives" else _mesh(shape, meshes)
        yield row, placed[i] if placed else np.eye(4)


def _primitive(given: Message) -> Row:
    kind = given.get("type")
    if isinstance(kind, int) and kind in KINDS:
        kind = KINDS[kind]
    if not isinstance(kind, str):
        raise BadInput(f"{kind!r:.40} is given", where="type", valid="box, sphere or cylinder")
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
