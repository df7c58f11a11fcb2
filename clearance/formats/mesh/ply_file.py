"""PLY, text and binary of either byte order, to triangles. Strict: all that the header says, and nothing after it.

Own code, because the usual readers keep what is left of a cut-off text file, cut polygons as fans, and leave
`tristrips` out. Points, faces and strips are read; colours and other elements are passed over. Not for: how
elements are stored (`ply_elements`), nor points without faces (`ply_points`).
Source: G. Turk, The PLY polygon file format, 1994.
"""

from __future__ import annotations

import numpy as np

from clearance.errors import BadSyntax, EmptyMesh, MissingKey, at
from clearance.formats.mesh.ply_elements import elements_of
from clearance.formats.mesh.ply_rows import PlyRows
from clearance.formats.mesh.polygon_cut import cut_rings
from clearance.formats.mesh.request import MeshRequest
from clearance.formats.mesh.strips import strip
from clearance.formats.mesh.triangles import Triangles, checked, refuse_missing_corners

_CORNERS = ("vertex_indices", "vertex_index")


def read_ply(asked: MeshRequest) -> Triangles:
    """The faces and strips of a PLY file, polygons cut into triangles, in file order.

    Raises:
        BadSyntax, MissingKey: not PLY, cut off, or longer than its header says. BadPolygon, EmptyMesh, NotFinite.
    """
    elements = elements_of(asked.data)
    points = vertices(elements)
    corners = [cut_rings(points, *rings) for rings in _rings(elements, "face", points)]
    for flat, counts in _rings(elements, "tristrips", points, ends=True):
        corners += [_strips(ring) for ring in np.split(flat, np.cumsum(counts)[:-1])]
    if not sum(map(len, corners)):
        raise EmptyMesh(
            "the mesh has no faces",
            valid="at least one triangle is needed; a scan is read as points: {file: …, radius: …}",
        )
    return Triangles(points, np.concatenate(corners))


def vertices(elements: dict[str, PlyRows]) -> np.ndarray:
    """(n, 3) the vertices, in the file's unit.

    Raises:
        MissingKey: there are none with x, y and z.
    """
    columns = elements["vertex"].columns if "vertex" in elements else {}
    missing = [name for name in "xyz" if name not in columns]
    if missing:
        raise MissingKey(f"the PLY file has no vertex property {missing[0]!r}", valid="x, y, z")
    return np.stack([columns[name].astype(np.float64) for name in "xyz"], axis=1)


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
