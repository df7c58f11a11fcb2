"""The vertices of a PLY file as points of a scan. Not for: surfaces, nor how a file is stored (`ply_file`)."""

from __future__ import annotations

from clearance.formats.cloud.points import Points
from clearance.formats.mesh.ply_elements import elements_of
from clearance.formats.mesh.ply_file import vertices


def read_ply_points(data: bytes) -> Points:
    """The vertices of a PLY file, as points of a scan; faces are passed over.

    Raises:
        BadSyntax, MissingKey: as `read_ply`.
    """
    elements = elements_of(data)
    faces = [name for name in ("face", "tristrips") if name in elements and elements[name].n_rows]
    notes = ("its faces are passed over: only the vertices are taken",) if faces else ()
    return Points(vertices(elements), notes)
