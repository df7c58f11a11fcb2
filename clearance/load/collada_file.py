"""COLLADA (.dae) to triangles in metres with z up, as the file's own `<unit>` and `<up_axis>` say.

pycollada reads the document. It, and every reader on top of it, keeps single precision, turns NaN
into 0, leaves unit and up axis to the caller and cuts polygons as fans: positions and transforms
are therefore read again from the document in double precision, and the rest is done here, once.
RViz and MoveIt obey `<unit>` but not `<up_axis>`: the caller says which way is taken, and a file
that the two take differently is noted. Source: Khronos,
COLLADA 1.4.1 specification, chapters 5 (`up_axis`, `unit`, `instance_geometry`) and 4
(post-multiplied transforms).
"""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import TYPE_CHECKING, Literal

import numpy as np

from clearance.errors import BadDimension, BadSyntax, ClearanceError, EmptyMesh
from clearance.load.polygon_cut import cut_polygons
from clearance.load.triangles import Triangles, checked

if TYPE_CHECKING:
    import collada

_IRRELEVANT = (
    "library_images", "library_effects", "library_materials", "library_animations",
    "library_animation_clips", "library_lights", "library_cameras", "library_physics_scenes",
    "library_physics_models", "library_physics_materials", "instance_physics_scene",
    "bind_material", "instance_camera", "instance_light", "extra",
)  # fmt: skip

Z_FROM_Y_UP = np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
"""(3, 3) turns y up, z towards the viewer into z up, -y towards the viewer; x stays."""

UpAxis = Literal["file", "ros"]
"""What becomes of `<up_axis>`: "file" turns as it says, "ros" ignores it as RViz and MoveIt do."""

_Z_FROM = {
    "X_UP": np.array([[0.0, -1, 0], [0, 0, -1], [1, 0, 0]]),
    "Y_UP": Z_FROM_Y_UP,
    "Z_UP": np.eye(3),
}


def read_collada(data: bytes, up_axis: UpAxis = "file") -> Triangles:
    """All geometry that the document's scene places, in metres, z up.

    Args:
        up_axis: "file" turns what `<up_axis>` calls up into z up; "ros" leaves the axes as they are.

    Raises:
        BadSyntax: not COLLADA, or something in it that is not supported. EmptyMesh, BadPolygon,
        NotFinite.
    """
    import collada

    try:
        document = collada.Collada(io.BytesIO(_geometry_only(data)))
        pieces = list(_placed_pieces(document))
    except ClearanceError:
        raise
    except Exception as error:  # pycollada raises whatever its parsing hits
        raise BadSyntax(f"not a COLLADA file that can be read: {_reason(error)}") from None
    if not pieces:
        raise EmptyMesh("the mesh has no faces", valid="a scene that places at least one polygon")
    return _in_metres_z_up(_joined(pieces), document, up_axis)


def _reason(error: Exception) -> str:
    if isinstance(error, RuntimeError) and "reraise" in str(
        error
    ):  # how pycollada refuses an element
        return "it has an element that is not supported"
    return getattr(error, "msg", None) or str(error) or type(error).__name__


def _geometry_only(data: bytes) -> bytes:
    """The document without what has no shape, so that a missing texture is no fault."""
    from lxml import etree

    try:
        parser = etree.XMLParser(remove_comments=True, resolve_entities=False, huge_tree=True)
        root = etree.fromstring(data, parser)
    except etree.XMLSyntaxError as error:
        raise BadSyntax(f"not XML: {error.msg}") from None
    if etree.QName(root).localname != "COLLADA":
        raise BadSyntax(f"the root element is <{etree.QName(root).localname}>", valid="<COLLADA>")
    for element in list(root.iter(*(f"{{*}}{name}" for name in _IRRELEVANT))):
        if element.getparent() is not None:
            element.getparent().remove(element)
    return etree.tostring(root)


def _placed_pieces(document: collada.Collada) -> Iterator[Triangles]:
    for node in document.scene.nodes if document.scene is not None else []:
        yield from _pieces_below(node, np.eye(4))


def _pieces_below(node: object, world_from_parent: np.ndarray) -> Iterator[Triangles]:
    from collada import scene

    if isinstance(node, scene.GeometryNode):
        yield from _geometry_pieces(node.geometry, world_from_parent)
    elif isinstance(node, scene.ControllerNode):
        raise BadSyntax(
            "skinned geometry is not supported", valid="export the mesh without its armature"
        )
    elif isinstance(node, scene.NodeNode):
        yield from _pieces_below(node.node, world_from_parent)
    elif isinstance(node, scene.Node):
        world_from_node = world_from_parent
        for transform in node.transforms:
            world_from_node = world_from_node @ _matrix(transform)
        for child in node.children:
            yield from _pieces_below(child, world_from_node)


def _matrix(transform: collada.scene.Transform) -> np.ndarray:
    """(4, 4) one transform of a node, in double precision."""
    from collada import scene

    values = np.array((transform.xmlnode.text or "").split(), dtype=np.float64)
    matrix = np.eye(4)
    if isinstance(transform, scene.MatrixTransform):
        return values.reshape(4, 4)
    if isinstance(transform, scene.TranslateTransform):
        matrix[:3, 3] = values
    elif isinstance(transform, scene.ScaleTransform):
        matrix[:3, :3] = np.diag(values)
    elif isinstance(transform, scene.RotateTransform):
        matrix[:3, :3] = _rotation(values[:3], values[3])
    else:
        raise BadSyntax(f"transform {type(transform).__name__} is not supported")
    return matrix


def _rotation(axis: np.ndarray, degrees: float) -> np.ndarray:
    """(3, 3) rotation; multiples of 90 degrees are exact. Source: Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    quarters = degrees / 90.0
    if quarters == round(quarters):
        cosine, sine = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)][round(quarters) % 4]
    else:
        cosine, sine = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    return np.eye(3) + sine * cross + (1 - cosine) * (cross @ cross)


def _geometry_pieces(
    geometry: collada.geometry.Geometry, matrix: np.ndarray
) -> Iterator[Triangles]:
    from collada import lineset

    for primitive in geometry.primitives:
        if isinstance(primitive, lineset.LineSet) or not len(primitive):
            continue
        offset, _, _, _, source = primitive.sources["VERTEX"][0]
        vertices = _positions(source) @ matrix[:3, :3].T + matrix[:3, 3]
        index = (
            np.asarray(primitive.index).reshape(-1, primitive.nindices)[:, offset].astype(np.int64)
        )
        corners = _cut(vertices, index, getattr(primitive, "vcounts", None))
        if np.linalg.det(matrix[:3, :3]) < 0:
            corners = corners[:, ::-1]
        yield Triangles(vertices, corners)


def _positions(source: collada.source.FloatSource) -> np.ndarray:
    """(n, 3) the source's numbers, in double precision."""
    text = source.xmlnode.find("{*}float_array").text or ""
    return np.array(text.split(), dtype=np.float64).reshape(-1, len(source.components))[:, :3]


def _cut(vertices: np.ndarray, index: np.ndarray, counts: np.ndarray | None) -> np.ndarray:
    if counts is None:
        counts = np.full(len(index) // 3, 3)
    if counts.sum() != len(index):
        raise BadSyntax(f"polygons name {counts.sum()} corners, {len(index)} are given")
    checked(Triangles(vertices, np.repeat(index, 3)))
    return cut_polygons(vertices, np.split(index, np.cumsum(counts)[:-1]))


def _joined(pieces: list[Triangles]) -> Triangles:
    starts = np.cumsum([0, *(len(piece.vertices) for piece in pieces)])
    return Triangles(
        np.concatenate([piece.vertices for piece in pieces]),
        np.concatenate([p.corners + start for p, start in zip(pieces, starts, strict=False)]),
    )


def _in_metres_z_up(
    triangles: Triangles, document: collada.Collada, up_axis: UpAxis
) -> Triangles:
    unit = document.assetInfo.unitmeter
    metres = 1.0 if unit is None else float(unit)
    if not (np.isfinite(metres) and metres > 0):
        raise BadDimension(f"<unit meter={metres:g}> is given", valid="a positive number of metres")
    up = document.assetInfo.upaxis
    notes = [f"scaled by {metres:g}, as its <unit> says"] if metres != 1.0 else []
    if up != "Z_UP":
        notes.append(_axis_note(up, up_axis))
    turn = _Z_FROM[up] if up_axis == "file" else np.eye(3)
    return Triangles((triangles.vertices @ turn.T) * metres, triangles.corners, tuple(notes))


def _axis_note(up: str, up_axis: UpAxis) -> str:
    if up_axis == "ros":
        return f"not turned from {up} to z up: its <up_axis> is ignored, as RViz and MoveIt do"
    return f"turned from {up} to z up, as its <up_axis> says (RViz and MoveIt do not turn it)"
