"""Points as a file of a scan has them, and those of a PLY file. Not for: bodies made of them (`formats`)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.formats.mesh.ply_file import elements_of, vertices


class Points(NamedTuple):
    """Points of a scan.

    Attributes:
        places: (n, 3) in the file's unit; NaN or infinity where a beam did not come back.
        notes: what reading had to decide, one line each.
        in_metres: True if the file names its units, so that the places are in metres.
    """

    places: np.ndarray
    notes: tuple[str, ...] = ()
    in_metres: bool = False


def read_ply_points(data: bytes) -> Points:
    """The vertices of a PLY file, as points of a scan; faces are passed over.

    Raises:
        BadSyntax, MissingKey: as `read_ply`.
    """
    elements = elements_of(data)
    faces = [name for name in ("face", "tristrips") if name in elements and elements[name].n_rows]
    notes = ("its faces are passed over: only the vertices are taken",) if faces else ()
    return Points(vertices(elements), notes)
