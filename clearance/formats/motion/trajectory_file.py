"""What a reader of trajectories is asked for and gives, the reader of a file by its format, and the line of a
table that a sample is on.

Not for: the formats (`known_formats`), nor which joints the robot has (`world.robot`).
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

from clearance.errors import at
from clearance.formats.known_formats import BAGS, Kind, format_of, function_at
from clearance.formats.schema.timed import Choice
from clearance.formats.table.csv_table import Opener, first_row, line_of_row
from clearance.formats.table.table_start import as_written
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory


@dataclass(frozen=True)
class TrajectoryRequest:
    """A file to read.

    Attributes:
        opened: opens the file, again and again.
        joints_needed: False for a robot that has no joint to move, for which times alone do.
        turns: of each joint that moves, whether it turns; empty where the robot is not known.
        robot: whose joints those of a table must be; None where it is not known.
    """

    opened: Opener
    joints_needed: bool = True
    choice: Choice = field(default_factory=Choice)
    turns: Mapping[str, bool] = field(default_factory=dict)
    robot: Robot | None = None


class ReadTrajectory(NamedTuple):
    """A trajectory, and a line each on what was taken how."""

    trajectory: Trajectory
    notes: tuple[str, ...] = ()


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
    request = TrajectoryRequest(lambda: io.BytesIO(data), choice=choice or Choice())
    return read_trajectory(request, shown).trajectory


def line_of_sample(path: str, sample: int) -> int | None:
    """The line, from 1, of a sample, from 0; None in a file that is no table, or has no such row any more."""
    known = format_of(Kind.TRAJECTORY, path)
    if known is None or known.name != "CSV" or not Path(path).is_file():
        return None
    table = as_written(lambda: open(path, "rb"))
    try:
        if table.float_of("".join(first_row(table)[:1])) is not None:
            table = table._replace(names=("",))  # the first row is numbers: there is no header
        return line_of_row(table, sample)
    except (AssertionError, ValueError):  # it was written anew since it was read
        return None


def is_bag(path: Path) -> bool:
    """Whether a path is that of a bag: a folder, or a file by its suffix."""
    return path.suffix.lower() in BAGS or path.is_dir()


def files_of(path: Path) -> list[Path]:
    """The files of a bag."""
    if not path.is_dir():
        return [path]
    return sorted(one for one in path.iterdir() if one.is_file() and not one.name.startswith("."))
