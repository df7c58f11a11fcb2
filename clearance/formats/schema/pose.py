"""The schema of where something is: poses, what it stands on, and files that say where it goes.

Not for: reading those files (`trajectory_file`, `pose_file`).
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

import numpy as np
from pydantic import BeforeValidator, Field, model_validator

from clearance.errors import BadInput
from clearance.formats.motion.trajectory_file import Choice
from clearance.formats.schema.strict_model import Name, StrictModel, Triple
from clearance.geometry.pose import pose_from_quaternion, pose_from_rpy
from clearance.geometry.quaternions import of_unit_length
from clearance.world.timing import Timing, Window

Quadruple = Annotated[list[float], Field(min_length=4, max_length=4)]


class Pose(StrictModel):
    """Where something stands: a point and a rotation (quaternion xyzw, or roll, pitch, yaw about
    fixed axes).
    """

    xyz: Triple = [0.0, 0.0, 0.0]
    quat_xyzw: Quadruple | None = None
    rpy: Triple | None = None

    @model_validator(mode="after")
    def _is_rotation(self) -> Pose:
        if self.quat_xyzw is not None and self.rpy is not None:
            raise BadInput("both quat_xyzw and rpy are given", valid="give one of them")
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

    FILLED = frozenset({"on"})

    on: Name | None = None


class TimedFile(StrictModel):
    """A table of samples and when it is followed: `{file: t.csv, start: 1.0}`, or the path alone. It begins at
    `start` [s], `rate` times as fast as written; after its last sample it holds, loops, or is absent.
    """

    file: Name
    start: float = 0.0
    rate: Annotated[float, Field(gt=0)] = 1.0
    after: Literal["hold", "loop", "absent"] = "hold"

    @model_validator(mode="before")
    @classmethod
    def _path_alone(cls, data: Any) -> Any:
        return {"file": data} if isinstance(data, str) else data

    @property
    def timing(self) -> Timing:
        """When the table is followed."""
        said = self.model_fields_set & {"start", "after"}
        return Timing(self.start, self.rate, self.after, frozenset(said))


class Units(StrictModel):
    """What the angles and lengths of a table are written in; velocities are in it a second."""

    angle: Literal["rad", "deg"] = "rad"
    length: Literal["m", "mm"] = "m"


class LengthUnit(StrictModel):
    """What the lengths of a table are written in."""

    length: Literal["m", "mm"]


class PoseFile(TimedFile):
    """Poses over time and when they are followed; lengths of a table may be in other `units`."""

    FILLED = frozenset({"units"})

    units: LengthUnit | None = None

    @property
    def length(self) -> str | None:
        """The unit of lengths, if it is said."""
        return None if self.units is None else self.units.length


def _by_itself(given: Any) -> Any:
    """Columns by name; those of a list are called so themselves."""
    if not isinstance(given, list) or not all(isinstance(name, str) for name in given):
        return given
    return {name: name for name in given}


class TrajectoryFile(TimedFile):
    """A trajectory and when it is followed; `which` of those in a file of several, from 1. A table may be in other
    `units`, have no header but `joints` for its columns, and no times but a `period` [s] from row to row.
    `columns` names the columns of a table to read, and no others; `{joint: column}` if names differ. `topic` is
    a topic of a bag. `gaps` says how joints move in holes of a recording: they hold, go straight (linear), or are
    not measured. `wrap` says which way a continuous joint goes in a step of more than half a turn. `start_state`
    is the start at 0 s if the first sample is later: positions, or names of states.
    """

    FILLED = frozenset(
        (
            *("which", "units", "joints", "period", "columns", "topic"),
            *("gaps", "wrap", "start_state"),
        )
    )

    which: Annotated[int | None, Field(ge=1)] = None
    units: Units | None = None
    joints: Annotated[list[Name], Field(min_length=1)] | None = None
    period: Annotated[float | None, Field(gt=0)] = None
    topic: Name | None = None
    gaps: Literal["hold", "linear", "not_measured"] | None = None
    wrap: Literal["shortest", "as_written"] | None = None
    columns: (
        Annotated[dict[Name, Name], BeforeValidator(_by_itself), Field(min_length=1)] | None
    ) = None
    start_state: dict[Name, float] | Name | list[Name] | None = None

    @property
    def choice(self) -> Choice:
        """What is said beside path and times."""
        units = None if self.units is None else (self.units.angle, self.units.length)
        joints = None if self.joints is None else tuple(self.joints)
        columns = None if self.columns is None else tuple(self.columns.items())
        return Choice(self.which, units, joints, self.period, self.topic, self.gaps, columns)


class WindowedEntry(StrictModel):
    """What is so from a time until a time of the run [s], or always."""

    FILLED = frozenset({"from", "until"})

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
