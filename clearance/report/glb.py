"""A GLB file of the worst moment, for slides and CAD: a node for each body under its name, and the line.

An adapter of trimesh, which writes it. glTF holds positions as float32 (off by 6e-8 of a length: 0.06 µm in 1 m),
and is y up: the root node turns z up to y up, and all below it is as in the world of the case. The witness points
stand in the line's `extras` as they were measured. Not for: reading GLB (`formats.mesh.gltf_file`).
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np
import trimesh
from trimesh.visual.material import PBRMaterial

from clearance.geometry.shapes import cylinder, sphere
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.replay import Replay
from clearance.report.still import Still, still_of

Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1, 0], [0, -1, 0, 0], [0, 0, 0, 1]])
"""The quarter turn about x that turns z up to y up."""

LINE_SHARE, DOT_SHARE = 1 / 1200, 1 / 500
"""Radii of the line and its dots, of the room's diagonal."""


def glb_of(record: Record, replay: Replay, worst: Moment) -> bytes:
    """The file; the same record gives the same bytes.

    Args:
        worst: the most critical moment, which the replay was made with.
    """
    still = still_of(replay)
    names = {body.name for body in still.bodies}
    root, line = free_name(record.case.name, names), free_name("witness line", names)
    base = free_name("world", {*names, root, line})
    scene = trimesh.Scene(base_frame=base)
    scene.graph.update(frame_from=base, frame_to=root, matrix=Y_UP)
    for body in still.bodies:
        colour = (*body.colour, body.opacity)
        _add(scene, body.name, root, still.shapes[body.i_shape], colour, body.pose)
    extras = {
        "clearance": worst.clearance,
        "time": worst.time,
        "bodies": [worst.link, worst.obstacle],
        "points": still.line.tolist(),
        "frame": "world of the case, z up",
        "rule": worst.rule,
        "status": record.status_of(worst),
    }
    scene.graph.update(frame_from=root, frame_to=line, matrix=np.eye(4), metadata=extras)
    _add_line(scene, line, still)
    return scene.export(file_type="glb", include_normals=False, unitize_normals=False)


def _add_line(scene: trimesh.Scene, name: str, still: Still) -> None:
    """The line and its dots, solid so that every program shows them."""
    colour = (*still.colour, 1.0)
    length = float(np.linalg.norm(still.line[1] - still.line[0]))
    dot = sphere(still.size * DOT_SHARE, 0.05 * still.size * DOT_SHARE)
    for side, end in zip(("first point", "second point"), still.line, strict=True):
        pose = trimesh.transformations.translation_matrix(end)
        _add(scene, f"{name}: {side}", name, (dot.vertices, dot.triangles()), colour, pose)
    if length > 0.0:
        tube = cylinder(still.size * LINE_SHARE, length, sections=12)
        pose = trimesh.geometry.align_vectors([0.0, 0.0, 1.0], still.line[1] - still.line[0])
        pose[:3, 3] = still.line.mean(axis=0)
        _add(scene, f"{name}: segment", name, (tube.vertices, tube.triangles()), colour, pose)


def _add(
    scene: trimesh.Scene,
    name: str,
    parent: str,
    shape: tuple[np.ndarray, np.ndarray],
    colour: tuple[float, ...],
    pose: np.ndarray,
) -> None:
    """Puts a shape of one colour (sRGB and opacity, 0 to 1) below a node."""
    linear = [_linear(value) for value in colour[:3]]
    material = PBRMaterial(
        baseColorFactor=[*linear, colour[3]],
        metallicFactor=0.0,
        roughnessFactor=0.8,
        doubleSided=True,
        alphaMode="OPAQUE" if colour[3] == 1.0 else "BLEND",
    )
    mesh = trimesh.Trimesh(*shape, process=False, validate=False)
    mesh.visual = trimesh.visual.TextureVisuals(material=material)
    scene.add_geometry(
        mesh, node_name=name, geom_name=name, parent_node_name=parent, transform=pose
    )


def free_name(wanted: str, used: Collection[str]) -> str:
    """The name, with as many lines behind it as it takes to be no body's."""
    while wanted in used:
        wanted += "_"
    return wanted


def _linear(value: float) -> float:
    """A component of sRGB without its gamma, as glTF has colours."""
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4
