"""OFF, text, to triangles. Strict: as many points and faces as its header says, no more and no fewer.

Own code, because the usual readers keep what is left of a cut-off file. Not for: binary OFF, and points of four or
n coordinates. Source: Geomview manual, OFF files.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.errors import BadSyntax, EmptyMesh, at
from clearance.formats.mesh.polygon_cut import cut_rings
from clearance.formats.mesh.triangles import MeshRequest, Triangles, checked
from clearance.formats.text.numbers import floats, integers

_KINDS = (b"OFF", b"COFF", b"NOFF", b"CNOFF", b"STOFF")

_MOST_COLOUR = 4
"""Numbers that may follow a face's corners."""


def read_off(asked: MeshRequest) -> Triangles:
    """The faces of an OFF file, polygons cut into triangles, in file order.

    Raises:
        BadSyntax: not OFF, cut off, or longer than its header says. BadPolygon, EmptyMesh, NotFinite.
    """
    rows = [line.partition(b"#")[0].split() for line in asked.data.splitlines()]
    rows = [row for row in rows if row]
    if not rows or rows[0][0] not in _KINDS:
        raise BadSyntax(
            "not an OFF file that can be read", valid="a text file that begins with OFF"
        )
    rows = [rows[0][1:], *rows[1:]] if len(rows[0]) > 1 else rows[1:]
    with at("header"):
        n_points, n_faces = _counts(rows)
    if len(rows) != 1 + n_points + n_faces:
        raise BadSyntax(
            f"the OFF file has {len(rows) - 1} lines below its header",
            valid=f"{n_points} points and {n_faces} faces, as the header says",
        )
    points = _points(rows[1 : 1 + n_points])
    return _cut(points, rows[1 + n_points :])


def _counts(rows: list[list[bytes]]) -> tuple[int, int]:
    counts = integers(rows[0]).tolist() if rows else []
    if len(counts) not in (2, 3) or min(counts) < 0:
        raise BadSyntax(f"the counts are {counts}", valid="numbers of points, faces and edges")
    return counts[0], counts[1]


def _points(rows: list[list[bytes]]) -> np.ndarray:
    for i, row in enumerate(rows):
        if len(row) < 3:
            raise BadSyntax(f"point {i} has {len(row)} coordinates", valid="three")
    with at("points"):
        return floats([word for row in rows for word in row[:3]]).reshape(-1, 3)


def _cut(points: np.ndarray, rows: list[list[bytes]]) -> Triangles:
    if not rows:
        raise EmptyMesh("the mesh has no faces", valid="at least one triangle is needed")
    with at("faces"):
        counts = integers([row[0] for row in rows])
        for i, (row, count) in enumerate(zip(rows, counts.tolist(), strict=True)):
            if not 0 <= len(row) - 1 - count <= _MOST_COLOUR or count < 1:
                raise BadSyntax(f"face {i} has {len(row) - 1} numbers, and names {count} corners")
        flat = integers(
            [w for row, n in zip(rows, counts.tolist(), strict=True) for w in row[1 : n + 1]]
        )
    checked(Triangles(points, np.repeat(flat, 3)))
    return Triangles(points, cut_rings(points, flat, counts))


def off_text(vertices: Sequence[Sequence[float]], triangles: Sequence[Sequence[int]]) -> bytes:
    """The content of an OFF file that is read back with the same numbers."""
    lines = ["OFF", f"{len(vertices)} {len(triangles)} 0"]
    lines += [" ".join(map(repr, vertex)) for vertex in vertices]
    lines += [" ".join(map(str, (3, *triangle))) for triangle in triangles]
    return "\n".join(lines).encode()
