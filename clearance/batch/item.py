"""One case of a batch, before it is read: where it is, and what is asked of it."""

from __future__ import annotations

from dataclasses import dataclass

from clearance.batch.options import CaseOptions


@dataclass(frozen=True, slots=True)
class GivenTrajectory:
    """A trajectory that a cell is given.

    Attributes:
        path: absolute. reading: how it is read and followed, JSON of `manifest_file.TrajectoryOptions`.
        robot: which moves so; None for the only one.
    """

    path: str
    reading: str
    robot: str | None = None


@dataclass(frozen=True, slots=True)
class Item:
    """One case.

    Attributes:
        number: its place in the batch, from 0.
        name: its own in the batch; the case's too where a cell is given a trajectory.
        file: absolute path of the case file, or of the cell's.
        trajectory: what the cell is given; None where the file is a whole case.
    """

    number: int
    name: str
    file: str
    trajectory: GivenTrajectory | None
    options: CaseOptions
