"""Wavefront OBJ to triangles: all groups, objects and materials of the file as one surface.

Own code, because the usual readers count relative indices from the end of the file instead of from
the face's line, cut concave polygons as fans, or mix up corners where materials change (NOTES.md).
Only positions and faces are read; colour, texture, normals, lines and points do not matter for a
distance.
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadSyntax, EmptyMesh
from clearance.load.polygon_cut import cut_polygons
from clearance.load.triangles import Triangles, checked

_FREE_FORM = frozenset({"curv", "curv2", "surf"})


def read_obj(data: bytes) -> Triangles:
    """The faces of an OBJ file, polygons cut into triangles, in file order.

    Raises:
        BadSyntax: not OBJ, with the line. BadPolygon: a face that is no simple polygon.
    """
    lines = data.decode("utf-8", errors="replace").replace("\\\r\n", " ").replace("\\\n", " ")
    positions: list[list[float]] = []
    faces: list[list[int]] = []
    for number, line in enumerate(lines.splitlines(), 1):
        key, _, rest = line.lstrip().replace("\t", " ").partition(" ")
        try:
            if key == "v":
                x, y, z, *_ = rest.split("#")[0].split()
                positions.append([float(x), float(y), float(z)])
            elif key in ("f", "fo"):
                faces.append([_index(word, len(positions)) for word in rest.split("#")[0].split()])
            elif key in _FREE_FORM:
                raise BadSyntax(
                    "free-form surfaces are not read", valid="polygons: export as a mesh"
                )
        except ValueError as error:
            raise _bad_line(number, line, error) from None
    return _cut(positions, faces)


def _cut(positions: list[list[float]], faces: list[list[int]]) -> Triangles:
    if not faces:
        raise EmptyMesh("the mesh has no faces", valid="at least one 'f' line is needed")
    vertices = np.array(positions, dtype=np.float64).reshape(-1, 3)
    flat = np.concatenate([np.asarray(face, dtype=np.int64) for face in faces])
    checked(Triangles(vertices, np.repeat(flat, 3)))
    return Triangles(vertices, cut_polygons(vertices, faces))


def _index(word: str, n_before: int) -> int:
    """0-based vertex index of `7`, `7/1`, `7//3`, `7/1/3`, or `-1` (the last vertex before this
    line).
    """
    given = int(word.partition("/")[0])
    if given == 0:
        raise ValueError("vertices are counted from 1")
    index = given - 1 if given > 0 else n_before + given
    if index < 0:
        raise ValueError(f"there are only {n_before} vertices before this line")
    return index


def _bad_line(number: int, line: str, error: ValueError) -> BadSyntax:
    if isinstance(error, BadSyntax):
        error.where = f"line {number}"
        return error
    return BadSyntax(
        f"{line.strip()!r:.60} cannot be read",
        where=f"line {number}",
        valid="'v x y z' and 'f i j k …' with vertices counted from 1",
    )
