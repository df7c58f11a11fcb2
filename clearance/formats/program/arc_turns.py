"""How a tool turns on an arc, for controllers that turn it seen from the path. Not for: arcs (`programs`)."""

from __future__ import annotations

from typing import Literal

import numpy as np

from clearance.errors import BadProgram
from clearance.geometry.pose import pose_from_rotation_vector
from clearance.geometry.quaternions import rotation_vector

TILT = 2e-4
"""[rad] By which an orientation may be off: files round them."""


def turn_on_path(start: np.ndarray, via: np.ndarray, end: np.ndarray) -> Literal["to", "tangent"]:
    """How a tool turns that goes from its pose at the start to that at the end, (4, 4), seen from the path.

    The turn is exp(s t n) exp(s w) at a share s, with n the axis of the arc, t its angle, and w what is left of
    the turn. It is about one axis at a constant rate only if w is along n.

    Args:
        via: (3,) a point of the arc [m].

    Raises:
        BadProgram: it is not.
    """
    to_via, to_end = via - start[:3, 3], end[:3, 3] - start[:3, 3]
    cross = np.cross(to_via, to_end)
    size = float(np.linalg.norm(cross))
    if size < 1e-12:
        return "to"  # no arc, which is refused where it is made
    normal = cross / size
    angle = 2.0 * (np.pi - np.arctan2(size, to_via @ (to_via - to_end)))  # Euclid III, 20
    back = pose_from_rotation_vector([0.0, 0.0, 0.0], (-angle * normal).tolist())[:3, :3]
    left = rotation_vector(back @ end[:3, :3] @ start[:3, :3].T)
    if float(np.linalg.norm(left - (left @ normal) * normal)) > TILT:
        raise BadProgram(
            "the tool tilts on the arc, and how is not read",
            valid="an end at which it is turned about the arc's axis only",
        )
    if np.linalg.norm(left) <= TILT:
        return "tangent"
    if abs(angle + left @ normal) >= np.pi - TILT:
        raise BadProgram(
            "seen along the arc, the tool turns by half a turn or more, either way; a tool that keeps its "
            "orientation in space turns back by as much as the arc goes round",
            valid="arcs that go round by less, as thirds of a circle",
        )
    return "to"
