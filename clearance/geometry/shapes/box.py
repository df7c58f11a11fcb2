"""The box, which is exact. Not for: round shapes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.geometry.polyhedron import Polyhedron
from clearance.geometry.shapes.dimension import three_positive

_FACES = np.array(
    [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
)
_SIGNS = np.array([[x, y, z] for z in (-0.5, 0.5) for y in (-1, 1) for x in (-1, 1)]) * [
    0.5,
    0.5,
    1.0,
]


def box(size: Sequence[float]) -> Polyhedron:
    """The box of the given sizes along x, y, z [m] about the origin, with six faces.

    Raises:
        BadDimension: not three finite numbers above 0.

    Exactness: exact.
    """
    return Polyhedron(_SIGNS * three_positive(size, "size"), _FACES)
