"""A trajectory file to a trajectory, by the reader of its suffix: a further format is a file and a row here.

Not for: which joints the robot has (`world.moving_joints`).
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import PurePath

from clearance.errors import at
from clearance.formats.motion.trajectory_csv import read_csv
from clearance.formats.motion.trajectory_request import Choice, ReadTrajectory, TrajectoryRequest
from clearance.world.trajectory import Trajectory


def _json(request: TrajectoryRequest) -> ReadTrajectory:
    from clearance.formats.motion.joint_trajectory_file import read_json_trajectory

    return read_json_trajectory(request)


def _yaml(request: TrajectoryRequest) -> ReadTrajectory:
    from clearance.formats.motion.joint_trajectory_file import read_yaml_trajectory

    return read_yaml_trajectory(request)


READERS: dict[str, Callable[[TrajectoryRequest], ReadTrajectory]] = {
    ".csv": read_csv,
    ".json": _json,
    ".yaml": _yaml,
    ".yml": _yaml,
}
"""By suffix in small letters; a file of another suffix is read as CSV."""


def read_trajectory(request: TrajectoryRequest, shown: str) -> ReadTrajectory:
    """The samples in a file; notes begin with the file's name.

    Args:
        shown: the file's name, in errors too.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        reader = READERS.get(PurePath(shown).suffix.lower(), read_csv)
        trajectory, notes = reader(request)
    return ReadTrajectory(trajectory, tuple(f"{shown}: {note}" for note in notes))


def parse_trajectory(data: bytes, shown: str, choice: Choice | None = None) -> Trajectory:
    """The samples in the content of a file, as `read_trajectory` finds them in the file."""
    request = TrajectoryRequest(lambda: io.BytesIO(data), len(data), choice=choice or Choice())
    return read_trajectory(request, shown).trajectory
