"""The shapes of a URDF's links, those of the table of shapes and mesh files, in the link's frame; and which way is
up in COLLADA and GLB files that lie otherwise than all else says.

RViz and MoveIt ignore `<up_axis>` and leave GLB as it lies. Some robots are drawn for programs that turn both, and
both ways look right alone. Where a link has a visual and a collision shape, their boxes decide. If both turn
together, the link's joints do, which are at its shape one way and away from it the other. Files whose tag is
`Z_UP` are left alone. Not for: which links and joints there are (`robot`).
"""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from clearance.errors import ClearanceError
from clearance.formats.files.found_files import FoundFiles
from clearance.formats.mesh.triangles import UpAxis
from clearance.formats.mesh_store import MeshStore, Scale
from clearance.formats.plausibility import scale_notices
from clearance.formats.robot.request import RobotRequest
from clearance.formats.robot.shape_kinds import chosen_kind
from clearance.formats.robot.urdf.elements import dimensions_of, numbers, pose_of
from clearance.formats.text.notes import counted, grouped, short
from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes import SHAPES
from clearance.world.body import Body
from clearance.world.notice import Notice, Severity, listed
from clearance.world.robot import Joint

if TYPE_CHECKING:
    from lxml.etree import _Element as Element


class ShapeReader:
    """Makes shapes from elements, and keeps what is to be reported of their files.

    Args:
        largest: [bytes] files above it are not read for a box alone.
    """

    def __init__(self, request: RobotRequest, meshes: MeshStore, largest: float = math.inf) -> None:
        self.request = request
        self.meshes = meshes
        self.largest = largest
        self._notes: list[tuple[str, str]] = []
        self._scales: dict[str, Scale] = {}
        self._found = FoundFiles(meshes.files, request.package_dirs)

    @property
    def other_axis(self) -> UpAxis:
        """The reading of COLLADA and GLB that is not asked for."""
        return "file" if self.request.collada_up_axis == "ros" else "ros"

    def kind(self, link: Element) -> str:
        """Which elements of a link are its shape."""
        has = frozenset(() if link.find("collision") is None else ("collision",))
        return chosen_kind(has, self.request.geometry)

    def shape(self, element: Element) -> tuple[Polyhedron, str]:
        """The shape of a collision or visual element in its link's frame, and what it was made from."""
        given = element.find("geometry")[0]
        if given.tag == "mesh":
            shape, origin = self._mesh(given)
        else:
            shape, origin = SHAPES[given.tag].maker(**dimensions_of(given)), given.tag
        moved = element.find("origin") is not None
        return (shape.transformed(pose_of(element)) if moved else shape), origin

    def box(self, element: Element, way: UpAxis, *, loosely: bool = False) -> np.ndarray:
        """(2, 3) [m] the box round a collision or visual element in its link's frame.

        Args:
            way: which way is up in COLLADA and GLB.
            loosely: it may be larger, for points that no face uses, and is found faster.

        Raises:
            BadInput: it cannot be read, or is a larger file than asked for.
        """
        mesh = element.find("geometry/mesh")
        if mesh is None:
            return self.shape(element)[0].bounds
        path, scale = self.mesh_file(mesh)
        pose = pose_of(element)
        points = self.meshes.points(path, scale, way, self.largest, loosely=loosely)
        points = points @ pose[:3, :3].T + pose[:3, 3]
        return np.array([points.min(axis=0), points.max(axis=0)])

    def mesh_file(self, mesh: Element) -> tuple[Path, Scale]:
        """Where a mesh element's file lies, and its scale."""
        path = self._found.mesh(mesh.get("filename"), self.request.path.parent)
        scale = tuple(np.broadcast_to(numbers(mesh, "scale", (1.0,)), 3).tolist())
        self._scales[short(self.meshes.files.shown(path))] = scale
        return path, scale

    def notes(self) -> list[str]:
        """What was mended in the files, a line for each kind of fault."""
        return [*grouped(self._notes), *self._found.notes()]

    def notices(self) -> list[Notice]:
        """Files that stand in for others, and scales that look like another unit."""
        return [*self._found.notices(), *scale_notices(list(self._scales.items()))]

    def _mesh(self, element: Element) -> tuple[Polyhedron, str]:
        path, scale = self.mesh_file(element)
        mesh = self.meshes.load(path, scale, self.request.collada_up_axis)
        shown = self.meshes.files.shown(path)
        self._notes += [(shown, note) for note in mesh.notes]
        return mesh.shape, shown


APART = 0.25
"""[-] Boxes whose sides are farther apart than this part of the link's length lie otherwise."""

ALIKE = 0.02
"""[-] Boxes whose sides are no farther apart than this part of the link's length lie alike."""

_UP = re.compile(rb"up_axis\s*>\s*Z_UP")


def axis_notices(
    links: Sequence[Element], bodies: Sequence[Body], joints: Sequence[Joint], reader: ShapeReader
) -> list[Notice]:
    """A suspect notice that names the links that fit only the other way, if there are more than fit only this way.

    Args:
        joints: of the robot; the origins of those below a link are points of it.
    """
    boxes = {body.name: body.shape.bounds for body in bodies}
    below: dict[str, list[np.ndarray]] = {}
    for joint in joints:
        below.setdefault(joint.parent, []).append(joint.parent_from_joint[:3, 3])
    by_picture, by_joints, against = [], [], []
    for link in links:
        name = link.get("name")
        if name not in boxes or not _has_tag(link, reader):
            continue
        turn = _Turn(boxes[name], _bounds(link, reader.kind(link), reader, reader.other_axis))
        if turn.is_the_same:
            continue
        points = np.array([np.zeros(3), *below.get(name, [])])
        if _picture_agrees_only_otherwise(link, turn, reader):
            by_picture.append(repr(name))
        elif turn.is_away(turn.chosen, points) and not turn.is_away(turn.other, points):
            by_joints.append(repr(name))
        elif turn.is_away(turn.other, points) and not turn.is_away(turn.chosen, points):
            against.append(repr(name))
    notices = []
    if by_picture:
        notices.append(
            _notice(by_picture, "visual and collision shapes", "apart", "together", reader)
        )
    if len(by_joints) > len(against):
        notices.append(_notice(by_joints, "shapes", "away from their joints", "at them", reader))
    return notices


class _Turn(NamedTuple):
    """The box of a link's shape as it is, and as it were the other way; (2, 3) [m] in the link's frame."""

    chosen: np.ndarray
    other: np.ndarray

    @property
    def is_the_same(self) -> bool:
        """True for a link that lies alike either way."""
        return float(np.abs(self.chosen - self.other).max()) <= ALIKE * self._length

    def agrees(self, a: np.ndarray, b: np.ndarray) -> bool:
        """True for two boxes whose sides are near each other for a link of this size."""
        return float(np.abs(a - b).max()) <= APART * self._length

    def is_away(self, box: np.ndarray, points: np.ndarray) -> bool:
        """True if one of the points is far from the box for a link of this size."""
        return (
            float(np.linalg.norm(points - np.clip(points, *box), axis=1).max())
            > APART * self._length
        )

    @property
    def _length(self) -> float:
        return float(np.ptp(self.chosen, axis=0).max())


def _notice(odd: list[str], what: str, so: str, otherwise: str, reader: ShapeReader) -> Notice:
    text = (
        f"CHECK AXES: the {what} of {counted(len(odd), 'link')} lie {so} with robot: {{collada_up_axis: "
        f"{reader.request.collada_up_axis}}} and {otherwise} with {reader.other_axis}: {listed(odd, 6)}"
    )
    return Notice(Severity.SUSPECT, "axis", text)


def _has_tag(link: Element, reader: ShapeReader) -> bool:
    """True if a file that is measured lies otherwise by its tag."""
    return any(
        _is_tagged(mesh, reader) for mesh in link.iterfind(f"{reader.kind(link)}/geometry/mesh")
    )


def _is_tagged(mesh: Element, reader: ShapeReader) -> bool:
    name = mesh.get("filename").lower()
    if not name.endswith(".dae"):
        return name.endswith(".glb")
    path, _ = reader.mesh_file(mesh)
    return _UP.search(reader.meshes.files.read(path)) is None


def _picture_agrees_only_otherwise(link: Element, turn: _Turn, reader: ShapeReader) -> bool:
    """True if the shape that is not measured lies with the measured one only the other way."""
    kind = "visual" if reader.kind(link) == "collision" else "collision"
    if link.find(kind) is None:
        return False
    try:
        if turn.agrees(turn.chosen, _bounds(link, kind, reader, reader.request.collada_up_axis)):
            return False
        return turn.agrees(turn.other, _bounds(link, kind, reader, reader.other_axis))
    except ClearanceError:  # a picture that cannot be read is no reason to stop
        return False


def _bounds(link: Element, kind: str, reader: ShapeReader, way: UpAxis) -> np.ndarray:
    """(2, 3) [m] the box of all of a link's elements of a kind, in its frame."""
    boxes = np.array([reader.box(element, way) for element in link.iterfind(kind)])
    return np.array([boxes[:, 0].min(axis=0), boxes[:, 1].max(axis=0)])
