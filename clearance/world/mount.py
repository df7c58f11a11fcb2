"""The moving support of an actor: a link of a robot, or an obstacle. Not for: how that moves (`forest`)."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from clearance.errors import at
from clearance.geometry.pose import validated_pose
from clearance.world.field_types import owned, require_types


@dataclass(frozen=True, eq=False)
class Mount:
    """A place on a body.

    Attributes:
        on: its name as in tables: an obstacle, `robot/link`, or the link alone where there is one robot.
        pose: (4, 4) `on_from_base` [m] of what stands there.
    """

    on: str
    pose: np.ndarray = field(default_factory=lambda: np.eye(4))

    def __post_init__(self) -> None:
        require_types(self, on=str)
        with at("pose"):
            object.__setattr__(self, "pose", owned(validated_pose(self.pose)))
