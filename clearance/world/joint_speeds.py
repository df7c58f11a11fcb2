"""Joints that are faster, or accelerate more, than they may: a warning or, where the case says so, a violation."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from clearance.world.cubic import cubics_of
from clearance.world.joint_positions import JointCourse, joint_courses, turns
from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import NO_LIMIT, MotionLimit, PlacedRobot
from clearance.world.robot import Joint, JointKind
from clearance.world.trajectory import Trajectory

ROUNDING = 1e-6
"""[-] Rounding of a limit: trajectories at a limit are written in six digits or more."""

JUMP = 50.0
"""[-] A joint that is this many times as fast as it may be jumps; paths that were planned without times are up to
15 times as fast, in a third of their intervals."""

ALONE, RARE = 3.0, 20
"""[-] So does one that is this many times as fast, if it is too fast in no more than one of so many intervals, or
if it goes back in most of them, or in more than `RARE` and a third of those, as with the rows of two robots."""

STEP_TURN, STEP_SLIDE = 0.05, 5e-3
"""[rad], [m] A shorter way in an interval is no jump: stamps of recordings that lie close make it fast."""


def notices_on_speed(
    placed: PlacedRobot, rule: str, before: str = "", rounding: float = ROUNDING
) -> list[Notice]:
    """Joints that are faster, or accelerate more, than they may; one notice, and one on jumps, which are suspect.

    If the robot's own file and another one limit a speed, the lower limit counts.

    Args:
        rule: "warn" or "fail", as `Limits.joints`. before: what stands before the names of joints.
        rounding: [-] of a limit; a joint that exceeds it by less is at it.
    """
    asked = placed.trajectory
    if asked is None or asked.n_steps < 2:
        return []
    found = [
        excess
        for course in joint_courses(placed)
        if course.i_column is not None
        for excess in _excesses(placed, course, asked, before, rounding)
    ]
    notices = []
    jumps = [text for is_jump, text in found if is_jump]
    if jumps:
        asks = "does the table jump, lack rows or hold those of two robots, or are its times in another unit?"
        text = f"CHECK LIMITS: {listed(jumps, 4)}; {asks}"
        notices.append(Notice(Severity.SUSPECT, "limits", text))
    if jumps := [*_jumps_of_loop(placed, before)]:
        text = f"CHECK START: a table that begins again (after: loop) ends elsewhere: {listed(jumps, 4)}"
        says = "that way is not measured; end the table where it begins, or give after: hold"
        notices.append(Notice(Severity.SUSPECT, "start", f"{text}; {says}"))
    texts = [text for is_jump, text in found if rule == "fail" or not is_jump]
    if texts and rule == "fail":
        notices.append(Notice(Severity.VIOLATED, "joint limits", listed(texts, 4)))
    elif texts:
        notices.append(Notice(Severity.WARNING, "limits", listed(texts, 4)))
    return notices


def _jumps_of_loop(placed: PlacedRobot, before: str) -> Iterator[str]:
    """Joints that are elsewhere at the end of a table that begins again, and how far, in words."""
    for course in joint_courses(placed) if placed.timing.after == "loop" else ():
        way = abs(float(course.at_samples[-1] - course.at_samples[0]))
        unit, least = ("rad", STEP_TURN) if turns(course.joint) else ("m", STEP_SLIDE)
        if course.joint.kind == JointKind.CONTINUOUS:
            way = abs(math.remainder(way, math.tau))
        if way > least:
            yield f"joint {before + course.joint.name!r} by {way:.3g} {unit}"


def _excesses(
    placed: PlacedRobot, course: JointCourse, asked: Trajectory, before: str, rounding: float
) -> Iterator[tuple[bool, str]]:
    """Whether it is a jump, and what a joint exceeds in words."""
    limit, rate = motion_limit(placed, course.joint), placed.timing.rate
    if limit == NO_LIMIT:
        return
    speed, acceleration = greatest_rates(course, asked)
    unit = "rad" if turns(course.joint) else "m"
    for what, given, most, unit_of in (
        ("moves at", speed * rate, limit.velocity, f"{unit}/s"),
        ("accelerates by", acceleration * rate**2, limit.acceleration, f"{unit}/s²"),
    ):
        n_beyond = int((given > most * (1.0 + rounding)).sum())
        if n_beyond:
            is_jump = what == "moves at" and _jumps(course, given, most, n_beyond)
            yield (
                is_jump,
                f"joint {before + course.joint.name!r} {what} up to {given.max():.3g} {unit_of}, its limit is "
                f"{most:g}, in {n_beyond} of {len(given)} intervals",
            )


def _jumps(course: JointCourse, speeds: np.ndarray, most: float, n_beyond: int) -> bool:
    """True if the greatest speed of a joint, in the run's time, is that of a jump."""
    if speeds.max() > JUMP * most:
        return True
    ways, least = np.diff(course.at_samples), STEP_TURN if turns(course.joint) else STEP_SLIDE
    too_fast = (np.abs(ways) > least) & (speeds > ALONE * most)
    n_back = int((too_fast[1:] & (ways[1:] * ways[:-1] < 0.0)).sum())
    if 2 * n_back > len(speeds) or (n_back > RARE and 3 * n_back > int(too_fast.sum())):
        return True
    return bool(too_fast[int(speeds.argmax())]) and n_beyond * RARE <= len(speeds)


def motion_limit(placed: PlacedRobot, joint: Joint) -> MotionLimit:
    """How fast a joint may move and accelerate: the lower of what its own file and others say."""
    given = placed.motion_limits.get(joint.name, NO_LIMIT)
    return MotionLimit(min(given.velocity, joint.velocity), given.acceleration)


def greatest_rates(course: JointCourse, asked: Trajectory) -> tuple[np.ndarray, np.ndarray]:
    """(n - 1,) the greatest speed and acceleration in each interval, in the table's time.

    The latter is 0 on lines, which have corners.

    Exactness: the speed on a cubic is a parabola, greatest at an end or where it turns; its slope is linear.
        Cubics that are off a quintic by no more than `path_error` = h^4 M / 384 have slopes off by h^3 M / 124 and
        less, and curvatures by h^2 M / 12; that is subtracted, so that the reported value does occur.
    """
    column = slice(course.i_column, (course.i_column or 0) + 1)
    length = np.diff(asked.times)
    scale = abs(course.factor)
    if asked.velocities is None:
        speed = np.abs(np.diff(asked.positions[:, course.i_column])) / length
        return scale * speed, np.zeros_like(speed)
    cubics = cubics_of(asked.times, asked.positions[:, column], asked.velocities[:, column])
    _, step, e0, e1 = (part[:, 0] for part in cubics)
    a, b, c = 3.0 * (e0 + e1), -2.0 * e0 - e1, step + e0  # of a s^2 + 2 b s + c, the derivative
    turns_at = np.divide(-b, a, out=np.zeros_like(a), where=np.abs(a) > np.abs(b))
    inside = np.maximum(turns_at, 0.0)
    speeds = [c, a + 2.0 * b + c, (a * inside + 2.0 * b) * inside + c]
    slopes = [2.0 * b, 2.0 * (a + b)]
    speed = np.abs(speeds).max(axis=0) - 384.0 / 124.0 * asked.path_error
    slope = np.abs(slopes).max(axis=0) - 384.0 / 12.0 * asked.path_error
    return scale * speed / length, scale * slope / length**2
