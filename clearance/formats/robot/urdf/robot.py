"""URDF to a robot: one body for each link that has a shape.

The document is checked first (`elements`), so that what is read here is there; meshes go through our own
loader (`shapes`). Not for: where the robot stands, or how it moves.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadSyntax, ClearanceError, at
from clearance.formats.files.input_files import InputFiles
from clearance.formats.known_formats import Kind, refuse_foreign
from clearance.formats.mesh_store import MeshStore
from clearance.formats.plausibility import angle_notices
from clearance.formats.robot.compound_joints import frames_between
from clearance.formats.robot.request import RobotRequest
from clearance.formats.robot.shape_kinds import notes_on_bare, refuse_other_geometry, unseen
from clearance.formats.robot.tree import links_from_root
from clearance.formats.robot.urdf.elements import (
    checked_document,
    odd_angles_of,
    reduced_document,
    without_empty_shapes,
)
from clearance.formats.robot.urdf.joints import joints_of
from clearance.formats.robot.urdf.shapes import ShapeReader, axis_notices
from clearance.formats.text.unread import Unread, notes_on, notices_on
from clearance.formats.text.xml_document import ALLOW_XACRO, XACRO
from clearance.geometry.polyhedron import Polyhedron
from clearance.world.body import Body
from clearance.world.extents import greatest, metres
from clearance.world.names import require_own_names
from clearance.world.notice import Notice, Severity, naming, warnings_naming
from clearance.world.robot import Joint, Robot

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


def read_urdf(request: RobotRequest, meshes: MeshStore) -> Robot:
    """The robot in a URDF file: one body for each link that has a shape, in the link's frame.

    Raises:
        BadInput: with the file and the element. NothingToMeasure: no link has a shape of the kind that is
        asked for, though there are others.
    """
    data, made = _document(request, meshes.files)
    with at(meshes.files.shown(request.path)):
        root, others = reduced_document(data)
        empty = without_empty_shapes(root, request.geometry)
        checked_document(root)
        joints, notes = joints_of(root)
        by_name = {link.get("name"): link for link in root.iterfind("link")}
        frames = frames_between(joints)
        require_own_names("link", [*by_name, *frames])
        link_names, ordered = links_from_root((*by_name, *frames), joints)
        links = [by_name[name] for name in link_names if name in by_name]
        kinds = _kinds(links)
        refuse_other_geometry(kinds, request.geometry)
        reader = ShapeReader(request, meshes)
        bodies = [body for link in links if (body := _body(link, reader)) is not None]
        turned = axis_notices(links, bodies, ordered, reader)
        beyond, unread = _on_visuals(links, bodies, ShapeReader(request, meshes, LARGEST))
        notices = [
            *angle_notices(odd_angles_of(root)),
            *reader.notices(),
            *turned,
            *unseen(kinds, request.geometry),
            *(() if turned else beyond),
            *warnings_naming("shapes without a size, not measured", empty),
            *_on_coupled(others, ordered),
            *notices_on(others),
        ]
    said = *notes, *notes_on_bare(kinds), *unread, *notes_on(others), *_on_soft_limits(others)
    notes = [f"{request.path.name}: {note}" for note in said]
    return Robot(
        root.get("name") or "robot",
        link_names,
        ordered,
        tuple(bodies),
        (*made, *reader.notes(), *notes),
        tuple(notices),
    )


BEYOND = 0.06
"""[m] How far a visual shape of this size and more may reach beyond its link's collision shapes. In 145 of 170
files of public robots none reaches farther. In the others, 61 to 614 mm of a link are not measured."""


LARGEST = 10_000_000
"""[bytes] Larger files of visual meshes are not read: 1 MB takes 5 ms (STL) to 20 ms (COLLADA)."""


def _on_visuals(
    links: Sequence[Element], bodies: Sequence[Body], pictures: ShapeReader
) -> tuple[list[Notice], list[str]]:
    """A warning on visual shapes that reach far out of the box round what is measured of their link, and a note on
    links whose visual shapes are not read.

    Args:
        pictures: keeps nothing that is to be told of the files of visual shapes.
    """
    boxes = {body.name: body.shape.bounds for body in bodies}
    far, unread = [], []
    for link in links:
        name = link.get("name")
        if name not in boxes or pictures.kind(link) != "collision":
            continue
        found = [
            _reach_beyond(boxes[name], element, pictures) for element in link.iterfind("visual")
        ]
        unread += [repr(name)] * (None in found)
        beyond = max((one for one in found if one is not None), default=0.0)
        if beyond > BEYOND:
            far.append((beyond, f"link {name!r} by {metres(beyond)} m"))
    text = "visual shapes reach out of the collision shapes, and are not measured there"
    remedy = "add collision shapes, or give robot: {geometry: visual}"
    lines = naming(text, [text for _, text in greatest(far)])
    notices = [Notice(Severity.WARNING, "geometry", f"{line}; {remedy}") for line in lines]
    text = "visual shapes that are not read, nor compared with the collision shapes"
    return notices, naming(text, unread)


def _reach_beyond(box: np.ndarray, visual: Element, pictures: ShapeReader) -> float | None:
    """[m] How far a visual shape reaches out of a box; up to `BEYOND`, a bound of it. None if it is not read.

    A mesh that lies apart because of its `<up_axis>` reaches out less with the other reading, which counts then.
    """
    asked = pictures.request.collada_up_axis
    try:
        reach = _out_of(box, pictures.box(visual, asked, loosely=True))
        if reach > BEYOND:
            ways = (asked, pictures.other_axis)
            reach = min(_out_of(box, pictures.box(visual, way)) for way in ways)
    except ClearanceError:  # a picture that cannot be made is no reason to stop
        return None
    return reach


def _out_of(box: np.ndarray, visual: np.ndarray) -> float:
    """[m] How far a box that is no small one reaches out of another; at least 0."""
    if (visual[1] - visual[0]).max() <= BEYOND:
        return 0.0
    return max(0.0, float((box[0] - visual[0]).max()), float((visual[1] - box[1]).max()))


def _on_coupled(others: Sequence[Unread], joints: Sequence[Joint]) -> list[Notice]:
    """A warning on joints that follow others by ros2_control alone."""
    free = {joint.name for joint in joints if joint.mimic is None}
    coupled = [
        repr(joint.get("name"))
        for one in others
        for joint in one.element.iter("joint")
        if joint.get("name") in free and joint.find("param[@name='mimic']") is not None
    ]
    lines = naming("joints that ros2_control couples to others are free here", coupled)
    remedy = "; <mimic> would couple them"
    return [Notice(Severity.WARNING, "equality", line + remedy) for line in lines]


def _on_soft_limits(others: Sequence[Unread]) -> list[str]:
    """A note on narrower limits that a controller may keep to."""
    soft = {"soft_lower_limit", "soft_upper_limit"}
    limited = [one for one in others if one.name == "<safety_controller>"]
    owners = [one.where for one in limited if not soft.isdisjoint(one.element.attrib)]
    return naming("soft limits are not used", owners)


def _document(request: RobotRequest, files: InputFiles) -> tuple[bytes, tuple[str, ...]]:
    """The URDF in a file, or what xacro makes of it; and notes on that."""
    if request.xacro:
        from clearance.formats.robot.urdf.xacro_file import expanded

        return expanded(request, files)
    data, shown = files.read(request.path), files.shown(request.path)
    refuse_foreign(data, shown, Kind.ROBOT)
    if request.path.suffix.lower() == XACRO:
        raise BadSyntax("this is a xacro file, not a URDF file", where=shown, valid=ALLOW_XACRO)
    return data, ()


def _body(link: Element, reader: ShapeReader) -> Body | None:
    """The shapes of a link as one body in its frame, if it has any."""
    kind = reader.kind(link)
    elements = link.findall(kind)
    if not elements:
        return None
    name = link.get("name")
    shapes, origins = [], []
    for i, element in enumerate(elements):
        with at(f"link {name!r} {kind}[{i}]"):
            shape, origin = reader.shape(element)
        shapes.append(shape)
        origins.append(origin)
    whole = shapes[0] if len(shapes) == 1 else Polyhedron.merged(shapes)
    return Body(name, whole, ", ".join(origins))


def _kinds(links: list[Element]) -> dict[str, frozenset[str]]:
    """Which kinds of shapes each link has."""
    return {
        link.get("name"): frozenset(
            kind for kind in ("collision", "visual") if link.find(kind) is not None
        )
        for link in links
    }
