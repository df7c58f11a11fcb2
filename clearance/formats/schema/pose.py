"""The schema of where something is: poses, what it stands on, and files that say where it goes.

Not for: reading those files (`motion.requests`).
"""

from __future__ import annotations

import math
from typing import Annotated

import numpy as np
from pydantic import Field, model_validator

from clearance.errors import Contradiction
from clearance.formats.schema.strict_model import Angle, Name, StrictModel, Triple
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.geometry.quaternions import of_unit_length
from clearance.world.timing import Window

Quadruple = Annotated[list[float], Field(min_length=4, max_length=4)]


class Pose(StrictModel):
    """Where something stands: a point and a rotation (quaternion xyzw, or roll, pitch, yaw about
    fixed axes [rad], or as text: `90deg`).
    """

    xyz: Triple = [0.0, 0.0, 0.0]
    quat_xyzw: Quadruple | None = None
    rpy: Annotated[list[Angle], Field(min_length=3, max_length=3)] | None = None

    @model_validator(mode="after")
    def _is_rotation(self) -> Pose:
        if self.quat_xyzw is not None and self.rpy is not None:
            raise Contradiction("both quat_xyzw and rpy are given", valid="give one of them")
        self.matrix()
        return self

    @property
    def is_rounded(self) -> bool:
        """True if its quaternion is rounded to three digits or so, which `matrix` makes of length 1."""
        return self.quat_xyzw is not None and of_unit_length(np.array([self.quat_xyzw]))[1] > 0

    def matrix(self) -> np.ndarray:
        """The (4, 4) pose [m].

        Raises:
            BadPose: the quaternion is not of length one.
        """
        if self.quat_xyzw is not None:
            unit, _ = of_unit_length(np.array([self.quat_xyzw]))
            return pose_from_quaternion(self.xyz, unit[0])
        return pose_from_rpy(self.xyz, self.rpy or [0.0, 0.0, 0.0])


class Base(Pose):
    """Where a robot's root link stands, in the world or on a link or an obstacle."""

    on: Name | None = None


class WindowedEntry(StrictModel):
    """What is so from a time until a time of the run [s], or always."""

    from_: Annotated[float | None, Field(alias="from")] = None
    until: float | None = None

    @model_validator(mode="after")
    def _in_order(self) -> WindowedEntry:
        _ = self.window
        return self

    @property
    def window(self) -> Window:
        """The stretch of time.

        Raises:
            BadTime: it ends before it begins.
        """
        start = -math.inf if self.from_ is None else self.from_
        return Window(start, math.inf if self.until is None else self.until)
