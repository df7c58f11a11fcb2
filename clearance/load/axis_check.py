"""COLLADA files in a URDF that lie otherwise than the link's other shape: a sign of which way was meant.

RViz and MoveIt ignore `<up_axis>`, some robots are drawn for programs that obey it, and both look right alone.
Where a link has a visual and a collision shape, their boxes tell. Not for: links with one shape only.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import ClearanceError
from clearance.load.collada_file import UpAxis
from clearance.load.mesh import triangles_from_bytes
from clearance.load.urdf_elements import pose_of
from clearance.load.urdf_shapes import ShapeReader
from clearance.world.body import Body
from clearance.world.notice import Notice, Severity, listed

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

APART = 0.25
"""[-] Boxes whose sides are farther apart than this part of the link's length lie otherwise."""

_UP = re.compile(rb"up_axis\s*>\s*Z_UP")


def axis_notices(links: Sequence[Element], bodies: Sequence[Body], reader: ShapeReader) -> list[Notice]:
    """A suspect notice that names the links whose shapes agree only the other way."""
    chosen = reader.request.collada_up_axis
    shapes = {body.name: body for body in bodies}
    odd = [
        repr(link.get("name"))
        for link in links
        if link.get("name") in shapes
        and _has_tag(link, reader)
        and _agrees_only_otherwise(link, shapes[link.get("name")], reader)
    ]
    if not odd:
        return []
    count = "1 link" if len(odd) == 1 else f"{len(odd)} links"
    other = _other(chosen)
    text = (
        f"CHECK AXES: the visual and collision shapes of {count} lie apart with robot: "
        f"{{collada_up_axis: {chosen}}} and together with {other}: {listed(odd, 6)}"
    )
    return [Notice(Severity.SUSPECT, "axis", text)]


def _other(way: UpAxis) -> UpAxis:
    return "file" if way == "ros" else "ros"


def _has_tag(link: Element, reader: ShapeReader) -> bool:
    """True if a file that is measured lies otherwise by its tag, and there is a shape to hold it against."""
    kind = reader.kind(link)
    if link.find("visual" if kind == "collision" else "collision") is None:
        return False
    return any(_is_tagged(mesh, reader) for mesh in link.iterfind(f"{kind}/geometry/mesh"))


def _is_tagged(mesh: Element, reader: ShapeReader) -> bool:
    if not mesh.get("filename").lower().endswith(".dae"):
        return False
    path, _ = reader.mesh_file(mesh)
    return _UP.search(reader.meshes.files.read(path)) is None


def _agrees_only_otherwise(link: Element, body: Body, reader: ShapeReader) -> bool:
    kind = reader.kind(link)
    chosen = reader.request.collada_up_axis
    compared = "visual" if kind == "collision" else "collision"
    length = float(np.ptp(body.shape.bounds, axis=0).max())
    try:
        if _apart(body.shape.bounds, _bounds(link, compared, reader, chosen)) <= APART * length:
            return False
        otherwise = [_bounds(link, which, reader, _other(chosen)) for which in (kind, compared)]
    except ClearanceError:  # a picture that cannot be read is no reason to stop
        return False
    return _apart(*otherwise) <= APART * length


def _apart(a: np.ndarray, b: np.ndarray) -> float:
    """[m] how far the sides of two boxes are apart at most."""
    return float(np.abs(a - b).max())


def _bounds(link: Element, kind: str, reader: ShapeReader, way: UpAxis) -> np.ndarray:
    """(2, 3) [m] the box of all of a link's elements of a kind, in its frame."""
    points = np.concatenate(list(_points(link, kind, reader, way)))
    return np.array([points.min(axis=0), points.max(axis=0)])


def _points(link: Element, kind: str, reader: ShapeReader, way: UpAxis) -> Iterator[np.ndarray]:
    for element in link.iterfind(kind):
        mesh = element.find("geometry/mesh")
        if mesh is None:
            yield reader.shape(element)[0].vertices
            continue
        path, scale = reader.mesh_file(mesh)
        files = reader.meshes.files
        made = triangles_from_bytes(files.read(path), files.shown(path), way)
        pose = pose_of(element)
        yield (made.vertices[made.corners.ravel()] * scale) @ pose[:3, :3].T + pose[:3, 3]
