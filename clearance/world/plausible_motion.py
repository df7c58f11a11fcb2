"""Motions of robots that look like degrees, millimetres or milliseconds."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from clearance.world.joint_positions import JointExtent, joint_extents, turns
from clearance.world.notice import IN_MILLIMETRES, START, Notice, Severity, listed, units
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint
from clearance.world.timing import time_text
from clearance.world.trajectory import Trajectory

LARGE_TURN = 4 * np.pi
"""[rad] Two full turns: more than industrial wrists have, and passed at once by angles given in
degrees.
"""

LARGE_SLIDE = 100.0
"""[m] No slide is so long; in millimetres it is usual."""

TOO_FAST = 10.0
"""Velocities that mean ten times the travel of the positions: degrees are 57 times radians, millimetres 1000."""

LEAST_TRAVEL = 1e-3
"""[rad or m] Travel below this is rest, and says nothing about units."""

CREEP_TURN, CREEP_SLIDE = 4e-3, 4e-4
"""[rad/s], [m/s] Where no joint is ever faster, time is in milliseconds: arms move at 0.1 to 4 rad/s and slides at
1 mm/s and more, a thousandth of which is below this."""

LEAST_TURN, LEAST_SLIDE = 0.05, 5e-3
"""[rad], [m] A joint must go this far in sum before its speed says anything about the unit of time."""


def notices_on_motion(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """Notices on motion of a robot that looks like another unit, and on an unknown start.

    Args:
        before: what stands before the names of joints.
    """
    texts = [*placed.given_trajectory.odd, *_odd_velocities(placed, before)]
    texts += _creeping(placed, before)
    return [
        *notices_on_positions(_as_given(placed), before),
        *_suspect(texts),
        *_way_in(placed),
        *_assumed(placed),
        *_unread(placed),
    ]


def _as_given(placed: PlacedRobot) -> list[JointExtent]:
    """The ranges of joints as their file has them: a joint that turns on and on may be logged within one turn."""
    asked, extents = placed.given_trajectory, joint_extents(placed)
    if asked.given_extents is None:
        return extents
    given = dict(zip(asked.joint_names, asked.given_extents.T.tolist(), strict=True))
    return [JointExtent(one.joint, *given.get(one.joint.name, one[1:])) for one in extents]


def _way_in(placed: PlacedRobot) -> list[Notice]:
    """A notice where the motion to the first sample is unknown; suspect where this is the only sample."""
    asked, about = placed.given_trajectory, placed.robot.name
    first = float(asked.times[0])
    if asked.n_steps < 2 and first > 0.0:
        text = (
            f"the trajectory of robot {about!r} has one sample, at {time_text(first)} s: the motion to this goal "
            "is not measured; give its start at 0 s with trajectory: {start_state: …}, or give the sample the "
            "time 0 to check a single pose"
        )
        return [Notice(Severity.SUSPECT, START, text, about)]
    if not asked.has_way_in:
        return []
    remedy = "; give its start at 0 s with trajectory: {start_state: …}"
    if asked.start_off:
        remedy = (
            f": {asked.start_off}; plan from where the robot is, or give the points later times"
        )
    text = f"not measured: how robot {about!r} comes to its first point at {time_text(first)} s{remedy}"
    return [Notice(Severity.WARNING, START, text, about)]


def _assumed(placed: PlacedRobot) -> list[Notice]:
    """A warning on each thing that was assumed of a controller; suspect are points that say the contrary."""
    about, asked = placed.robot.name, placed.given_trajectory
    found = [Notice(Severity.WARNING, "program", f"assumed: {one}", about) for one in asked.assumed]
    if asked.contradicted:
        first, *others = asked.contradicted
        more = f" (and {len(others)} more)" if others else ""
        text = f"CHECK AXES: {first}{more}; give axes, or axes_as, as the controller has them"
        found.append(Notice(Severity.SUSPECT, "axis", text, about))
    return found


def _unread(placed: PlacedRobot) -> list[Notice]:
    """A warning on what is not read of its file, though it looks like motion, or like parts that it holds."""
    unread, about = placed.given_trajectory.unread, placed.robot.name
    text = (
        f"columns or fields that look like motion of robot {about!r}, or parts that it holds, are not read: "
        f"{listed(unread, 6)}"
    )
    return [Notice(Severity.WARNING, "columns", text, about)] if unread else []


def notices_on_positions(extents: Sequence[JointExtent], before: str = "") -> list[Notice]:
    """Notices on joint positions that look like another unit.

    Args:
        before: what stands before the names of joints.
    """
    return _suspect(_large_positions(extents, before))


def largest_usual(joint: Joint) -> float:
    """[rad] or [m] A joint that goes farther from 0 is suspect."""
    return LARGE_TURN if turns(joint) else LARGE_SLIDE


def _suspect(texts: Sequence[str]) -> list[Notice]:
    return [units(text) for text in texts]


_IN_DEGREES = (
    "If so, write 'NAME [deg]' in the header of the table, or trajectory: {file: …, units: {angle: deg}} "
    "(clearance new --units deg); `clearance convert` makes such a table from a bag or a message; `joints` of a "
    "robot are in radians"
)


def _large_positions(extents: Sequence[JointExtent], before: str) -> list[str]:
    angles: list[tuple[float, str]] = []
    lengths: list[tuple[float, str]] = []
    for joint, low, high in extents:
        greatest = max(abs(low), abs(high))
        if greatest > largest_usual(joint):
            (angles if turns(joint) else lengths).append((greatest, before + joint.name))
    texts = []
    for large, unit, hint in (
        (angles, "rad", f"angles are in radians, is this degrees? {_IN_DEGREES}"),
        (lengths, "m", IN_MILLIMETRES),
    ):
        large.sort(key=lambda item: -item[0])
        goes = listed([f"joint {name!r} goes to {greatest:g} {unit}" for greatest, name in large])
        texts += [f"{goes}; {hint}"] if goes else []
    return texts


def _odd_velocities(placed: PlacedRobot, before: str) -> list[str]:
    """Velocities whose travel is many times that of the positions.

    Those of the file: samples that were added between follow the curves that the velocities make.
    """
    names, asked = placed.given_trajectory.joint_names, placed.given_trajectory.written
    if asked.velocities is None:
        return []
    joints = _moving(placed)
    odd = []
    for i, name in enumerate(names):
        speed = np.abs(asked.velocities[:, i])
        gone = float(np.abs(np.diff(asked.positions[:, i])).sum())
        meant = float((0.5 * (speed[1:] + speed[:-1]) * np.diff(asked.times)).sum())
        if meant > TOO_FAST * max(gone, LEAST_TRAVEL):
            odd.append((joints[name], meant, gone))
    if not odd:
        return []
    joint, meant, gone = odd[0]
    unit, other = ("rad/s", "degrees/s") if turns(joint) else ("m/s", "mm/s")
    others = listed([repr(before + other_joint.name) for other_joint, *_ in odd[1:]])
    return [
        f"the velocities of joint {before + joint.name!r} mean a way of {meant:.3g} where its positions go "
        f"{gone:.3g}"
        f"{f' (the same for {others})' if others else ''}; velocities are in {unit}, is this {other}?"
    ]


def _creeping(placed: PlacedRobot, before: str) -> list[str]:
    """A motion that gets somewhere, but never faster than creeping."""
    asked, joints = placed.given_trajectory, _moving(placed)
    if asked.n_steps < 2:
        return []
    moves = False
    for i, name in enumerate(asked.joint_names):
        turning = turns(joints[name])
        least_travel, creep = (LEAST_TURN, CREEP_TURN) if turning else (LEAST_SLIDE, CREEP_SLIDE)
        travel, speed = _travel_and_speed(asked, i)
        if speed * placed.timing.rate > creep:
            return []
        moves = moves or travel > least_travel
    if not moves:
        return []
    length = float(asked.times[-1] - asked.times[0]) / placed.timing.rate
    whose = f" of robot {before.rstrip('/')!r}" if before else ""
    return [
        f"no joint{whose} moves faster than {CREEP_TURN:g} rad/s or {CREEP_SLIDE * 1000:g} mm/s in {length:g} s; "
        "times are in seconds, is this milliseconds?"
    ]


def _travel_and_speed(asked: Trajectory, i_column: int) -> tuple[float, float]:
    """How far a joint goes in sum [rad or m], and the greatest mean speed between two samples."""
    ways = np.abs(np.diff(asked.positions[:, i_column]))
    return float(ways.sum()), float((ways / np.diff(asked.times)).max(initial=0.0))


def greatest_speeds(placed: PlacedRobot) -> tuple[float, float]:
    """[m/s], [rad/s] The greatest mean speeds in the run, between samples, of joints that slide and that turn."""
    asked, joints = placed.given_trajectory, _moving(placed)
    greatest = {True: 0.0, False: 0.0}
    for i, name in enumerate(asked.joint_names):
        turning, (_, speed) = turns(joints[name]), _travel_and_speed(asked, i)
        greatest[turning] = max(greatest[turning], speed * placed.timing.rate)
    return greatest[False], greatest[True]


def _moving(placed: PlacedRobot) -> dict[str, Joint]:
    return {joint.name: joint for joint in placed.robot.moving_joints}
