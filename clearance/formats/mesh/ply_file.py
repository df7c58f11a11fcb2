"""PLY, text and binary of either byte order, to triangles. Strict: all that the header says, and nothing after
it.

Own code, because the usual readers keep what is left of a cut-off text file, cut polygons as fans, and leave
`tristrips` out. Points, faces and strips are read; colours and other elements are passed over. Counts are held
against the file's length before anything is made. Source: G. Turk, The PLY polygon file format, 1994.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.errors import BadSyntax, DuplicateName, EmptyMesh, MissingKey, at
from clearance.formats.mesh.polygon_cut import cut_rings, strip
from clearance.formats.mesh.triangles import (
    MeshRequest,
    Triangles,
    as_points,
    checked,
    refuse_missing_corners,
)
from clearance.formats.text.numbers import floats, integers

_CORNERS = ("vertex_indices", "vertex_index")


def read_ply(asked: MeshRequest) -> Triangles:
    """The faces and strips of a PLY file, polygons cut into triangles, in file order.

    Raises:
        BadSyntax, MissingKey: not PLY, cut off, or longer than its header says. BadPolygon, EmptyMesh, NotFinite.
    """
    elements = elements_of(asked.data)
    points = vertices(elements)
    exact = points.astype(np.float64)
    corners = [cut_rings(exact, *rings) for rings in _rings(elements, "face", points)]
    for flat, counts in _rings(elements, "tristrips", points, ends=True):
        corners += [_strips(ring) for ring in np.split(flat, np.cumsum(counts)[:-1])]
    if not sum(map(len, corners)):
        raise EmptyMesh(
            "the mesh has no faces",
            valid="at least one triangle is needed; a scan is read as points: {file: …, radius: …}",
        )
    return Triangles(points, np.concatenate(corners))


def vertices(elements: dict[str, PlyRows]) -> np.ndarray:
    """(n, 3) the vertices, in the file's unit and, where that is one for all, precision.

    Raises:
        MissingKey: there are none with x, y and z.
    """
    columns = elements["vertex"].columns if "vertex" in elements else {}
    missing = [name for name in "xyz" if name not in columns]
    if missing:
        raise MissingKey(f"the PLY file has no vertex property {missing[0]!r}", valid="x, y, z")
    return as_points([columns[name] for name in "xyz"])


def _rings(elements: dict[str, PlyRows], name: str, points: np.ndarray, ends: bool = False):
    """The corners of all faces or strips and how many each has, if there are any; `ends`: -1 stands between."""
    if name not in elements or not elements[name].n_rows:
        return
    lists = [elements[name].lists[key] for key in _CORNERS if key in elements[name].lists]
    if len(lists) != 1:
        raise MissingKey(
            f"{len(lists)} lists of vertex indices", where=name, valid="one, vertex_indices"
        )
    flat, counts = lists[0]
    if flat.dtype.kind not in "iu":
        raise BadSyntax("vertex indices are fractions", where=name, valid="whole numbers")
    flat = flat.astype(np.int64)
    with at(name):
        used = flat[flat != -1] if ends else flat
        refuse_missing_corners(used, len(points))
        if len(used):
            checked(Triangles(points, np.repeat(used, 3)))
    yield flat, counts


def _strips(row: np.ndarray) -> np.ndarray:
    """(m, 3) the triangles of strips with -1 between them."""
    ends = np.flatnonzero(row == -1)
    parts = [part[part != -1] for part in np.split(row, ends)]
    return np.concatenate([strip(part) for part in parts])


_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}  # fmt: skip

_ORDERS = {"ascii": "=", "binary_little_endian": "<", "binary_big_endian": ">"}


def elements_of(data: bytes) -> dict[str, PlyRows]:
    """All elements of a PLY file, by name.

    Raises:
        BadSyntax: not PLY, cut off, or longer than its header says. DuplicateName: two of one name.
    """
    order, elements, body = _header(data)
    reader = TextRows(body) if order == "=" else BinaryRows(body)
    found = {}
    for element in elements:
        with at(f"element {element.name!r:.40}"):
            found[element.name] = reader.rows(element)
    reader.refuse_rest()
    return found


def _header(data: bytes) -> tuple[str, list[Element], bytes]:
    newline = b"\r\n" if data[3:5] == b"\r\n" else data[3:4]
    head, end, body = data.partition(newline + b"end_header" + newline)
    if data[:3] != b"ply" or newline not in (b"\n", b"\r", b"\r\n") or not end:
        raise _not_ply()
    lines = head.decode("utf-8", errors="replace").split(newline.decode("ascii"))
    words = [line.split() for line in lines]
    if (
        len(words) < 2
        or words[1][:1] != ["format"]
        or words[1][1:2] == []
        or words[1][1] not in _ORDERS
    ):
        raise _not_ply()
    order = _ORDERS[words[1][1]]
    elements: list[Element] = []
    for row in words[2:]:
        _take_line(row, elements, order)
    names = [element.name for element in elements]
    if len(set(names)) < len(names):
        raise DuplicateName("two elements of the PLY file have one name", valid="each name once")
    return order, elements, body


def _not_ply() -> BadSyntax:
    return BadSyntax(
        "not a PLY file that can be read", valid="ply, format ascii or binary, …, end_header"
    )


def _take_line(row: list[str], elements: list[Element], order: str) -> None:
    if not row or row[0] in ("comment", "obj_info"):
        return
    if row[0] == "element" and len(row) == 3:
        elements.append(Element(row[1], int(integers([row[2]])[0]), []))
        if elements[-1].n_rows >= 0:
            return
    elif row[0] == "property" and elements and len(row) == (5 if row[1:2] == ["list"] else 3):
        made = _property(row, order)
        if made is not None:
            if any(made.name == other.name for other in elements[-1].properties):
                raise DuplicateName(
                    f"property {made.name!r:.40} is there twice", valid="each name once"
                )
            elements[-1].properties.append(made)
            return
    raise BadSyntax(
        f"the PLY header has the line {' '.join(row)!r:.60}", valid="element or property"
    )


def _property(row: list[str], order: str) -> Property | None:
    words = row[2:4] if row[1] == "list" else row[1:2]
    if any(word not in _TYPES for word in words):
        return None
    made = [np.dtype(order + _TYPES[word]) for word in words]
    if len(made) == 1:
        return Property(row[-1], made[0], None)
    return Property(row[-1], made[1], made[0]) if made[0].kind in "iu" else None


class Property(NamedTuple):
    """A number of each row, or a list of them: the type of its length is then given as well."""

    name: str
    kind: np.dtype
    length_kind: np.dtype | None


class Element(NamedTuple):
    """One kind of row, as the header announces it."""

    name: str
    n_rows: int
    properties: list[Property]


class PlyRows(NamedTuple):
    """All rows of one element.

    Attributes:
        n_rows: how many there are.
        columns: (n,) the values of each property.
        lists: for each list property all values, one row after the other, and (n,) how many each row has.
    """

    n_rows: int
    columns: dict[str, np.ndarray]
    lists: dict[str, tuple[np.ndarray, np.ndarray]]


class BinaryRows:
    """Rows of a binary file, one after the other."""

    def __init__(self, body: bytes) -> None:
        self.body = body
        self.place = 0

    def rows(self, element: Element) -> PlyRows:
        """The next rows."""
        sizes = [(item.length_kind or item.kind).itemsize for item in element.properties]
        if element.n_rows * sum(sizes) > len(self.body) - self.place:
            raise BadSyntax(f"{element.n_rows} rows do not fit in the file: it is cut off")
        if element.n_rows and not element.properties:
            raise BadSyntax(f"{element.n_rows} rows without properties")
        same = self._block(element)
        return same if same is not None else self._one_by_one(element)

    def _block(self, element: Element) -> PlyRows | None:
        """All rows at once, if the lists of all are as long as those of the first; else None."""
        fields: list[tuple[str, np.dtype, tuple[int, ...]]] = []
        place, least = self.place, 0
        for k, item in enumerate(element.properties):
            count, shape = 1, tuple[int, ...]()
            if item.length_kind is not None:
                count = int(self._take(item.length_kind, min(1, element.n_rows), place).sum())
                shape, least = (count,), min(least, count)
                fields.append((f"n{k}", item.length_kind, ()))
                place += item.length_kind.itemsize
            fields.append((f"v{k}", item.kind, shape))
            place += max(0, count) * item.kind.itemsize
        if least < 0 or (place - self.place) * element.n_rows > len(self.body) - self.place:
            return None
        kind = np.dtype(fields)
        table = self._take(kind, element.n_rows, self.place)
        columns, lists = {}, {}
        for k, item in enumerate(element.properties):
            if item.length_kind is None:
                columns[item.name] = table[f"v{k}"]
                continue
            counts = table[f"n{k}"].astype(np.int64)
            if (counts != table[f"v{k}"].shape[1]).any():
                return None
            lists[item.name] = (table[f"v{k}"].reshape(-1), counts)
        self.place += element.n_rows * kind.itemsize
        return PlyRows(element.n_rows, columns, lists)

    def _one_by_one(self, element: Element) -> PlyRows:
        found: dict[str, list[np.ndarray]] = {item.name: [] for item in element.properties}
        counts: dict[str, list[int]] = {item.name: [] for item in element.properties}
        for _ in range(element.n_rows):
            for item in element.properties:
                count = 1
                if item.length_kind is not None:
                    count = int(self._next(item.length_kind, 1)[0])
                found[item.name].append(self._next(item.kind, count))
                counts[item.name].append(count)
        columns, lists = {}, {}
        for item in element.properties:
            flat = np.concatenate(found[item.name])
            if item.length_kind is None:
                columns[item.name] = flat
            else:
                lists[item.name] = (flat, np.array(counts[item.name]))
        return PlyRows(element.n_rows, columns, lists)

    def _next(self, kind: np.dtype, count: int) -> np.ndarray:
        values = self._take(kind, count, self.place)
        self.place += count * kind.itemsize
        return values

    def _take(self, kind: np.dtype, count: int, place: int) -> np.ndarray:
        if count < 0 or place + count * kind.itemsize > len(self.body):
            raise BadSyntax(
                f"a list or row of {count} numbers does not fit in the file: it is cut off"
            )
        return np.frombuffer(self.body, kind, count, place) if count else np.empty(0, kind)

    def refuse_rest(self) -> None:
        """Refuses bytes that no element has."""
        rest = self.body[self.place :]
        if rest.strip(b" \t\r\n\0"):
            raise BadSyntax(f"the PLY file has {len(rest)} bytes more than its header says")


class TextRows:
    """Rows of a text file: one a line."""

    def __init__(self, body: bytes) -> None:
        self.lines = [row for line in body.splitlines() if (row := line.split())]
        self.place = 0

    def rows(self, element: Element) -> PlyRows:
        """The next rows."""
        lines = self.lines[self.place : self.place + element.n_rows]
        if len(lines) < element.n_rows:
            raise BadSyntax(
                f"{len(lines)} of its {element.n_rows} lines are there: the file is cut off"
            )
        self.place += element.n_rows
        lists = [item for item in element.properties if item.length_kind is not None]
        if not lists:
            return self._table(lines, element.properties)
        return self._with_lists(lines, element.properties)

    def _table(self, lines: list[list[bytes]], properties: list[Property]) -> PlyRows:
        for i, row in enumerate(lines):
            if len(row) != len(properties):
                raise BadSyntax(f"row {i} has {len(row)} numbers", valid=f"{len(properties)}")
        columns = {
            item.name: _column([row[k] for row in lines], item.kind)
            for k, item in enumerate(properties)
        }
        return PlyRows(len(lines), columns, {})

    def _with_lists(self, lines: list[list[bytes]], properties: list[Property]) -> PlyRows:
        single: dict[str, list[bytes]] = {p.name: [] for p in properties if p.length_kind is None}
        flat: dict[str, list[bytes]] = {p.name: [] for p in properties if p.length_kind is not None}
        counts: dict[str, list[int]] = {name: [] for name in flat}
        for i, row in enumerate(lines):
            place = 0
            for item in properties:
                if item.length_kind is None:
                    single[item.name] += row[place : place + 1]
                    place += 1
                    continue
                count = _length(row[place]) if place < len(row) else -1
                flat[item.name] += row[place + 1 : place + 1 + max(count, 0)]
                counts[item.name].append(count)
                place = place + 1 + count if count >= 0 else -len(row) - 1
            if place != len(row):
                raise BadSyntax(f"row {i} has {len(row)} numbers, which is not what its lists say")
        kinds = {item.name: item.kind for item in properties}
        columns = {name: _column(words, kinds[name]) for name, words in single.items()}
        lists = {n: (_column(words, kinds[n]), np.array(counts[n])) for n, words in flat.items()}
        return PlyRows(len(lines), columns, lists)

    def refuse_rest(self) -> None:
        """Refuses lines that no element has."""
        if self.place < len(self.lines):
            n_more = len(self.lines) - self.place
            raise BadSyntax(f"the PLY file has {n_more} lines more than its header says")


def _length(word: bytes) -> int:
    """How long a list is; -1 where that is no number, or one that no line has room for."""
    return int(word) if word.isdigit() and len(word) < 10 else -1


def _column(words: list[bytes], kind: np.dtype) -> np.ndarray:
    """The words as numbers: whole ones where the header says so, others in double precision."""
    return integers(words) if kind.kind in "iu" else floats(words)
