"""The answer to a distance query."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np


@dataclass(frozen=True, eq=False)
class Nearest:
    """How close two solids come, and where.

    Attributes:
        distance: [m]; 0 when they touch or overlap.
        point_a, point_b: (3,) witness points [m] in the world frame; equal to within rounding at contact.
        face_a, face_b: indices of the polygons with the witness points; -1 for a body inside another,
            where the common point is on no face of the outer one.
        contact: True when they touch, overlap, or one is inside the other.
        error_bound: [m] upper bound on |distance - true distance of the given input|.
        tally: counters: node pairs and polygon pairs tested, and for `method="paper"` those cut by each rule
            and the iterations used.
        inside: "yes" where one body is wholly inside the other, "undecided" where it may be, and the other's
            surface is too open to decide: `distance` is then that of the surfaces alone. Else "no".
    """

    distance: float
    point_a: np.ndarray
    point_b: np.ndarray
    face_a: int
    face_b: int
    contact: bool
    error_bound: float
    tally: dict[str, int] = field(default_factory=dict)
    inside: str = "no"
