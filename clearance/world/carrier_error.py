"""An error of the carrier of a body, seen from that body, now or at the moment of a grasp or release.

A gripper with an error closes on a part without one. Let the carrier be at C(g) d(g) at the grasp, where d is its
error, and at C(t) d(t) later, and the part at P before. Then the part is at C(t) d(t) d(g)^-1 C(g)^-1 P. It has
the errors of both moments, and keeps them when it is laid down or handed on. Axes and places stay constant, seen
from the part.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

GRASP, RELEASE = "grasp", "release"

ALIKE = 1e-12
"""[m] Two chains through one joint at one moment see it in the same place to within rounding."""


@dataclass(frozen=True, eq=False)
class CarrierError:
    """One error of the carrier of a body, at a moment.

    Attributes:
        owner: the robot or obstacle. joint: of the robot; empty for its base, or for the place of an obstacle.
        origin: (3,) [m] a point of the joint's axis, or the frame's origin, seen from what hangs there.
        axis: (3,) unit, of the joint itself, seen from there; None where the frame, base or place is off.
        slides: True for a joint that slides.
        deed, time: `GRASP` or `RELEASE`, and when [s]; an empty deed is now.
        inverse: True if the body is moved against the error, since the gripper had it at the grasp.
    """

    owner: str
    joint: str
    origin: np.ndarray
    axis: np.ndarray | None = None
    slides: bool = False
    deed: str = ""
    time: float = 0.0
    inverse: bool = False

    @property
    def moment(self) -> str:
        """The moment in words; empty for the present one."""
        return f"{self.deed} ({self.time:.9g} s)" if self.deed else ""

    @property
    def sign(self) -> float:
        """1, or -1 where it is inverse."""
        return -1.0 if self.inverse else 1.0

    def seen_from(self, there_from_here: np.ndarray) -> CarrierError:
        """The same seen from another frame, which sees this one at a pose (4, 4) [m]."""
        turn = there_from_here[:3, :3]
        origin = turn @ self.origin + there_from_here[:3, 3]
        return replace(self, origin=origin, axis=None if self.axis is None else turn @ self.axis)

    def undoes(self, other: CarrierError) -> bool:
        """True if it is the same error at the same moment, the other way round."""
        mine, its = ((one.owner, one.joint, one.time, bool(one.deed)) for one in (self, other))
        if mine != its or self.inverse == other.inverse:
            return False
        if self.axis is None or other.axis is None:
            axes = self.axis is other.axis
        else:
            axes = bool(np.abs(self.axis - other.axis).max() <= ALIKE)
        return axes and bool(np.abs(self.origin - other.origin).max() <= ALIKE)


def followed_by(
    past: Iterable[CarrierError], more: Iterable[CarrierError]
) -> tuple[CarrierError, ...]:
    """Errors, then more that move what these have moved; one that the next undoes is left out with that."""
    found = list(past)
    for one in more:
        if found and one.undoes(found[-1]):
            found.pop()
        else:
            found.append(one)
    return tuple(found)
