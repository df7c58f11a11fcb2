"""The motion of the robots that was measured, as a file: a JointTrajectory message in YAML or JSON, one document a
robot, or a CSV table. Not for: how it is written (`formats.motion.trajectory_writer`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import PurePath

from clearance.errors import BadInput, at
from clearance.formats.known_formats import Kind, written_as
from clearance.formats.motion.trajectory_writer import WrittenFile, untold, written
from clearance.world.motion import Motion
from clearance.world.notice import NOT_MEASURED
from clearance.world.placed_robot import PlacedRobot
from clearance.world.trajectory import Trajectory


def require_motion_file(robots: Sequence[PlacedRobot], shown: str) -> None:
    """Nothing, if the robots' motion goes into a file of this name.

    Raises:
        BadInput: no such format, no robot that moves, or several in a table.
    """
    known = written_as(Kind.TRAJECTORY, shown)
    moving = [placed for placed in robots if placed.robot.moving_joints]
    if not moving:
        raise BadInput("no robot has a joint that moves", where=shown, valid="a robot with joints")
    if len(moving) > 1 and not known.is_message:
        raise BadInput(
            f"a table holds one robot, the case has {len(moving)}",
            where=shown,
            valid="a .yaml file, which holds all",
        )


def motion_content(motions: Sequence[Motion], shown: str) -> WrittenFile:
    """The motions as a file of this name, in the order of the case; a robot without joints that move is left out.

    Every number comes back bit for bit; what would not is refused, times that are rounded are a note.

    Raises:
        BadInput: as `require_motion_file`, or a name that does not come back. BadTime: steps less than a
            nanosecond apart, in a message.
    """
    require_motion_file([motion.placed for motion in motions], shown)
    is_yaml = PurePath(shown).suffix.lower() in (".yaml", ".yml")
    parts: list[bytes] = []
    notes: list[str] = []
    for motion in motions:
        if not motion.joint_names:
            continue
        trajectory = Trajectory(
            motion.times, motion.joint_names, motion.positions, motion.velocities
        )
        with at(motion.placed.robot.name):
            content, changes = written(trajectory, shown)
        if len(motions) > 1 and is_yaml:
            content = f"# {motion.placed.robot.name}\n".encode() + content
        parts.append(content)
        notes += (*changes, *_untold(motion, shown), *_nominal(motion))
    between = b"---\n" if is_yaml else b""
    return WrittenFile(between.join(parts), tuple(dict.fromkeys(notes)))


def _untold(motion: Motion, shown: str) -> list[str]:
    """Notes on what the verdict says of the trajectory and the file does not, as holes that are not measured."""
    asked = motion.placed.trajectory
    if asked is None:
        return []
    holes = tuple(hole for hole in asked.holes if hole.means == NOT_MEASURED)
    return [*untold(replace(asked, holes=holes), shown)]


def _nominal(motion: Motion) -> list[str]:
    """A note on corner zones: the file holds one path through each, and the verdict counts all of them."""
    asked = motion.placed.trajectory
    n = 0 if asked is None else len(asked.corners)
    if n == 0:
        return []
    zones = "1 corner zone" if n == 1 else f"{n} corner zones"
    return [
        f"one path through {zones} of the program; the others, which the verdict counts, are not in this file"
    ]
