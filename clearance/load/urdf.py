"""URDF to a robot, and the one door to yourdfpy.

The document is checked first (`urdf_elements`); yourdfpy then turns it into links and joints
without touching any mesh, and meshes go through our own loader. Not for: where the robot stands, or
how it moves.
"""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np

from clearance.errors import BadSyntax, at
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import box, capsule, cylinder, sphere
from clearance.load.joints import joints_from_model
from clearance.load.mesh import LoadedMesh
from clearance.load.mesh_paths import mesh_path
from clearance.load.mesh_store import MeshStore
from clearance.load.robot_tree import links_from_root
from clearance.load.urdf_elements import origin_notes, parse_document
from clearance.world.body import Body
from clearance.world.robot import Robot

if TYPE_CHECKING:
    import yourdfpy
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
        model = _model(root)
        joints, notes = joints_from_model(model)
        notes += [f"{shown}: {note}" for note in unit_notes]
        link_names, ordered = links_from_root([link.name for link in model.links], joints)
        by_name = {link.name: link for link in model.links}
        bodies = []
        for name in link_names:
            body, link_notes = _body(by_name[name], request, meshes)
            notes += [f"{shown}: {note}" for note in link_notes]
            bodies += [body] if body is not None else []
        bare = [name for name in link_names if not _elements(by_name[name], request)]
        if bare:
            what = f"no {request.geometry} geometry and not measured: {', '.join(bare)}"
            links = "1 link" if len(bare) == 1 else f"{len(bare)} links"
            notes.append(f"{shown}: {links} with {what}")
    return Robot(model.name, link_names, ordered, tuple(bodies), tuple(notes))


def _model(root: Element) -> yourdfpy.Robot:
    import yourdfpy
    from lxml import etree

    root.set("name", root.get("name") or "robot")
    for element in root.iter("collision", "visual"):
        element.set("name", element.find("geometry")[0].tag)
    for element in list(
        root.iter("capsule")
    ):  # yourdfpy has no capsule; its `name` tells them apart
        element.tag = "cylinder"
    try:
        document = io.BytesIO(etree.tostring(root))
        return yourdfpy.URDF.load(document, build_scene_graph=False, load_meshes=False).robot
    except (
        Exception
    ) as error:  # whatever its parsing hits; the document is checked, so this is rare
        raise BadSyntax(f"not a URDF that can be read: {type(error).__name__}: {error}") from None


def _elements(
    link: yourdfpy.Link, request: UrdfRequest
) -> list[yourdfpy.Collision] | list[yourdfpy.Visual]:
    return link.collisions if request.geometry == "collision" else link.visuals


def _body(
    link: yourdfpy.Link, request: UrdfRequest, meshes: MeshStore
) -> tuple[Body | None, list[str]]:
    elements = _elements(link, request)
    if not elements:
        return None, []
    shapes, origins, notes = [], [], []
    for i, element in enumerate(elements):
        with at(f"link {link.name!r} {request.geometry}[{i}]"):
            shape, origin, shape_notes = _shape(element, request, meshes)
        shapes.append(shape if element.origin is None else shape.transformed(element.origin))
        origins.append(origin)
        notes += shape_notes
    return Body(link.name, Polyhedron.merged(shapes), ", ".join(origins)), notes


def _shape(
    element: yourdfpy.Collision | yourdfpy.Visual, request: UrdfRequest, meshes: MeshStore
) -> tuple[Polyhedron, str, list[str]]:
    """The shape of one element in its own frame, what it was made from, and notes."""
    geometry = element.geometry
    if geometry.mesh is not None:
        mesh, shown = _mesh(geometry.mesh, request, meshes)
        return mesh.shape, shown, [f"{shown}: {note}" for note in mesh.notes]
    if geometry.box is not None:
        return box(geometry.box.size), "box", []
    if geometry.sphere is not None:
        return sphere(radius=geometry.sphere.radius), "sphere", []
    made = capsule if element.name == "capsule" else cylinder
    rod = geometry.cylinder
    return made(radius=rod.radius, length=rod.length), element.name, []


def _mesh(mesh: yourdfpy.Mesh, request: UrdfRequest, meshes: MeshStore) -> tuple[LoadedMesh, str]:
    path = mesh_path(mesh.filename, request.path.parent, request.package_dirs)
    scale = np.ones(3) if mesh.scale is None else np.broadcast_to(mesh.scale, 3)
    return meshes.load(path, tuple(scale.tolist())), meshes.files.shown(path)
