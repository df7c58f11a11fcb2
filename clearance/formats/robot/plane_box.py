"""The box that stands for a plane in a scene, and in a robot's own file. Not for: where it is (`sdf.geometry`,
`mjcf`).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.world.notice import listed

PLANE_SIDE, PLANE_DEPTH = 40.0, 1.0
"""[m] The box that stands for an infinite plane, below it; arms work within 20 m of their base."""

PLANE_SIZE = (PLANE_SIDE, PLANE_SIDE, PLANE_DEPTH)


def plane_from_box() -> np.ndarray:
    """(4, 4) [m] the pose of the box on a plane, the z axis of which is its normal."""
    pose = np.eye(4)
    pose[2, 3] = -0.5 * PLANE_DEPTH
    return pose


def note_on_planes(names: Sequence[str]) -> str:
    """A note on the boxes that stand for planes."""
    size = f"{PLANE_SIDE:g} m wide and {PLANE_DEPTH:g} m deep"
    return f"planes are boxes {size} below them: {listed(names, 6)}"
