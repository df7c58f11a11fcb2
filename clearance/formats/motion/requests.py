"""What readers of trajectories and of poses are asked for and give, the reader of a file by its format, and the
line of a table that a sample is on.

Not for: the formats (`known_formats`), which joints the robot has (`world.robot`), nor when poses are followed
(`timed_files`).
"""

from __future__ import annotations

import io
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import NamedTuple

import numpy as np

from clearance.errors import at
from clearance.formats.known_formats import BAGS, Kind, format_of, function_at
from clearance.formats.message.values import NANO
from clearance.formats.schema.timed import Choice
from clearance.formats.table.csv_table import Opener, first_row, line_of_row
from clearance.formats.table.table_start import as_written
from clearance.formats.text.notes import note_on_rounded
from clearance.geometry.quaternions import of_unit_length
from clearance.world.pose_table import PoseTable
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


@dataclass(frozen=True)
class PoseRequest:
    """A file to read.

    Attributes:
        opened: opens the file, again and again.
        length: of lengths that name no unit themselves, "m" or "mm"; None where the case says nothing.
    """

    opened: Opener
    length: str | None = None


@dataclass(frozen=True, eq=False)
class PoseSamples:
    """What a file of poses says, number by number.

    Attributes:
        times: (n,) [s]. positions: (n, 3) [m]. quaternions: (n, 4) xyzw, before they are made of length one.
        frame, child: names of the reference frame and of the frame that moves, where messages have them.
        stamp: [ns] of the first sample in a file of messages, whose times count from there.
    """

    times: np.ndarray
    positions: np.ndarray
    quaternions: np.ndarray
    frame: str = ""
    child: str = ""
    stamp: int = 0

    def table(self) -> PoseTable:
        """What a body follows.

        Raises:
            BadTime, BadPose, NotFinite: samples that nothing can follow.
        """
        began = self.stamp / NANO if self.stamp else None
        return PoseTable(
            self.times, self.positions, self.quaternions, frame=self.frame, began=began
        )


class ReadSamples(NamedTuple):
    """What a file says, and a line each on what was taken how."""

    samples: PoseSamples
    notes: tuple[str, ...] = ()


def samples_of(written: PoseSamples, notes: tuple[str, ...]) -> ReadSamples:
    """What a file says, its quaternions of three digits or so made of length one, with a note."""
    quaternions, n_rounded = of_unit_length(written.quaternions)
    samples = replace(written, quaternions=quaternions)
    return ReadSamples(samples, (*notes, *note_on_rounded(n_rounded)))


def read_samples(request: PoseRequest, shown: str) -> ReadSamples:
    """The samples in a file, as they stand there, which something can follow.

    Args:
        shown: the file's name, in errors.

    Raises:
        BadInput: as the reader says, with the place in the file.
    """
    with at(shown):
        known = format_of(Kind.POSES, shown)
        assert known is not None  # as any file is CSV where nothing says otherwise
        found: ReadSamples = function_at(known.read)(request)
        found.samples.table()  # which raises, where nothing can follow them
    return found
