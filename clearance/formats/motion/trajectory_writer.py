"""A trajectory to a file that `requests` reads back: CSV, or a JointTrajectory message in YAML or JSON.

Every number is written so that it comes back bit for bit; times of messages are whole nanoseconds. What would not
come back is refused. Not for: results (`report`).
"""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from clearance.errors import BadMotion, ClearanceError
from clearance.formats.known_formats import Kind, function_at, written_as
from clearance.formats.message.values import split_time, whole_times
from clearance.formats.motion.requests import parse_trajectory
from clearance.formats.table.column_units import VELOCITY
from clearance.formats.table.csv_table import TIME
from clearance.formats.text.yaml_text import flow
from clearance.world.notice import listed
from clearance.world.trajectory import Points, Trajectory


class WrittenFile(NamedTuple):
    """The content of a file, and a line each on what is not as it was."""

    content: bytes
    notes: tuple[str, ...]


def written(trajectory: Trajectory, shown: str) -> WrittenFile:
    """The content of the file `shown`, in the format of its suffix.

    Raises:
        BadInput: no such format, or names that it cannot hold. BadTime: samples less than a nanosecond apart.
    """
    known = written_as(Kind.TRAJECTORY, shown)
    content = function_at(known.write)(trajectory).encode()
    whole = whole_times(trajectory.written.times.tolist()) if known.is_message else None
    is_rounded = whole is not None and whole.n_rounded > 0
    _refuse_other(trajectory, content, shown, is_rounded)
    notes = [whole.note()] if whole and is_rounded else []
    if trajectory.path_error and not known.is_message:
        notes.append(
            f"its cubics are up to {trajectory.path_error:.1g} rad or m off the motion asked for, "
            "which checks of it do not take off"
        )
    return WrittenFile(content, tuple(notes))


def untold(trajectory: Trajectory, shown: str) -> Iterator[str]:
    """A line on each thing that bears on a verdict and that the file `shown`, of samples alone, cannot say."""
    yield from trajectory.odd
    for hole in trajectory.holes:
        is_within = hole.end > trajectory.times[0] and hole.start < trajectory.times[-1]
        deed = "bridges it by a straight line" if is_within else "leaves it out"
        yield f"{hole.text}; {shown} {deed}"
    is_late_message = written_as(Kind.TRAJECTORY, shown).is_message and not trajectory.start_off
    if trajectory.has_way_in and not is_late_message:
        why = trajectory.start_off and f" ({trajectory.start_off})"
        first = f"{trajectory.times[0]:g} s"
        yield f"how the robot comes to its first point at {first} is not known{why}; {shown} begins there"
    if trajectory.unread:
        yield f"{shown} does not name what is not read: {listed(trajectory.unread, 6)}"


def samples_in(trajectory: Trajectory, shown: str) -> Points | Trajectory:
    """The samples that a file of this name holds: a message has accelerations, a table the samples between."""
    return trajectory.written if written_as(Kind.TRAJECTORY, shown).is_message else trajectory


def csv_text(trajectory: Trajectory) -> str:
    """A table: times, positions, velocities where they are known."""
    header = [TIME, *trajectory.joint_names]
    columns = [trajectory.times[:, None], trajectory.positions]
    if trajectory.velocities is not None:
        header += [name + VELOCITY for name in trajectory.joint_names]
        columns.append(trajectory.velocities)
    return table_text(header, columns)


def table_text(header: Sequence[str], columns: Sequence[np.ndarray]) -> str:
    """CSV: a header, and below it arrays (n, k) beside each other."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(np.hstack(columns).tolist())
    return text.getvalue()


def yaml_text(trajectory: Trajectory) -> str:
    """A message: a line for each list of numbers."""
    names = ", ".join(json.dumps(name, ensure_ascii=False) for name in trajectory.joint_names)
    lines = [f"joint_names: [{names}]", "points:"]
    for point, (seconds, nanoseconds) in _points(trajectory):
        rows = [f"{key}: {flow(values)}" for key, values in point.items()]
        rows.append(f"time_from_start: {{sec: {seconds}, nanosec: {nanoseconds}}}")
        lines += [f"- {rows[0]}", *(f"  {row}" for row in rows[1:])]
    return "\n".join([*lines, ""])


def json_text(trajectory: Trajectory) -> str:
    """The same message in JSON."""
    points = [
        {**point, "time_from_start": {"sec": seconds, "nanosec": nanoseconds}}
        for point, (seconds, nanoseconds) in _points(trajectory)
    ]
    message = {"joint_names": list(trajectory.joint_names), "points": points}
    return json.dumps(message, ensure_ascii=False) + "\n"


def _points(trajectory: Trajectory) -> Iterator[tuple[dict[str, list[float]], tuple[int, int]]]:
    """The values of each point of a message, and its time in seconds and nanoseconds."""
    columns = {k: v for k, v in _columns(trajectory.written).items() if v is not None}
    for i, time in enumerate(trajectory.written.times.tolist()):
        yield {key: values[i].tolist() for key, values in columns.items()}, split_time(time)


def _columns(samples: Points | Trajectory) -> dict[str, np.ndarray | None]:
    accelerations = samples.accelerations if isinstance(samples, Points) else None
    return {
        "positions": samples.positions,
        "velocities": samples.velocities,
        "accelerations": accelerations,
    }


def _refuse_other(trajectory: Trajectory, content: bytes, shown: str, is_rounded: bool) -> None:
    """Nothing, if the file is read back as what was written."""
    try:
        back = parse_trajectory(content, shown)
    except ClearanceError as error:
        raise BadMotion(f"the trajectory cannot be written as {shown!r}: {error}") from None
    asked = samples_in(trajectory, shown)
    given, read = _columns(asked), _columns(back.written)
    same = back.joint_names == trajectory.joint_names and all(
        _same(given[key], read[key]) for key in given
    )
    if not (same and (is_rounded or np.array_equal(back.written.times, asked.times))):
        raise BadMotion(
            f"the names {', '.join(trajectory.joint_names)!r:.80} would be read otherwise from {shown!r}",
            valid="another format",
        )


def _same(a: np.ndarray | None, b: np.ndarray | None) -> bool:
    if a is None or b is None:
        return a is b
    return a.shape == b.shape and a.tobytes() == b.tobytes()
