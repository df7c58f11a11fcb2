"""MJCF to a scene: an obstacle for each geom that stands. Not for: models that are robots (`mjcf.robot`)."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from clearance.errors import BadScene, at
from clearance.formats.mesh.off_file import off_text
from clearance.formats.mesh_store import MeshStore
from clearance.formats.robot.mjcf.document import mjcf_document
from clearance.formats.robot.mjcf.mujoco_adapter import MjcfGeom, MjcfModel
from clearance.formats.robot.mjcf.shapes import (
    MjcfShapes,
    body_from_shape,
    compiled,
    primitive,
    triangles_of,
)
from clearance.formats.robot.shape_kinds import note_on_planes
from clearance.formats.scene.request import SceneContent, SceneRequest, pose_row
from clearance.world.notice import Notice, warnings_naming


def read_mjcf_scene(asked: SceneRequest) -> SceneContent:
    """The geoms of an MJCF file that collide, where the file places them, called body/geom.

    Raises:
        BadInput: with the file and the body, joint, geom or mesh. Unavailable: MuJoCo is not installed.
    """
    with at(asked.shown):
        document = mjcf_document(asked.path, asked.files)
        model, shapes = compiled(document, asked.package_dirs, MeshStore(asked.files))
        poses = _body_poses(model)
        colliding = [geom for geom in model.geoms if geom.collides]
        if not colliding:
            raise BadScene("none of its geoms collides", valid="geoms with contype or conaffinity")
        obstacles = [
            {"name": _name(model, geom), **_row(geom, poses[geom.body], shapes, asked)}
            for geom in colliding
        ]
    notes = [f"{asked.shown}: {note}" for note in _notes(model, colliding)]
    return SceneContent(
        {"obstacles": obstacles}, (*notes, *shapes.notes()), tuple(_notices(model, colliding))
    )


def _body_poses(model: MjcfModel) -> list[np.ndarray]:
    """(4, 4) [m] of each body in the world, as the file has them."""
    poses: list[np.ndarray] = []
    for body in model.bodies:
        poses.append(body.pose if not poses else poses[body.parent] @ body.pose)
    return poses


def _name(model: MjcfModel, geom: MjcfGeom) -> str:
    return geom.name if geom.body == 0 else f"{model.bodies[geom.body].name}/{geom.name}"


def _row(
    geom: MjcfGeom, world_from_body: np.ndarray, shapes: MjcfShapes, asked: SceneRequest
) -> dict[str, Any]:
    """The row of a YAML scene for a geom, but for its name."""
    pose = world_from_body @ body_from_shape(geom)
    if geom.kind == "mesh":
        with at(f"mesh {geom.mesh!r}"):
            return {"mesh": _mesh(geom.mesh, shapes, asked), "pose": pose_row(pose)}
    kind, dimensions = primitive(geom)
    return {kind: dimensions, "pose": pose_row(pose)}


def _mesh(name: str, shapes: MjcfShapes, asked: SceneRequest) -> dict[str, Any]:
    """A mesh by its file; one that the model moves, or that stands in it, by a file that is not on disk."""
    mesh = shapes.spec.meshes[name]
    if mesh.file and mesh.lies_as_in_its_file:
        path = shapes.file_of(mesh.file)
        file = os.path.relpath(path, asked.path.parent)
        return {"file": file, "scale": mesh.scale.tolist(), "collada_up_axis": "ros"}
    vertices, triangles = triangles_of(shapes.mesh(name)[0])
    file = f"{asked.path.name}.{_as_file_name(name)}.off"
    asked.files.put(asked.path.parent / file, off_text(vertices.tolist(), triangles.tolist()))
    return {"file": file}


def _as_file_name(name: str) -> str:
    """The name with codes for what a file's name cannot hold; two names stay two."""
    return re.sub(r"[^\w.-]", lambda found: f"%{ord(found[0]):02x}", name)


def _notes(model: MjcfModel, colliding: list[MjcfGeom]) -> list[str]:
    notes = []
    n_left_out = len(model.geoms) - len(colliding)
    if n_left_out:
        notes.append(
            f"{n_left_out} geoms that collide with nothing (contype, conaffinity) are left out"
        )
    planes = [geom.name for geom in colliding if geom.kind == "plane"]
    return [*notes, *note_on_planes(planes)]


def _notices(model: MjcfModel, colliding: list[MjcfGeom]) -> Iterator[Notice]:
    """Warnings on bodies that could move, and that a geom that collides is on."""
    bearing = model.bearing(geom.body for geom in colliding)
    mocap = [i for i, body in enumerate(model.bodies) if body.is_mocap]
    moving = {"bodies on joints": [joint.body for joint in model.joints], "mocap bodies": mocap}
    for what, indices in moving.items():
        names = [repr(model.bodies[i].name) for i in dict.fromkeys(indices) if i in bearing]
        text = f"{what} stand where the file has them, with all that is on them"
        yield from warnings_naming(text, names)
