"""COLLADA (.dae) to triangles in metres with z up, as the file's own `<unit>` and `<up_axis>` say.

Own code, because the usual readers keep single precision, turn NaN into 0, pass over accessors' offset and
stride, wrap indices that are too large, take `0,01` for a unit of 1, and leave unit and up axis to the caller
(NOTES.md). RViz and MoveIt obey `<unit>` but not `<up_axis>`: the caller says which way is taken, and a file
that the two take differently is noted. Not for: what is in a geometry (`collada_geometry`). Source: Khronos,
COLLADA 1.4.1, chapters 4 (transforms are post-multiplied in their order) and 5 (`up_axis`, `unit`, `node`,
`instance_node`, `instance_geometry`).
"""

from __future__ import annotations

from collections.abc import Hashable, Iterator
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadDimension, BadSyntax, NotFinite, at
from clearance.formats.mesh.collada_geometry import (
    LINES,
    ElementsById,
    geometry_pieces,
    local_name,
    words_of,
)
from clearance.formats.mesh.placing import MOST_COPIED_NODES, Z_FROM_Y_UP, CopyCount, joined, placed
from clearance.formats.mesh.triangles import MeshRequest, Triangles, UpAxis, on_lines
from clearance.formats.text.numbers import floats
from clearance.formats.text.xml_document import root_of

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_IRRELEVANT = (
    "library_images", "library_effects", "library_materials", "library_animations",
    "library_animation_clips", "library_lights", "library_cameras", "library_physics_scenes",
    "library_physics_models", "library_physics_materials", "instance_physics_scene",
    "bind_material", "instance_camera", "instance_light", "extra",
)  # fmt: skip

_Z_FROM = {
    "X_UP": np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]),
    "Y_UP": Z_FROM_Y_UP,
    "Z_UP": np.eye(3),
}


def read_collada(asked: MeshRequest) -> Triangles:
    """All geometry that the document's scene places, in metres, z up.

    Raises:
        BadSyntax: not COLLADA, or something in it that is not supported. MissingKey: what an element must
        have. BadDimension: the unit. EmptyMesh, BadPolygon, NotFinite.
    """
    root = _geometry_only(asked.data)
    metres, up = _unit(root), _up(root)
    _refuse_other_units(root, metres, up)
    scene = _Scene(root)
    made = _in_metres_z_up(joined(scene.pieces()), metres, up, asked.up_axis)
    return made._replace(notes=(*made.notes, *on_lines(scene.n_lines)))


def _geometry_only(data: bytes) -> Element:
    """The document without what has no shape, so that a missing texture is no fault."""
    if b"<!ENTITY" in data.replace(b"\0", b""):  # a few lines of them make gigabytes of text
        raise BadSyntax("the document declares entities", valid="a document without <!ENTITY>")
    root = root_of(data, "a COLLADA file", is_huge=True)
    if local_name(root) != "COLLADA":
        raise BadSyntax(f"the root element is <{local_name(root)}>", valid="<COLLADA>")
    for element in list(root.iter(*(f"{{*}}{name}" for name in _IRRELEVANT))):
        if element.getparent() is not None:
            element.getparent().remove(element)
    return root


def _unit(root: Element) -> float:
    """[m] the document's unit; a metre where it names none."""
    unit = root.find("{*}asset/{*}unit")
    return 1.0 if unit is None else _metres(unit)


def _metres(unit: Element) -> float:
    text = unit.get("meter")
    if text is None and (unit.get("name") or "meter").lower() in (
        "meter",
        "metre",
        "meters",
        "metres",
        "m",
    ):
        return 1.0
    try:
        metres = float(floats([text or ""])[0])
    except BadSyntax:
        metres = np.nan
    if not (np.isfinite(metres) and metres > 0):
        given = f"meter={text!r:.40}" if text is not None else f"name={unit.get('name')!r:.40}"
        raise BadDimension(
            f"<unit {given}> is given", valid='meter="…", a positive number of metres'
        )
    return metres


def _up(root: Element) -> str:
    """The axis that is up; the specification's default is y."""
    element = root.find("{*}asset/{*}up_axis")
    return "Y_UP" if element is None else _axis(element)


def _axis(element: Element) -> str:
    up = " ".join(words_of(element))
    if up not in _Z_FROM:
        raise BadSyntax(f"<up_axis> is {up!r:.40}", valid=", ".join(_Z_FROM))
    return up


def _refuse_other_units(root: Element, metres: float, up: str) -> None:
    """Refuses a part of the document that has a unit or up axis of its own."""
    for unit in root.iterfind(".//{*}asset/{*}unit"):
        if _metres(unit) != metres:
            raise BadSyntax(
                f"units of {metres:g} and {_metres(unit):g} m", valid="one unit in a file"
            )
    for element in root.iterfind(".//{*}asset/{*}up_axis"):
        if _axis(element) != up:
            raise BadSyntax(f"both {up} and {_axis(element)}", valid="one <up_axis> in a file")


def _in_metres_z_up(triangles: Triangles, metres: float, up: str, up_axis: UpAxis) -> Triangles:
    notes = [f"scaled by {metres:g}, as its <unit> says"] if metres != 1.0 else []
    if up != "Z_UP":
        notes.append(_axis_note(up, up_axis))
    turn = _Z_FROM[up] if up_axis == "file" else np.eye(3)
    with np.errstate(all="ignore"):  # what overflows is refused when the whole is checked
        return Triangles((triangles.vertices @ turn.T) * metres, triangles.corners, tuple(notes))


def _axis_note(up: str, up_axis: UpAxis) -> str:
    if up_axis == "ros":
        return f"not turned from {up} to z up: its <up_axis> is ignored, as RViz and MoveIt do"
    return f"turned from {up} to z up, as its <up_axis> says (RViz and MoveIt do not turn it)"


_DEEPEST = 100
"""Nodes below nodes; scenes of real robots have at most a dozen levels."""


class _Scene:
    """Walks the nodes of the document's scene; each geometry is made once."""

    def __init__(self, root: Element) -> None:
        self.root = root
        self.ids = ElementsById(root)
        self.n_lines = 0
        self._made: dict[Element, list[Triangles]] = {}
        self._visits = CopyCount(MOST_COPIED_NODES, "nodes")

    def pieces(self) -> Iterator[tuple[Hashable, Triangles]]:
        """Each placed piece, in the scene's order, with what it is a copy of.

        Raises:
            BadSyntax: an element that is not supported or not there, or nodes that place each other without end.
            BadDimension, NotFinite: a transform.
        """
        for instance in self.root.iterfind("{*}scene/{*}instance_visual_scene"):
            scene = self.ids.one("visual_scene", instance.get("url"))
            for node in scene.iterfind("{*}node"):
                yield from self._below(node, np.eye(4), 0)

    def _below(
        self, node: Element, world_from_parent: np.ndarray, depth: int
    ) -> Iterator[tuple[Hashable, Triangles]]:
        self._visits.count(node)
        if depth > _DEEPEST:
            raise BadSyntax(f"nodes are nested more than {_DEEPEST} deep, or place themselves")
        world_from_node = world_from_parent
        for child in node.iterfind("{*}*"):
            if local_name(child) not in _CHILDREN:
                world_from_node = world_from_node @ _matrix(child)
        for child in node.iterfind("{*}*"):
            kind = local_name(child)
            if kind == "instance_geometry":
                yield from self._geometry(child, world_from_node)
            elif kind == "node":
                yield from self._below(child, world_from_node, depth + 1)
            elif kind == "instance_node":
                yield from self._below(
                    self.ids.one("node", child.get("url")), world_from_node, depth + 1
                )
            elif kind == "instance_controller":
                raise BadSyntax(
                    "skinned geometry is not supported",
                    valid="export the mesh without its armature",
                )

    def _geometry(
        self, instance: Element, world_from_node: np.ndarray
    ) -> Iterator[tuple[Hashable, Triangles]]:
        geometry = self.ids.one("geometry", instance.get("url"))
        if geometry not in self._made:
            self._made[geometry] = geometry_pieces(geometry, self.ids)
            self.n_lines += sum(local_name(one) in LINES for one in geometry.iter("{*}*"))
        for i, piece in enumerate(self._made[geometry]):
            yield (geometry, i), placed(piece, world_from_node)


_CHILDREN = ("asset", "node", "instance_geometry", "instance_node", "instance_controller")


def _matrix(transform: Element) -> np.ndarray:
    """(4, 4) one transform of a node."""
    kind = local_name(transform)
    if kind not in _TRANSFORMS:
        raise BadSyntax(f"<{kind}> in a <node> is not supported", valid=", ".join(_TRANSFORMS))
    n_numbers, make = _TRANSFORMS[kind]
    with at(f"<{kind}>"):
        values = floats(words_of(transform))
        if len(values) != n_numbers:
            raise BadSyntax(f"{len(values)} numbers", valid=f"{n_numbers}")
        if not np.isfinite(values).all():
            raise NotFinite("a number that is not finite")
        return make(values)


def _whole(values: np.ndarray) -> np.ndarray:
    matrix = values.reshape(4, 4)
    if matrix[3].tolist() != [0, 0, 0, 1]:
        raise BadSyntax(f"the last row is {matrix[3].tolist()}", valid="0 0 0 1")
    return matrix


def _translation(values: np.ndarray) -> np.ndarray:
    matrix = np.eye(4)
    matrix[:3, 3] = values
    return matrix


def _rotation(values: np.ndarray) -> np.ndarray:
    """(4, 4) rotation; multiples of 90 degrees are exact. Source: Rodrigues' formula."""
    axis, degrees = values[:3], values[3]
    with np.errstate(over="ignore"):  # an infinite length is refused
        length = np.linalg.norm(axis)
    if not (length and np.isfinite(length)):
        raise BadDimension(f"the axis is {axis.tolist()}", valid="a direction")
    x, y, z = axis / length
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    quarters = degrees / 90.0
    if quarters == round(quarters):
        cosine, sine = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][round(quarters) % 4]
    else:
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    matrix = np.eye(4)
    matrix[:3, :3] += sine * cross + (1 - cosine) * (cross @ cross)
    return matrix


_TRANSFORMS = {
    "matrix": (16, _whole),
    "translate": (3, _translation),
    "scale": (3, lambda values: np.diag([*values, 1.0])),
    "rotate": (4, _rotation),
}
