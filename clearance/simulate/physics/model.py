"""The URDF that the physics engine is given: the robot's own joints and masses, our shapes or none.

Shapes are written by us, in the link frames, so that the engine's mesh loaders and its view of
`package://` never matter. Not for: running the engine (`bullet`).
"""

from __future__ import annotations

import math
import xml.etree.ElementTree as ET
from itertools import pairwise
from pathlib import Path

import numpy as np

from clearance.errors import BadSyntax, MissingFile, NotSimulated
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.joint_positions import turns
from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot

_FRAME_MASS = (
    1e-3  # [kg] of a link that the URDF gives no mass: a mere frame, light but not singular
)
_FRAME_INERTIA = 1e-6  # [kg m^2]
_MARGIN = 1e-6  # [-] of a moment of inertia, beyond the rounding of the engine, which takes impossible ones as 0
_ROUNDED = 1e-3  # [-] of a moment of inertia: URDFs are written in three digits or more


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
        _complete_inertial(link)
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


def _complete_inertial(link: ET.Element) -> None:
    """Gives a link a mass and an inertia with which the engine moves it: it holds links of mass 0 still."""
    inertial = link.find("inertial")
    if inertial is None or not _mass(link):
        if inertial is not None:
            link.remove(inertial)
        link.append(_frame_inertial())
        return
    tensor = _inertia(link)
    added = _least_to_add(tensor)
    inertia = inertial.find("inertia")
    if inertia is None:
        inertia = ET.SubElement(inertial, "inertia")
    for name, (i, j) in _MOMENTS.items():
        inertia.set(name, repr(float(tensor[i, j] + (added if i == j else 0.0))))


_MOMENTS = {
    "ixx": (0, 0),
    "iyy": (1, 1),
    "izz": (2, 2),
    "ixy": (0, 1),
    "ixz": (0, 2),
    "iyz": (1, 2),
}


def _inertia(link: ET.Element) -> np.ndarray:
    """(3, 3) [kg m^2] as the URDF gives it; zeros where it gives none."""
    tensor, given = np.zeros((3, 3)), link.find("inertial/inertia")
    for name, (i, j) in _MOMENTS.items():
        tensor[i, j] = tensor[j, i] = 0.0 if given is None else _number(link, given, name)
    return tensor


def _least_to_add(tensor: np.ndarray) -> float:
    """[kg m^2] by how much to raise each moment until none exceeds the two others together, as in a body."""
    least, middle, most = np.linalg.eigvalsh(tensor).tolist()
    if least == most == 0.0:
        return _FRAME_INERTIA
    return max(0.0, most * (1.0 + _MARGIN) - least - middle)


def _mass(link: ET.Element) -> float:
    """[kg] as the URDF gives it; 0 where it gives none."""
    given = link.find("inertial/mass")
    return 0.0 if given is None else _number(link, given, "value")


def _number(link: ET.Element, element: ET.Element, name: str) -> float:
    """An attribute, 0 where there is none.

    Raises:
        BadInput: it is no finite number.
    """
    text = element.get(name, "0")
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not math.isfinite(number):
        where = f"link {link.get('name', '')!r}"
        raise NotSimulated(f"{name} is {text!r:.60}", where=where, valid="a finite number")
    return number


def notes_on_masses(placed: PlacedRobot) -> list[str]:
    """What is assumed about links that have a shape and no mass, or a mass and no inertia."""
    with_shape = {body.name for body in placed.robot.bodies}
    links = {link.get("name", ""): link for link in _parsed(placed.urdf_path).findall("link")}
    bare = [name for name, link in links.items() if not _mass(link)]
    points = [name for name, link in links.items() if name not in bare and not _inertia(link).any()]
    weightless = [name for name in bare if name in with_shape]
    said = {"mass": (weightless, "weightless"), "inertia": (points, "one point")}
    return [
        f"simulated motion: the URDF gives no {what} to {', '.join(names)}; taken as {taken}"
        for what, (names, taken) in said.items()
        if names
    ]


def notices_on_model(placed: PlacedRobot) -> list[Notice]:
    """Warnings on what of the robot's URDF the engine does not follow: friction, and inertias that no body has."""
    robot, found = _parsed(placed.urdf_path), []
    kinds = {joint.name: "N m" if turns(joint) else "N" for joint in placed.robot.moving_joints}
    rubbing = []
    for joint in robot.findall("joint"):
        name, given = joint.get("name", ""), joint.find("dynamics")
        friction = 0.0 if given is None else _number(joint, given, "friction")
        if friction and name in kinds:
            limit = joint.find("limit")
            effort = 0.0 if limit is None else _number(joint, limit, "effort")
            rubbing.append(f"{name!r} {friction:g} of {effort:g} {kinds[name]}")
    if rubbing:
        text = f"the friction that the URDF gives to joints is not simulated: {listed(rubbing, 4)} of effort"
        found.append(text)
    for link in robot.findall("link"):
        tensor = _inertia(link)
        added, most = _least_to_add(tensor), float(np.linalg.eigvalsh(tensor)[-1])
        if _mass(link) and added > _ROUNDED * most > 0.0:
            found.append(
                f"no body has the inertia that the URDF gives to link {link.get('name', '')!r}: "
                f"{added:.3g} kg m² are added to each moment, of up to {most:.3g}"
            )
    return [Notice(Severity.WARNING, "simulated", f"simulated motion: {text}") for text in found]


def write_obj(shape: Polyhedron, path: Path) -> Path:
    """Writes the faces as a Wavefront OBJ, triangles only; returns its path."""
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in shape.vertices.tolist()]
    for start, stop in zip(shape.face_starts[:-1], shape.face_starts[1:], strict=True):
        first, *others = (shape.face_vertices[start:stop] + 1).tolist()
        lines += [f"f {first} {b} {c}" for b, c in pairwise(others)]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")
    return path


def _parsed(urdf_path: str) -> ET.Element:
    if not urdf_path:
        raise NotSimulated(
            "masses and efforts of a robot made in Python are not known",
            valid="PlacedRobot(…, urdf_path=FILE)",
        )
    try:
        root = ET.parse(urdf_path).getroot()
        if urdf_path.endswith(".xacro") or any("xacro" in str(part.tag) for part in root.iter()):
            raise BadSyntax(
                "is a xacro file, which is not simulated",
                where=urdf_path,
                valid="turn it into URDF with the xacro command first",
            )
        for part in root.iter():
            part.tag = part.tag.rpartition("}")[2]  # a default namespace
    except OSError as error:
        raise MissingFile(f"cannot be read ({error.strerror})", where=urdf_path) from None
    except ET.ParseError as error:
        raise BadSyntax(f"is not XML ({error})", where=urdf_path, valid="a URDF file") from None
    if root.tag != "robot":
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
