"""Wavefront OBJ to triangles: all groups, objects and materials of the file as one surface.

Own code, because the usual readers count relative indices from the end of the file instead of from
the face's line, cut concave polygons as fans, or mix up corners where materials change (NOTES.md).
Only positions and faces are read; colour, texture and normals do not matter for a distance.
"""

from __future__ import annotations

import re
from codecs import BOM_UTF8
from itertools import chain

import numpy as np

from clearance.errors import BadSyntax, EmptyMesh
from clearance.formats.mesh.polygon_cut import cut_rings
from clearance.formats.mesh.triangles import MeshRequest, Triangles, checked, on_lines

_FREE_FORM = frozenset({b"curv", b"curv2", b"surf", b"bsp", b"bzp", b"cdc", b"cdp", b"res"})

_MOST = 2**62

_OTHER_FILES = frozenset({b"call", b"csh"})

_LINES = frozenset({b"p", b"l"})

_NO_SURFACE = frozenset(
    b"vt vn vp g s o mg usemtl mtllib usemap maplib bevel c_interp d_interp lod shadow_obj trace_obj "
    b"ctech stech cstype deg bmat step parm trim hole scrv sp end con".split()
)


_VERTEX = re.compile(rb"(?:\A|[\r\n])[ \t]*v[ \t]+(\S+)[ \t]+(\S+)[ \t]+(\S+)")


def vertices_of_obj(data: bytes) -> np.ndarray:
    """(n, 3) all vertices of an OBJ file, whether faces use them or not.

    Raises:
        ValueError: one is no point.
    """
    return np.array(
        [float(word) for point in _VERTEX.findall(_joined(data)) for word in point]
    ).reshape(-1, 3)


def read_obj(asked: MeshRequest) -> Triangles:
    """The faces of an OBJ file, polygons cut into triangles, in file order.

    Raises:
        BadSyntax: not OBJ, with the line. BadPolygon: a face that is no simple polygon.
    """
    positions: list[list[float]] = []
    faces: list[list[int]] = []
    n_lines = 0
    lines = _joined(asked.data).splitlines()
    for number, line in enumerate(lines, 1):  # of bytes: text would also be split at U+2028
        words = line.partition(b"#")[0].split()
        if not words:
            continue
        try:
            if words[0] == b"v":
                _, x, y, z, *_ = words
                positions.append([_number(x), _number(y), _number(z)])
            elif words[0] in (b"f", b"fo"):
                faces.append([_index(word, len(positions)) for word in words[1:]])
            elif words[0] in _LINES:
                n_lines += 1
            elif words[0] not in _NO_SURFACE:
                raise _refused(words[0])
        except ValueError as error:
            raise _bad_line(number, line, error) from None
    return _cut(positions, faces)._replace(notes=tuple(on_lines(n_lines)))


def _joined(data: bytes) -> bytes:
    """The content with lines that go on made one, and no byte order mark."""
    data = data.removeprefix(BOM_UTF8)
    return data.replace(b"\\\r\n", b" ").replace(b"\\\n", b" ")


def _refused(key: bytes) -> ValueError:
    if key in _FREE_FORM:
        return BadSyntax("free-form surfaces are not read", valid="polygons: export as a mesh")
    if key in _OTHER_FILES:
        return BadSyntax("other files are not read", valid="one file with all of the mesh")
    return ValueError("an unknown word")


def _cut(positions: list[list[float]], faces: list[list[int]]) -> Triangles:
    if not faces:
        raise EmptyMesh("the mesh has no faces", valid="at least one 'f' line is needed")
    vertices = np.array(positions, dtype=np.float64).reshape(-1, 3)
    counts = np.array([len(face) for face in faces])
    flat = np.fromiter(chain.from_iterable(faces), np.int64, int(counts.sum()))
    checked(Triangles(vertices, np.repeat(flat, 3)))
    return Triangles(vertices, cut_rings(vertices, flat, counts))


def _number(word: bytes) -> float:
    if b"_" in word:  # Python reads 1_0 as 10
        raise ValueError("an underscore in a number")
    return float(word)


def _index(word: bytes, n_before: int) -> int:
    """0-based vertex index of `7`, `7/1`, `7//3`, `7/1/3`, or `-1` (the last vertex before this
    line).
    """
    text = word.partition(b"/")[0]
    if b"_" in text:
        raise ValueError("an underscore in a number")
    given = int(text)
    if not -_MOST <= given <= _MOST:
        raise ValueError("a number that no file has so many vertices for")
    if given == 0:
        raise ValueError("vertices are counted from 1")
    index = given - 1 if given > 0 else n_before + given
    if index < 0:
        raise ValueError(f"there are only {n_before} vertices before this line")
    return index


def _bad_line(number: int, line: bytes, error: ValueError) -> BadSyntax:
    if isinstance(error, BadSyntax):
        error.where = f"line {number}"
        return error
    return BadSyntax(
        f"{line.decode('utf-8', errors='replace').strip()!r:.60} cannot be read",
        where=f"line {number}",
        valid="'v x y z' and 'f i j k …' with vertices counted from 1",
    )
