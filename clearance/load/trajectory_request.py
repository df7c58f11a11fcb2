"""What a reader of trajectories is asked for, and what it gives. Not for: the formats (`trajectory_file`)."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass, fields
from typing import NamedTuple

from clearance.errors import BadInput
from clearance.load.csv_table import Opener
from clearance.world.trajectory import Trajectory


@dataclass(frozen=True)
class Choice:
    """What a case file says about a trajectory file beside its path; None where it says nothing.

    Attributes:
        which: the number of the trajectory that is meant, from 1, in a file that holds several.
    """

    which: int | None = None

    def refuse_others(self, used: Collection[str], what: str) -> None:
        """Nothing, if all that is said is of use.

        Args:
            used: names of attributes. what: the kind of file, for the message.

        Raises:
            BadInput: the first that says nothing about such a file.
        """
        for field in fields(self):
            if field.name not in used and getattr(self, field.name) is not None:
                raise BadInput(
                    f"{field.name!r} says nothing about {what}",
                    valid=f"leave {field.name!r} out of trajectory",
                )


@dataclass(frozen=True)
class TrajectoryRequest:
    """A file to read.

    Attributes:
        opened: opens the file, `n_bytes` long, again and again.
        joints_needed: False for a robot that has no joint to move, for which times alone do.
    """

    opened: Opener
    n_bytes: int
    joints_needed: bool = True
    choice: Choice = Choice()


class ReadTrajectory(NamedTuple):
    """A trajectory, and a line each on what was taken how."""

    trajectory: Trajectory
    notes: tuple[str, ...] = ()
