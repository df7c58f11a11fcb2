"""What a URDF document must look like before anything is made of it: each fault names its element.

A table says what is read, and which names say nothing about shape or motion (inertia, colour, gazebo, …): these
are taken out. Then a `<geometry>` has one child, its shape, and attributes hold what `pose_of` and `numbers` read.
"""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadRobot, MissingKey, at
from clearance.formats.plausibility import odd_angles
from clearance.formats.robot.request import Geometry
from clearance.formats.robot.shape_kinds import chosen_kind
from clearance.formats.text.numbers import finite_numbers, is_zero
from clearance.formats.text.unread import ANY, Format, Row, Unread, unread
from clearance.formats.text.xml_document import robot_element
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.geometry.quaternions import of_unit_length
from clearance.geometry.shapes import SHAPES, Measure
from clearance.world.names import checked_name, require_own_names

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_PRIMITIVES = {name: shape for name, shape in SHAPES.items() if shape.in_urdf}

_NUMBERS: dict[str, dict[str, tuple[int, ...]]] = {
    **{
        name: {
            key: (3,) if measure is Measure.SIZES else (1,)
            for key, measure in shape.dimensions.items()
        }
        for name, shape in _PRIMITIVES.items()
    },
    "origin": {"xyz": (3,), "rpy": (3,), "quat_xyzw": (4,)},
    "axis": {"xyz": (3,)},
    "mesh": {"scale": (1, 3)},
    "limit": {"lower": (1,), "upper": (1,)},
    "mimic": {"multiplier": (1,), "offset": (1,)},
}
"""How many numbers each attribute holds."""

_REQUIRED = {
    **{name: tuple(shape.dimensions) for name, shape in _PRIMITIVES.items()},
    "link": ("name",),
    "joint": ("name", "type"),
    "parent": ("link",),
    "child": ("link",),
    "mesh": ("filename",),
    "mimic": ("joint",),
}

_SHAPES = (*_PRIMITIVES, "mesh")

_SINGLE = ("origin", "axis", "limit", "mimic")
"""Elements that stand once in another one."""

_LEAVES = (*_SHAPES, *_SINGLE, "parent", "child")

_PASSED = {
    "limit": "effort velocity acceleration deceleration jerk command_effort gear_velocity current twist",
    "mesh": "declare_convex",
}


def _leaf(tag: str) -> Row:
    attributes = " ".join((*_NUMBERS.get(tag, ()), *_REQUIRED.get(tag, ())))
    return Row(attributes=attributes, passed=_PASSED.get(tag, ""), closed=True)


_SHAPE = Row(
    "origin geometry",
    "name",
    "material verbose group mask concave accepting_renderer proximity_properties",
)

_URDF = Format(
    {
        "robot": Row(
            "link joint",
            "name version",
            "gazebo transmission material sensor ros2_control mujoco frame force_element "
            "collision_filter_group",
        ),
        "link": Row(
            "collision visual self_filter self_collision_checking",
            "name",
            "type drake_ignore concave inertial contact gravity kinematic surface collision_checking",
        ),
        "joint": Row(
            "origin parent child axis limit mimic",
            "name type",
            "dynamics safety_controller calibration joint_properties dont_collapse role",
        ),
        **dict.fromkeys(("collision", "visual", "self_filter", "self_collision_checking"), _SHAPE),
        "geometry": Row(ANY, passed="name"),
        **{tag: _leaf(tag) for tag in _LEAVES},
    },
    fault=BadRobot,
)
"""Names that are passed over: those of the specification, and of URDF for Gazebo, ros2_control, Bullet, Drake,
MuJoCo and pinocchio."""

QUATERNION_VERSIONS = ("1.1", "1.2")
VERSIONS = ("1", "1.0", *QUATERNION_VERSIONS)
"""Source: urdfdom, README, "URDF Versioning": 1.1 adds quaternions and capsules, 1.2 limits that are not read."""


def reduced_document(data: bytes) -> tuple[Element, list[Unread]]:
    """The root element of a URDF document, reduced to links' shapes and joints; and what else there was.

    Raises:
        BadSyntax: not XML, no URDF, or a xacro file. BadRobot: another version; an element, attribute or text that
            is not read, and may give a shape or a place.
    """
    root = robot_element(data, "a URDF file")
    checked_name(root.get("name") or "")
    version = root.get("version") or VERSIONS[0]
    if version not in VERSIONS:
        raise BadRobot(f"version={version!r:.60}", where="robot", valid=" or ".join(VERSIONS[1:]))
    found = [*unread(root, _URDF)]
    for one in found:
        if not one.name.endswith("="):
            one.element.getparent().remove(one.element)
    return root, found


def without_empty_shapes(root: Element, geometry: Geometry) -> list[str]:
    """What is taken out of a reduced document since it has no size: no shape, or one whose dimensions are all 0.

    A shape that is flat or a line is left to be refused, since something may come near it.

    Args:
        geometry: which shapes are measured; others are taken out without being named.
    """
    names = []
    for link in root.iterfind("link"):
        has = frozenset(("collision",) if link.find("collision") is not None else ())
        measured = chosen_kind(has, geometry)
        for kind in ("collision", "visual"):
            for i, element in enumerate(link.findall(kind)):
                if _has_no_size(element):
                    names += [f"link {link.get('name')!r} {kind}[{i}]"] * (kind == measured)
                    link.remove(element)
    return names


def _has_no_size(element: Element) -> bool:
    geometry = element.find("geometry")
    if geometry is None or not len(geometry):
        return True
    sizes = geometry[0].attrib.values() if geometry[0].tag in _PRIMITIVES else ()
    words = [word for size in sizes for word in size.split()]
    return bool(words) and all(is_zero(word) for word in words)


def checked_document(root: Element) -> Element:
    """The root element of a reduced document, which can be read.

    Raises:
        MissingKey, BadShape, NotFinite, DuplicateName, BadInput: an element that cannot be used, with its place.
    """
    for kind in ("link", "joint"):
        _check_names(root, kind)
        for element in root.findall(kind):
            _check(element, f"{kind} {element.get('name')!r}")
    return root


TURNS = 4.0 * math.pi
"""[rad] No revolute joint turns farther than this from its zero; one that may is continuous."""

UNLIMITED = 720.0
"""[rad] Limits above this stand for none: 1000, 9999, 1e16."""


def odd_angles_of(root: Element) -> list[str]:
    """The elements of a checked document whose origins or limits have angles that look like degrees."""
    odd = []
    for limit in root.iterfind("joint[@type='revolute']/limit"):
        ends = [abs(number(limit, end, 0.0)) for end in ("lower", "upper")]
        if TURNS < max(ends) <= UNLIMITED:
            odd.append(f"joint {limit.getparent().get('name')!r} has a limit of {max(ends):g} rad")
    for origin in root.iter("origin"):
        owner = origin.getparent()
        if owner.tag != "joint":
            owner = owner.getparent()
        what = f"an origin of {owner.tag} {owner.get('name')!r}"
        odd += odd_angles(what, numbers(origin, "rpy", (0.0,)))
    return odd


def pose_of(element: Element) -> np.ndarray:
    """The (4, 4) pose [m] of an element in what it belongs to, by its `<origin>`; the identity without one."""
    origin = element.find("origin")
    if origin is None:
        return np.eye(4)
    xyz = numbers(origin, "xyz", (0.0, 0.0, 0.0))
    quaternion = numbers(origin, "quat_xyzw")
    if not quaternion:
        return pose_from_rpy(xyz, numbers(origin, "rpy", (0.0, 0.0, 0.0)))
    unit, _ = of_unit_length(np.array([quaternion]))
    return pose_from_quaternion(xyz, unit[0])


def number(element: Element, attribute: str, default: float) -> float:
    """The number in an attribute of a checked document."""
    (value,) = numbers(element, attribute, (default,))
    return value


def numbers(element: Element, attribute: str, default: tuple[float, ...] = ()) -> tuple[float, ...]:
    """The numbers in an attribute of a checked document."""
    text = element.get(attribute)
    return default if text is None else tuple(map(float, text.split()))


def dimensions_of(primitive: Element) -> dict[str, float | tuple[float, ...]]:
    """The dimensions of a shape of the table, by name, in a checked document."""
    given = {key: numbers(primitive, key) for key in SHAPES[primitive.tag].dimensions}
    return {key: values[0] if len(values) == 1 else values for key, values in given.items()}


def _check_names(root: Element, kind: str) -> None:
    names = [element.get("name") for element in root.findall(kind)]
    for i, name in enumerate(names):
        if not name:
            raise MissingKey(f"<{kind}> has no name", where=f"{kind}[{i}]")
    require_own_names(kind, names)


def _check(element: Element, where: str) -> None:
    for attribute in _REQUIRED.get(element.tag, ()):
        if not element.get(attribute):
            raise MissingKey(f"<{element.tag}> has no {attribute}", where=where)
    if element.tag == "mesh":
        with at(where):
            checked_name(element.get("filename"))
    for attribute, counts in _NUMBERS.get(element.tag, {}).items():
        _check_numbers(element, attribute, counts, where)
    if element.tag == "geometry":
        _check_geometry(element, where)
    if element.tag in ("collision", "visual") and element.find("geometry") is None:
        raise MissingKey(f"<{element.tag}> has no <geometry>", where=where)
    for end in ("parent", "child") if element.tag == "joint" else ():
        if len(found := element.findall(end)) != 1:
            raise MissingKey(f"<joint> has {len(found)} <{end}>", where=where, valid="one")
    if element.tag == "origin" and element.get("quat_xyzw") is not None:
        _check_quaternion(element, where)
    counted: dict[str, int] = {}
    for child in element:
        i = counted.get(child.tag, 0)
        counted[child.tag] = i + 1
        if i and child.tag == "geometry":
            raise BadRobot(f"<{element.tag}> has two <geometry>", where=where, valid="one")
        if i and child.tag in _SINGLE and child.attrib != element.find(child.tag).attrib:
            raise BadRobot(f"<{element.tag}> has two <{child.tag}>", where=where, valid="one")
        listed = child.tag in ("collision", "visual")
        _check(child, f"{where} {child.tag}[{i}]" if listed else f"{where} {child.tag}")


def _check_numbers(element: Element, attribute: str, counts: tuple[int, ...], where: str) -> None:
    given = element.get(attribute)
    if given is None:
        return
    text = given.replace(",", " ")
    with at(where):
        finite_numbers(text, f"{attribute}={given!r:.60} is given", counts)
    element.set(attribute, text)


def _check_quaternion(origin: Element, where: str) -> None:
    """Source: urdfdom 5.1, README, "URDF Versioning"."""
    if origin.get("rpy") is not None:
        raise BadRobot("rpy= and quat_xyzw= are given", where=where, valid="one of them")
    if origin.getroottree().getroot().get("version") not in QUATERNION_VERSIONS:
        valid = '<robot version="1.1">, as parsers ignore it in 1.0'
        raise BadRobot("quat_xyzw= is given", where=where, valid=valid)
    with at(where):
        pose_of(origin.getparent())


def _check_geometry(element: Element, where: str) -> None:
    shapes = [str(child.tag) for child in element]
    if len(shapes) != 1 or shapes[0] not in _SHAPES:
        given = ", ".join(f"<{shape}>" for shape in shapes) or "nothing"
        raise BadRobot(f"{given} is given", where=where, valid=f"one of {', '.join(_SHAPES)}")
