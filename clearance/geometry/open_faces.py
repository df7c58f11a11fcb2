"""What is open of a shape, found once on a machine: how components would close, and which would not.

Finding it took a tenth of a short run with open meshes. Not for: how it is found (`closing`), and what may be
inside then (`query.inside`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry import closing
from clearance.geometry.closing import FEW, SOME, Closing, closing_of, loose_triangles
from clearance.geometry.kept_shapes import kept, name_of
from clearance.geometry.polyhedron import Polyhedron

LARGE = 100
"""Faces of a shape of which it is kept; of fewer it is found in less time than read."""


class OpenFaces(NamedTuple):
    """What is open of a shape.

    Attributes:
        few: how the components close whose holes have a share up to `FEW`. some: beyond that and up to `SOME`.
        loose: (k, 3, 3) [m] the triangles that do not close by `SOME`, and hold nothing (`loose_triangles`).
    """

    few: Closing | None
    some: Closing | None
    loose: np.ndarray


def open_faces_of(shape: Polyhedron) -> OpenFaces:
    """What is open of a shape, taken from an earlier run where that has found it."""
    if shape.n_faces < LARGE or _is_whole(shape):
        return _found(shape)
    name = name_of(shape.vertices, shape.face_starts, shape.face_vertices)
    return kept(name, "open", closing.__file__, lambda: _found(shape))


def _is_whole(shape: Polyhedron) -> bool:
    """True if every component is closed and has an inside: then nothing is open, which costs nothing to find."""
    return bool(shape.component_closed.all() and not shape.component_two_sided.any())


def _found(shape: Polyhedron) -> OpenFaces:
    return OpenFaces(closing_of(shape), closing_of(shape, FEW, SOME), loose_triangles(shape))
