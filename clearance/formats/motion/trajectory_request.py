"""What a reader of trajectories is asked for, and what it gives. Not for: the formats (`trajectory_file`)."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, fields
from typing import NamedTuple

from clearance.errors import BadInput
from clearance.formats.table.csv_table import Opener
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory


@dataclass(frozen=True)
class Choice:
    """What a case file says about a trajectory file beside its path; None where it says nothing.

    Attributes:
        which: the number of the trajectory that is meant, from 1, in a file that holds several.
        units: of angles and lengths that name no unit themselves: keys of `column_units.UNITS`.
        joints: the columns beside time of a table without a header.
        period: [s] from row to row of a table without times.
        topic: of a bag.
        gaps: what joints do in holes of a recording: one of `world.notice.GAPS`.
        columns: of a table, pairs of `time`, a joint, or a joint and `/velocity`, and the column that it is; other
            columns are left out.
    """

    which: int | None = None
    units: tuple[str, str] | None = None
    joints: tuple[str, ...] | None = None
    period: float | None = None
    topic: str | None = None
    gaps: str | None = None
    columns: tuple[tuple[str, str], ...] | None = None

    def refuse_others(self, used: Collection[str], what: str) -> None:
        """Nothing, if all that is said is of use.

        Args:
            used: names of attributes. what: the kind of file, for the message.

        Raises:
            BadInput: the first that says nothing about such a file.
        """
        for name in (one.name for one in fields(self)):
            if name not in used and getattr(self, name) is not None:
                raise BadInput(
                    f"{name!r} says nothing about {what}", valid=f"leave {name!r} out of trajectory"
                )


@dataclass(frozen=True)
class TrajectoryRequest:
    """A file to read.

    Attributes:
        opened: opens the file, `n_bytes` long, again and again.
        joints_needed: False for a robot that has no joint to move, for which times alone do.
        turns: of each joint that moves, whether it turns; empty where the robot is not known.
        robot: whose joints those of a table must be; None where it is not known.
    """

    opened: Opener
    n_bytes: int
    joints_needed: bool = True
    choice: Choice = Choice()
    turns: Mapping[str, bool] = field(default_factory=dict)
    robot: Robot | None = None


class ReadTrajectory(NamedTuple):
    """A trajectory, and a line each on what was taken how."""

    trajectory: Trajectory
    notes: tuple[str, ...] = ()
