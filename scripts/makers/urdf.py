"""URDF text from parts and joints; masses and inertias from the parts' volumes. Not for: reading URDF."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from scripts.makers.solids import Solid


@dataclass(frozen=True, eq=False)
class Part:
    """One closed mesh of a link, in the link frame; `density` [kg/m3] is that of a hollow casting."""

    link: str
    name: str
    solid: Solid
    colour: tuple[float, float, float]
    density: float = 1500.0


@dataclass(frozen=True)
class JointSpec:
    """A joint as URDF writes it; without limits it is fixed."""

    name: str
    kind: str
    parent: str
    child: str
    origin: tuple[float, float, float]
    axis: tuple[int, int, int] = (1, 0, 0)
    limits: tuple[float, float] | None = None
    effort: float = 0.0
    velocity: float = 0.0
    mimic: str = ""


def urdf_text(robot: str, parts: Sequence[Part], joints: Sequence[JointSpec]) -> str:
    """The whole file. Meshes are named `package://<robot>/meshes/<part>.stl`."""
    root = ElementTree.Element("robot", name=robot)
    root.append(ElementTree.Comment(" written by scripts/makers/robot.py "))
    for link in [joints[0].parent, *(joint.child for joint in joints)]:
        _add_link(root, robot, link, [part for part in parts if part.link == link])
    for joint in joints:
        _add_joint(root, joint)
    ElementTree.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ElementTree.tostring(root, "unicode") + "\n"


def _add_link(root: ElementTree.Element, robot: str, link: str, parts: Sequence[Part]) -> None:
    element = ElementTree.SubElement(root, "link", name=link)
    _add_inertial(element, parts)
    for part in parts:
        for kind in ("visual", "collision"):
            entry = ElementTree.SubElement(element, kind, name=part.name)
            geometry = ElementTree.SubElement(entry, "geometry")
            ElementTree.SubElement(
                geometry, "mesh", filename=f"package://{robot}/meshes/{part.name}.stl"
            )
            if kind == "visual":
                material = ElementTree.SubElement(entry, "material", name=_colour_name(part.colour))
                ElementTree.SubElement(material, "color", rgba=_numbers((*part.colour, 1.0)))


def _add_inertial(element: ElementTree.Element, parts: Sequence[Part]) -> None:
    mass, centre, inertia = (
        _mass_properties(parts) if parts else (1e-3, np.zeros(3), np.eye(3) * 1e-6)
    )
    inertial = ElementTree.SubElement(element, "inertial")
    ElementTree.SubElement(inertial, "origin", xyz=_numbers(centre), rpy="0 0 0")
    ElementTree.SubElement(inertial, "mass", value=f"{mass:.4g}")
    names = {
        "ixx": (0, 0),
        "ixy": (0, 1),
        "ixz": (0, 2),
        "iyy": (1, 1),
        "iyz": (1, 2),
        "izz": (2, 2),
    }
    values = {name: f"{_tidy(inertia[at], mass):.4g}" for name, at in names.items()}
    ElementTree.SubElement(inertial, "inertia", values)


def _tidy(entry: float, mass: float) -> float:
    """An inertia entry, 0 where only rounding made it differ from 0 (below mass × 0.03 mm squared)."""
    return entry if abs(entry) > mass * 1e-9 else 0.0


def _add_joint(root: ElementTree.Element, joint: JointSpec) -> None:
    element = ElementTree.SubElement(root, "joint", name=joint.name, type=joint.kind)
    ElementTree.SubElement(element, "parent", link=joint.parent)
    ElementTree.SubElement(element, "child", link=joint.child)
    ElementTree.SubElement(element, "origin", xyz=_numbers(joint.origin), rpy="0 0 0")
    if joint.limits is None:
        return
    ElementTree.SubElement(element, "axis", xyz=_numbers(joint.axis))
    lower, upper = joint.limits
    ElementTree.SubElement(
        element,
        "limit",
        lower=f"{lower:g}",
        upper=f"{upper:g}",
        effort=f"{joint.effort:g}",
        velocity=f"{joint.velocity:g}",
    )
    ElementTree.SubElement(element, "dynamics", damping="0.5", friction="0")
    if joint.mimic:
        ElementTree.SubElement(element, "mimic", joint=joint.mimic, multiplier="1", offset="0")


def _mass_properties(parts: Sequence[Part]) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centre of mass [m] and inertia about it [kg m2], summed over tetrahedra from the origin.

    Source: the second moments of a tetrahedron, Tonon 2004, in the form of Blow and Binstock 2004.
    """
    mass, first, second = 0.0, np.zeros(3), np.zeros((3, 3))
    for part in parts:
        a, b, c = np.moveaxis(part.solid.vertices[part.solid.triangles], 1, 0)
        volumes = np.einsum("ij,ij->i", a, np.cross(b, c)) / 6.0 * part.density
        total = a + b + c
        mass += volumes.sum()
        first += (volumes[:, None] * total / 4.0).sum(axis=0)
        outer = sum(np.einsum("i,ij,ik->jk", volumes, p, p) for p in (a, b, c, total))
        second += outer / 20.0
    centre = first / mass
    second -= mass * np.outer(centre, centre)
    return mass, centre, np.trace(second) * np.eye(3) - second


def _numbers(values: Sequence[float]) -> str:
    return " ".join(f"{round(float(v), 6) + 0.0:g}" for v in values)


def _colour_name(colour: tuple[float, float, float]) -> str:
    return "rgb_" + "_".join(f"{round(255 * part):02x}" for part in colour)
