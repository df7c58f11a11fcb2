"""The URDF that the physics engine is given: the robot's own joints and masses, our shapes or none.

Shapes are written by us, in the link frames, so that the engine's mesh loaders and its view of
`package://` never matter. Not for: running the engine (`bullet`).
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

from clearance.errors import BadSyntax, MissingFile, NotSimulated
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.placed_robot import PlacedRobot

_FRAME_MASS = (
    1e-3  # [kg] of a link that the URDF gives no mass: a mere frame, light but not singular
)
_FRAME_INERTIA = 1e-6  # [kg m^2]


def write_physics_urdf(placed: PlacedRobot, folder: Path, with_shapes: bool) -> Path:
    """The path of a URDF in `folder` with the robot's links and joints, and its shapes if asked.

    Raises:
        MissingFile, BadSyntax: the robot's URDF cannot be read. BadInput: a joint of several degrees of freedom.
    """
    robot = _parsed(placed.urdf_path)
    _refuse_compound_joints(placed)
    bodies = {body.name: body.shape for body in placed.robot.bodies} if with_shapes else {}
    for i_link, link in enumerate(robot.findall("link")):
        for element in [*link.findall("visual"), *link.findall("collision")]:
            link.remove(element)
        if link.find("inertial") is None:
            link.append(_frame_inertial())
        shape = bodies.get(link.get("name", ""))
        if shape is not None:
            link.append(_collision(write_obj(shape, folder / f"link_{i_link}.obj")))
    _set_unit_axes(robot, placed)
    path = folder / "robot.urdf"
    ET.ElementTree(robot).write(path, encoding="utf-8", xml_declaration=True)
    return path


def _refuse_compound_joints(placed: PlacedRobot) -> None:
    """Planar and floating joints are several of ours and one of the engine's."""
    for joint in placed.robot.joints:
        if joint.part_of is not None:
            kind, name = joint.part_of
            raise NotSimulated(
                f"motion with the {kind} joint {name!r} cannot be simulated",
                where=placed.urdf_path,
                valid="a chain of joints of one axis in its place",
            )


def _set_unit_axes(robot: ET.Element, placed: PlacedRobot) -> None:
    """Writes unit axes: to the engine an axis of length 3 means three times the way."""
    axes = {joint.name: joint.axis for joint in placed.robot.joints}
    for joint in robot.findall("joint"):
        axis, name = joint.find("axis"), joint.get("name", "")
        if axis is not None and name in axes:
            axis.set("xyz", " ".join(repr(float(part)) for part in axes[name]))


def notes_on_masses(placed: PlacedRobot) -> list[str]:
    """What is assumed about links that have a shape and no mass."""
    with_shape = {body.name for body in placed.robot.bodies}
    bare = [
        name
        for link in _parsed(placed.urdf_path).findall("link")
        if link.find("inertial") is None and (name := link.get("name", "")) in with_shape
    ]
    if not bare:
        return []
    return [f"simulated motion: the URDF gives no mass to {', '.join(bare)}; taken as weightless"]


def write_obj(shape: Polyhedron, path: Path) -> Path:
    """Writes the faces as a Wavefront OBJ, triangles only; returns its path."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in shape.vertices.tolist()]
    for start, stop in zip(shape.face_starts[:-1], shape.face_starts[1:], strict=True):
        first, *others = (shape.face_vertices[start:stop] + 1).tolist()
        lines += [f"f {first} {b} {c}" for b, c in pairwise(others)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def _parsed(urdf_path: str) -> ET.Element:
    try:
        root = ET.parse(urdf_path).getroot()
        if urdf_path.endswith(".xacro") or any("xacro" in str(part.tag) for part in root.iter()):
            raise BadSyntax(
                "is a xacro file, which is not simulated",
                where=urdf_path,
                valid="turn it into URDF with the xacro command first",
            )
    except OSError as error:
        raise MissingFile(f"cannot be read ({error.strerror})", where=urdf_path) from None
    except ET.ParseError as error:
        raise BadSyntax(f"is not XML ({error})", where=urdf_path, valid="a URDF file") from None
    if root.tag.rpartition("}")[2] != "robot":
        raise BadSyntax(
            "its motion cannot be simulated", where=urdf_path, valid="the robot as URDF"
        )
    return root


def _frame_inertial() -> ET.Element:
    inertial = ET.Element("inertial")
    ET.SubElement(inertial, "mass", value=str(_FRAME_MASS))
    diagonal = dict.fromkeys(("ixx", "iyy", "izz"), str(_FRAME_INERTIA))
    ET.SubElement(inertial, "inertia", diagonal | dict.fromkeys(("ixy", "ixz", "iyz"), "0"))
    return inertial


def _collision(mesh: Path) -> ET.Element:
    collision = ET.Element("collision")
    geometry = ET.SubElement(collision, "geometry")
    ET.SubElement(geometry, "mesh", filename=str(mesh))
    return collision
