"""Where in which trajectory file a finding is least: its file, and its line where that is a table.

Not for: reading trajectories (`formats`).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.findings.finding import Finding
from clearance.formats.motion.trajectory_file import line_of_sample
from clearance.record.record import Record
from clearance.world.case import PlacedRobot


@dataclass(frozen=True)
class TrajectoryRow:
    """A row of a trajectory file; `line` counts from 1, and is None where the file is no table."""

    path: str
    line: int | None


def row_of(record: Record, finding: Finding) -> TrajectoryRow | None:
    """The row at or before the moment of a finding, in the file of the robot that it is of, or of the first one
    that has one; None where no trajectory is from a file."""
    own = [placed for placed in record.case.robots if placed.trajectory_path]
    if not own or finding.time is None:
        return None
    placed = next((one for one in own if _is_of(record, one, finding)), own[0])
    sample = sample_at(placed, finding.time)
    return TrajectoryRow(placed.trajectory_path, line_of_sample(placed.trajectory_path, sample))


def _is_of(record: Record, placed: PlacedRobot, finding: Finding) -> bool:
    before = record.case.prefix_of(placed)
    links = {before + link for link in placed.robot.link_names}
    return bool(links & {finding.body_a, finding.body_b})


def sample_at(placed: PlacedRobot, time: float) -> int:
    """The last sample of a robot's table at or before a time of the run [s]; the first before all of them."""
    times, timing = placed.given_trajectory.times, placed.timing
    own = (time - timing.start) * timing.rate
    span = float(times[-1] - times[0])
    if timing.after == "loop" and span > 0.0 and own > times[-1]:
        own = float(times[0]) + (own - float(times[0])) % span
    rounding = 1e-9 * max(1.0, abs(own))
    return max(0, int(np.searchsorted(times, own + rounding, side="right")) - 1)
