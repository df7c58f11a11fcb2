"""A trajectory file to a trajectory, by the reader of its suffix: a further format is a file and a row here.

Not for: which joints the robot has (`world.moving_joints`).
"""

from __future__ import annotations

import io
from collections.abc import Callable
from pathlib import PurePath

from clearance.errors import at
from clearance.load.csv_table import Opener
from clearance.load.trajectory_csv import read_csv
from clearance.world.trajectory import Trajectory

READERS: dict[str, Callable[[Opener, int, bool], Trajectory]] = {
    ".csv": read_csv,
}
"""By suffix in small letters; a file of another suffix is read as CSV."""


def read_trajectory(
    opened: Opener, n_bytes: int, shown: str, *, joints_needed: bool = True
) -> Trajectory:
    """The samples in a file.

    Args:
        opened: opens the file, `n_bytes` long, again and again.
        shown: the file's name, in errors too.
        joints_needed: False for a robot that has no joint to move, for which times alone do.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        return READERS.get(PurePath(shown).suffix.lower(), read_csv)(opened, n_bytes, joints_needed)


def parse_trajectory(data: bytes, shown: str) -> Trajectory:
    """The samples in the content of a file, as `read_trajectory` finds them in the file."""
    return read_trajectory(lambda: io.BytesIO(data), len(data), shown)
