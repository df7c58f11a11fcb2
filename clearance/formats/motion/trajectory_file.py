"""A trajectory file to a trajectory, by the reader of its format.

Not for: which joints the robot has (`world.moving_joints`).
"""

from __future__ import annotations

import io

from clearance.errors import at
from clearance.formats.known_formats import Kind, format_of, function_at
from clearance.formats.motion.trajectory_request import Choice, ReadTrajectory, TrajectoryRequest
from clearance.world.trajectory import Trajectory


def read_trajectory(request: TrajectoryRequest, shown: str) -> ReadTrajectory:
    """The samples in a file that is no bag; notes begin with the file's name.

    Args:
        shown: the file's name, in errors too.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        known = format_of(Kind.TRAJECTORY, shown)
        assert known is not None  # as any file is CSV where nothing says otherwise
        trajectory, notes = function_at(known.read)(request)
    return ReadTrajectory(trajectory, tuple(f"{shown}: {note}" for note in notes))


def parse_trajectory(data: bytes, shown: str, choice: Choice | None = None) -> Trajectory:
    """The samples in the content of a file, as `read_trajectory` finds them in the file."""
    request = TrajectoryRequest(lambda: io.BytesIO(data), len(data), choice=choice or Choice())
    return read_trajectory(request, shown).trajectory
