"""Columns of a trajectory table that hold a quaternion, for a joint that turns by yaw, pitch and roll.

A free base is logged as `base/qx` to `base/qw` where its joint `base` goes by `base/yaw`, `base/pitch` and
`base/roll`. Not for: tables of poses (`pose_table_file`), which keep their quaternions.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from clearance.errors import BadInput
from clearance.formats.motion.pose_table_file import refuse_off_length_one
from clearance.formats.table.csv_table import TextTable, line_of_row
from clearance.formats.text.notes import note_on_rounded
from clearance.geometry.quaternions import of_unit_length, yaw_pitch_roll
from clearance.world.notice import listed

PARTS, ANGLES = ("/qx", "/qy", "/qz", "/qw"), ("/yaw", "/pitch", "/roll")

STEEPEST = np.radians(85.0)
"""[rad] Beyond this pitch yaw and roll jump between two samples though the body turns little."""


def turned_joints(names: Sequence[str], turns: Mapping[str, bool]) -> list[str]:
    """The joints with all four columns that the robot, if known, moves by yaw, pitch and roll."""
    stems = dict.fromkeys(name[: -len(PARTS[0])] for name in names if name.endswith(PARTS))
    return [
        stem
        for stem in stems
        if all(stem + part in names for part in PARTS)
        and (not turns or all(stem + angle in turns for angle in ANGLES))
    ]


def joints_by_angles(names: Sequence[str], turned: Sequence[str]) -> tuple[str, ...]:
    """The names, angles in place of the quaternions of some joints."""
    found: list[str] = []
    for name in names:
        stem = name[: -len(PARTS[0])] if name.endswith(PARTS) else ""
        if stem not in turned:
            found.append(name)
        elif name.endswith(PARTS[0]):
            found += [stem + angle for angle in ANGLES]
    return tuple(found)


def by_angles(
    values: np.ndarray, names: Sequence[str], turned: Sequence[str], table: TextTable
) -> tuple[np.ndarray, list[str]]:
    """(n, k) the values for the names of `joints_by_angles`, from the values for `names`; and notes.

    Angles go the shortest way from one sample to the next.

    Raises:
        BadPose: a quaternion that is not of length one, with its line. BadInput: a pitch of nearly a quarter turn.
    """
    columns = {name: values[:, i] for i, name in enumerate(names)}
    notes, n_rounded = [], 0
    for stem in turned:
        given = np.column_stack([columns[stem + part] for part in PARTS])
        refuse_off_length_one(given, table)
        unit, n_own = of_unit_length(given)
        angles = yaw_pitch_roll(unit)
        steep = np.flatnonzero(np.abs(angles[:, 1]) > STEEPEST)
        if len(steep):
            raise BadInput(
                f"{stem!r} is pitched by {np.degrees(angles[steep[0], 1]):.1f} degrees, where yaw and roll are "
                "not distinct",
                where=f"line {line_of_row(table, int(steep[0]))}",
                valid="an obstacle that `moves` by a table of poses, and the robot's base on it",
            )
        columns |= zip((stem + angle for angle in ANGLES), np.unwrap(angles, axis=0).T, strict=True)
        n_rounded += n_own
    if turned:
        told = listed([repr(stem) for stem in turned])
        notes.append(
            f"quaternions of {told} are read as yaw, pitch and roll, each interpolated on its own"
        )
    found = [columns[name] for name in joints_by_angles(names, turned)]
    return np.column_stack(found), [*notes, *note_on_rounded(n_rounded)]
