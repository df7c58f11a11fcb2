"""A COLLADA `<geometry>` to triangles in its own coordinates: sources, accessors and primitives.

Everything is read as the accessor says (offset, stride, named params), in double precision, and every
count that the file states is held against what it holds. Not for: where a geometry is placed (`collada_file`).
Source: Khronos, COLLADA 1.4.1, chapter 5 (`accessor`, `float_array`, `polygons`, `tristrips`, …).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from clearance.errors import BadSyntax, MissingKey, at
from clearance.formats.mesh.polygon_cut import cut_rings, fan, strip
from clearance.formats.mesh.triangles import Triangles, checked, refuse_missing_corners
from clearance.formats.text.numbers import floats, integers

if TYPE_CHECKING:
    from lxml.etree import _Element as Element

_SURFACES = ("triangles", "polylist", "polygons", "tristrips", "trifans")
LINES = ("lines", "linestrips", "spline")
_NO_SURFACE = ("asset", "source", "vertices", "extra", *LINES)


class ElementsById:
    """The elements of a document by kind and id; a reference must lead to exactly one."""

    def __init__(self, root: Element) -> None:
        self._found: dict[tuple[str, str], list[Element]] = {}
        for element in root.iter("{*}*"):
            if (key := element.get("id")) is not None:
                self._found.setdefault((local_name(element), key), []).append(element)

    def one(self, kind: str, reference: str | None) -> Element:
        """The element that `#id` refers to.

        Raises:
            BadSyntax: there is none, it is in another file, or there are several.
        """
        found = self._found.get((kind, (reference or "")[1:]), [])
        if reference is None or not found or not reference.startswith("#"):
            raise BadSyntax(
                f"there is no <{kind}> {reference!r:.60}", valid="'#' and an id in this file"
            )
        if len(found) > 1:
            raise BadSyntax(f"{len(found)} <{kind}> elements have the id {reference[1:]!r:.60}")
        return found[0]


def local_name(element: Element) -> str:
    """The element's tag without its namespace."""
    return element.tag.rpartition("}")[2]


def words_of(element: Element) -> list[str]:
    """The words in an element that holds text alone.

    Raises:
        BadSyntax: it holds other elements.
    """
    if len(element):
        raise BadSyntax(
            f"<{local_name(element)}> holds <{local_name(element[0])}>", valid="numbers"
        )
    return (element.text or "").split()


def whole_number(element: Element, key: str, default: int | None = None) -> int:
    """The value of an attribute that is a number of things.

    Raises:
        MissingKey: it is not there and has no default. BadSyntax: it is no such number.
    """
    text = element.get(key)
    if text is None:
        if default is None:
            raise MissingKey(f"<{local_name(element)}> has no attribute {key!r}")
        return default
    value = int(integers([text])[0])
    if value < 0:
        raise BadSyntax(f"{key} {value} of <{local_name(element)}>", valid="0 or more")
    return value


def geometry_pieces(geometry: Element, ids: ElementsById) -> list[Triangles]:
    """The triangles of each primitive of a `<geometry>`, in the file's order; lines and splines have none.

    Raises:
        BadSyntax, MissingKey, BadPolygon, NotFinite: with the geometry's id.
    """
    with at(f"geometry {geometry.get('id', '')!r}"):
        pieces = []
        for child in geometry.iterfind("{*}*"):
            if local_name(child) == "mesh":
                pieces += [
                    _piece(item, ids) for item in child.iterfind("{*}*") if _has_surface(item)
                ]
            elif local_name(child) not in ("asset", "spline", "extra"):
                raise BadSyntax(f"<{local_name(child)}> is not supported", valid="<mesh>")
        return [piece for piece in pieces if len(piece.corners)]


def _has_surface(item: Element) -> bool:
    kind = local_name(item)
    if kind not in _SURFACES and kind not in _NO_SURFACE:
        raise BadSyntax(f"<{kind}> is not supported", valid=", ".join(_SURFACES))
    return kind in _SURFACES


def _piece(primitive: Element, ids: ElementsById) -> Triangles:
    kind = local_name(primitive)
    with at(f"<{kind}>"):
        if primitive.find("{*}ph") is not None:
            raise BadSyntax(
                "polygons with holes (<ph>) are not supported", valid="export triangles"
            )
        offset, n_inputs, vertices = _inputs(primitive, ids)
        points = _positions(vertices, ids)
        rings = [_corners(p, offset, n_inputs) for p in primitive.iterfind("{*}p")]
        if not rings:
            if whole_number(primitive, "count", 0):
                raise MissingKey("there is no <p>", valid="the indices of its corners")
            return Triangles(points, np.empty((0, 3), dtype=np.int64))
        flat = np.concatenate(rings)
        refuse_missing_corners(flat, len(points))
        if len(flat):
            checked(Triangles(points, np.repeat(flat, 3)))
        return Triangles(points, _cut(primitive, rings, points))


def _inputs(primitive: Element, ids: ElementsById) -> tuple[int, int, Element]:
    """Where the vertex stands among the indices of a corner, how many these are, and `<vertices>`."""
    inputs = primitive.findall("{*}input")
    vertex = [item for item in inputs if item.get("semantic") == "VERTEX"]
    if len(vertex) != 1:
        raise BadSyntax(f"{len(vertex)} inputs are VERTEX", valid="one")
    offsets = [whole_number(item, "offset") for item in inputs]
    return (
        whole_number(vertex[0], "offset"),
        max(offsets) + 1,
        ids.one("vertices", vertex[0].get("source")),
    )


def _corners(p: Element, offset: int, n_inputs: int) -> np.ndarray:
    indices = integers(words_of(p))
    if len(indices) % n_inputs:
        raise BadSyntax(f"{len(indices)} indices", valid=f"{n_inputs} for each corner")
    return indices[offset::n_inputs]


def _positions(vertices: Element, ids: ElementsById) -> np.ndarray:
    """(n, 3) the positions of `<vertices>`."""
    inputs = [item for item in vertices.iterfind("{*}input") if item.get("semantic") == "POSITION"]
    if len(inputs) != 1:
        raise BadSyntax(f"{len(inputs)} inputs of <vertices> are POSITION", valid="one")
    source = ids.one("source", inputs[0].get("source"))
    accessor = source.find("{*}technique_common/{*}accessor")
    if accessor is None:
        raise MissingKey(f"source {source.get('id')!r} has no <accessor>")
    with at(f"source {source.get('id')!r}"):
        return _accessed(accessor, _array(ids.one("float_array", accessor.get("source"))))


def _array(element: Element) -> np.ndarray:
    values = floats(words_of(element))
    if whole_number(element, "count", len(values)) != len(values):
        raise BadSyntax(f"{len(values)} numbers, and its count is {element.get('count')}")
    return values


def _accessed(accessor: Element, values: np.ndarray) -> np.ndarray:
    """(n, 3) what the accessor takes out of the array: from `offset` on, `stride` numbers a point."""
    columns = _columns(accessor)
    count, stride = whole_number(accessor, "count"), whole_number(accessor, "stride", 1)
    offset = whole_number(accessor, "offset", 0)
    if not count:
        return np.empty((0, 3))
    if max(columns) >= stride:
        raise BadSyntax(f"stride {stride} is less than its {max(columns) + 1} params")
    last = offset + (count - 1) * stride + max(columns)
    if last >= len(values):
        raise BadSyntax(f"the accessor reads number {last} of an array of {len(values)}")
    at_point = offset + stride * np.arange(count)
    return values[at_point[:, None] + np.array(columns)]


def _columns(accessor: Element) -> list[int]:
    """Which of a point's numbers are x, y and z."""
    names = [param.get("name") for param in accessor.iterfind("{*}param")]
    upper = [(name or "").upper() for name in names]
    if sorted(name for name in upper if name in ("X", "Y", "Z")) == ["X", "Y", "Z"]:
        return [upper.index(name) for name in "XYZ"]
    if len(names) in (0, 3) and not any(names):
        return [0, 1, 2]
    raise BadSyntax(
        f"positions have the params {', '.join(map(str, names))!r:.60}", valid="X, Y, Z"
    )


def _cut(primitive: Element, rings: list[np.ndarray], points: np.ndarray) -> np.ndarray:
    """(m, 3) the triangles of a primitive; a ring is a polygon, strip or fan, or some of the other primitives."""
    kind, corners = local_name(primitive), np.concatenate(rings)
    if kind == "polylist":
        return _polylist(primitive, corners, points)
    _refuse_count(primitive, len(corners) / 3 if kind == "triangles" else len(rings))
    if kind == "triangles":
        return corners.reshape(-1, 3)
    if kind == "polygons":
        return cut_rings(points, corners, np.array([len(ring) for ring in rings]))
    return np.concatenate([(strip if kind == "tristrips" else fan)(ring) for ring in rings])


def _polylist(primitive: Element, corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    vcount = primitive.find("{*}vcount")
    counts = integers(words_of(vcount)) if vcount is not None else np.empty(0, dtype=np.int64)
    if (counts < 0).any() or sum(counts.tolist()) != len(corners):
        raise BadSyntax(f"polygons name {sum(counts.tolist())} corners, {len(corners)} are given")
    _refuse_count(primitive, len(counts))
    return cut_rings(points, corners, counts)


def _refuse_count(primitive: Element, n_held: float) -> None:
    stated = whole_number(primitive, "count", int(n_held))
    if stated != n_held:
        raise BadSyntax(f"its count is {stated}, and it holds {n_held:g}")
