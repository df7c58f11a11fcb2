"""What is open of a shape: how components would close, and which would not.

Not for: how it is found (`closing`), and what may be inside then (`query.inside`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry.closing import FEW, SOME, Closing, closing_of, loose_triangles
from clearance.geometry.polyhedron import Polyhedron


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
    """What is open of a shape."""
    return OpenFaces(closing_of(shape), closing_of(shape, FEW, SOME), loose_triangles(shape))
