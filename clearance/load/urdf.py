"""URDF to a robot: one body for each link that has a shape.

The document is checked first (`urdf_elements`), so that what is read here is there; meshes go through our own
loader. Not for: where the robot stands, or how it moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from clearance.errors import at
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box, capsule, cylinder, sphere
from clearance.load.input_files import InputFiles
from clearance.load.joints import joints_of
from clearance.load.mesh import LoadedMesh
from clearance.load.mesh_paths import mesh_path
from clearance.load.mesh_store import MeshStore
from clearance.load.robot_tree import links_from_root
from clearance.load.urdf_elements import number, numbers, origin_notes, parse_document, pose_of
from clearance.world.body import Body
from clearance.world.robot import Robot

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

Geometry = Literal["collision", "visual"]


@dataclass(frozen=True)
class UrdfRequest:
    """Which URDF, and how it is to be read.

    Attributes:
        path: the URDF file.
        package_dirs: where `package://` is looked up.
        geometry: which elements are the robot's shape.
    """

    path: Path
    package_dirs: tuple[Path, ...] = ()
    geometry: Geometry = "collision"


def load_urdf(
    path: str | Path, *, package_dirs: Sequence[str | Path] = (), geometry: Geometry = "collision"
) -> Robot:
    """The robot in a URDF file, for cases that are made in memory.

    Args:
        package_dirs: where `package://` is looked up.
        geometry: which elements are the robot's shape.

    Raises:
        BadInput: with the file and the element.
    """
    path = Path(path)
    request = UrdfRequest(path, tuple(Path(folder) for folder in package_dirs), geometry)
    return read_robot(request, MeshStore(InputFiles(path.parent)))


def read_robot(request: UrdfRequest, meshes: MeshStore) -> Robot:
    """The robot in a URDF file: one body for each link that has a shape, in the link's frame.

    Raises:
        BadInput: with the file and the element.
    """
    shown = meshes.files.shown(request.path)
    data = meshes.files.read(request.path)
    with at(shown):
        root = parse_document(data)
        unit_notes = origin_notes(root)
        joints, notes = joints_of(root)
        notes += [f"{shown}: {note}" for note in unit_notes]
        by_name = {link.get("name"): link for link in root.iterfind("link")}
        link_names, ordered = links_from_root(tuple(by_name), joints)
        bodies = []
        for name in link_names:
            body, link_notes = _body(by_name[name], request, meshes)
            notes += [f"{shown}: {note}" for note in link_notes]
            bodies += [body] if body is not None else []
        bare = [name for name in link_names if by_name[name].find(request.geometry) is None]
        if bare:
            what = f"no {request.geometry} geometry and not measured: {', '.join(bare)}"
            links = "1 link" if len(bare) == 1 else f"{len(bare)} links"
            notes.append(f"{shown}: {links} with {what}")
    return Robot(root.get("name") or "robot", link_names, ordered, tuple(bodies), tuple(notes))


def _body(
    link: Element, request: UrdfRequest, meshes: MeshStore
) -> tuple[Body | None, list[str]]:
    """The shapes of a link as one body in its frame, if it has any, and notes."""
    elements = link.findall(request.geometry)
    if not elements:
        return None, []
    name = link.get("name")
    shapes, origins, notes = [], [], []
    for i, element in enumerate(elements):
        with at(f"link {name!r} {request.geometry}[{i}]"):
            shape, origin, shape_notes = _shape(element.find("geometry")[0], request, meshes)
        moved = element.find("origin") is not None
        shapes.append(shape.transformed(pose_of(element)) if moved else shape)
        origins.append(origin)
        notes += shape_notes
    return Body(name, Polyhedron.merged(shapes), ", ".join(origins)), notes


def _shape(
    element: Element, request: UrdfRequest, meshes: MeshStore
) -> tuple[Polyhedron, str, list[str]]:
    """The shape of one element in its own frame, what it was made from, and notes."""
    kind = element.tag
    if kind == "mesh":
        mesh, shown = _mesh(element, request, meshes)
        return mesh.shape, shown, [f"{shown}: {note}" for note in mesh.notes]
    if kind == "box":
        return box(numbers(element, "size")), kind, []
    radius = number(element, "radius")
    if kind == "sphere":
        return sphere(radius=radius), kind, []
    made = capsule if kind == "capsule" else cylinder
    return made(radius=radius, length=number(element, "length")), kind, []


def _mesh(element: Element, request: UrdfRequest, meshes: MeshStore) -> tuple[LoadedMesh, str]:
    path = mesh_path(element.get("filename"), request.path.parent, request.package_dirs)
    scale = np.broadcast_to(numbers(element, "scale", (1.0,)), 3)
    return meshes.load(path, tuple(scale.tolist())), meshes.files.shown(path)
