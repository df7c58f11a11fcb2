"""The `<geometry>` of an SDF collision to a shape of a YAML scene, by its element: a further shape is a row here.

Not for: where the collision is (`scope`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from clearance.errors import BadDimension, BadScene, at, nearest_name
from clearance.formats.scene.request import mesh_row
from clearance.formats.scene.sdf.document import numbers_of, text_of
from clearance.formats.text.numbers import is_zero
from clearance.geometry.shapes import SHAPES, Measure
from clearance.world.extents import PLANE_SIZE

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_UNREAD = {
    "heightmap": "its surface is a picture",
    "polyline": "its outline may be hollow or cross itself",
    "image": "its boxes are a picture",
    "cone": "it is no polyhedron, and no other round shape",
}
"""What SDF has besides, and why it is refused."""


class Geometry(NamedTuple):
    """A shape.

    Attributes:
        row: the shape's key and content in a YAML scene; a mesh's file as its `<uri>`.
        pose: (4, 4) [m] of the shape in the collision.
    """

    row: dict[str, Any]
    pose: np.ndarray = np.eye(4)


def has_no_size(collision: Element) -> bool:
    """True for a collision without a shape, or with one whose dimensions are all 0.

    One that is flat or a line is left to be refused, since something may come near it.
    """
    geometry = collision.find("geometry")
    if geometry is None or not len(geometry):
        return True
    sizes = () if geometry[0].tag in ("mesh", "plane") else geometry[0]
    words = [word for size in sizes for word in (size.text or "").split()]
    return bool(words) and all(is_zero(word) for word in words)


def geometry_of(collision: Element) -> Geometry | None:
    """The shape of a collision; None for `<empty>`, and for what `has_no_size`.

    Raises:
        BadInput: a shape that is not read, and why; a dimension that no solid has.
    """
    if has_no_size(collision):
        return None
    geometry = collision.find("geometry")
    shapes = [] if geometry is None else [str(child.tag) for child in geometry]
    if geometry is None or len(shapes) != 1:
        given = ", ".join(f"<{shape}>" for shape in shapes) or "nothing"
        raise BadScene(f"{given} is given", where="geometry", valid=_valid())
    (kind,) = shapes
    if kind == "empty":
        return None
    with at(f"<{kind}>"):
        if kind in _UNREAD:
            raise BadScene(f"it is not read: {_UNREAD[kind]}", valid=_valid())
        if kind not in _READERS:
            raise BadScene("it is not read", valid=nearest_name(kind, _READERS))
        return _READERS[kind](geometry[0])


def _valid() -> str:
    return f"one of {', '.join(_READERS)}, or a mesh of the same shape"


def _of_table(element: Element) -> Geometry:
    """A shape whose dimensions are called as in the table of shapes."""
    row: dict[str, Any] = {}
    for key, measure in SHAPES[str(element.tag)].dimensions.items():
        values = list(_lengths(element, key, 3 if measure is Measure.SIZES else 1))
        row[key] = values if measure is Measure.SIZES else values[0]
    return Geometry({str(element.tag): row})


def _plane(element: Element) -> Geometry:
    normal = np.array(numbers_of(element, "normal", 3, "0 0 1"))
    with np.errstate(over="ignore"):
        length = float(np.linalg.norm(normal))
    if not 1e-9 < length < 1e9:
        raise BadDimension(f"<normal> is {normal.tolist()}", valid="a vector that is not zero")
    pose = np.eye(4)
    pose[:3, :3] = _from_z(normal / length)
    pose[:3, 3] = pose[:3, 2] * (-PLANE_SIZE[2] / 2)
    return Geometry({"box": {"size": list(PLANE_SIZE)}}, pose)


def _mesh(element: Element) -> Geometry:
    if element.find("submesh") is not None:
        raise BadScene(
            "a <submesh> is asked for, and files are read whole", valid="a file of it alone"
        )
    uri = text_of(element, "uri")
    scale = list(numbers_of(element, "scale", 3, "1 1 1"))
    if 0.0 in scale:
        raise BadDimension(f"<scale> is {scale}", valid="a scale is not zero")
    return Geometry(mesh_row(uri, scale))


_READERS: dict[str, Callable[[Element], Geometry]] = {
    **dict.fromkeys(("box", "sphere", "cylinder", "capsule", "ellipsoid"), _of_table),
    "plane": _plane,
    "mesh": _mesh,
}


def _lengths(element: Element, tag: str, n: int) -> tuple[float, ...]:
    values = numbers_of(element, tag, n)
    if not all(value > 0.0 for value in values):
        raise BadDimension(f"<{tag}> is {text_of(element, tag):.60}", valid="above 0 m")
    return values


def _from_z(normal: np.ndarray) -> np.ndarray:
    """(3, 3) a rotation that takes the z axis to a unit vector; exact where that is an axis."""
    across = np.eye(3)[int(np.argmin(np.abs(normal)))]
    x = np.cross(across, normal)
    if normal[2] == 1.0:
        return np.eye(3)
    x /= np.linalg.norm(x)
    return np.column_stack([x, np.cross(normal, x), normal])
