"""Joints beyond their limits: a warning or, where the case says so, a violation; far beyond is suspect."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.world.joint_positions import (
    JointCourse,
    extremes_of,
    joint_courses,
    turns,
)
from clearance.world.notice import Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint
from clearance.world.trajectory import Trajectory

ROUNDING = 1e-9
"""[rad or m] A joint that is beyond its limit by less than this is at it."""

FAR_TURN = np.pi / 2
"""[rad] A quarter turn beyond a limit is no overshoot: of 69 robots none is as far beyond at its zero pose."""

FAR_SLIDE = 0.05
"""[m] A slide this far beyond, and farther than its whole range, is in another unit."""


class _Excess(NamedTuple):
    joint: Joint
    name: str
    beyond: float  # [rad or m]
    text: str


def notices_on_joints(placed: PlacedRobot, rule: str, before: str = "") -> list[Notice]:
    """Joints beyond their limits, at the samples or between them, or where the robot stands.

    Args:
        rule: "warn" or "fail", as `Limits.joints`. before: what stands before the names of joints.
    """
    asked = placed.trajectory
    found = [
        excess for course in joint_courses(placed) for excess in _excesses(course, asked, before)
    ]
    far = [excess for excess in found if excess.beyond > far_beyond(excess.joint)]
    near = [excess for excess in found if excess not in far]
    notices = []
    if far:
        text = f"CHECK LIMITS: {_in_words(far)}; is this another unit, or another robot?"
        notices.append(Notice(Severity.SUSPECT, "limits", text))
    if found and placed.self_clearance is not None and placed.self_clearance.trust_never:
        text = "CHECK LIMITS: trust_never excuses pairs that never meet within the limits of joints"
        notices.append(Notice(Severity.SUSPECT, "limits", f"{text}, and {_in_words(found)}"))
    if rule == "fail" and found:
        about = placed.robot.name
        notices.append(Notice(Severity.VIOLATED, "joint limits", _in_words(found), about))
    elif near:
        notices.append(Notice(Severity.WARNING, "limits", _in_words(near)))
    return notices


def _excesses(course: JointCourse, asked: Trajectory | None, before: str) -> list[_Excess]:
    joint, name = course.joint, before + course.joint.name
    rounding = ROUNDING + (0.0 if asked is None else abs(course.factor) * asked.path_error)
    at_samples = _beyond(joint, course.at_samples, course.at_samples)
    n_beyond = int((at_samples > rounding).sum())
    excesses = []
    if n_beyond:
        where = (
            f"in {n_beyond} of {len(at_samples)} steps"
            if course.i_column is not None
            else "all the time"
        )
        excesses.append(_excess(joint, name, at_samples, where))
    reached = extremes_of(course, asked)
    if reached is None:
        return excesses
    ends = np.maximum(0.0, np.maximum(at_samples[:-1], at_samples[1:]))
    between = _beyond(joint, *reached)
    farther = between > ends + rounding
    if farther.any():
        where = (
            "between two samples, on the cubic that its velocities make, "
            f"in {int(farther.sum())} of {len(between)} intervals"
        )
        excesses.append(_excess(joint, name, between[farther], where))
    return excesses


def _beyond(joint: Joint, least: np.ndarray, greatest: np.ndarray) -> np.ndarray:
    return np.maximum(greatest - joint.upper, joint.lower - least)


def _excess(joint: Joint, name: str, beyond: np.ndarray, where: str) -> _Excess:
    unit = "rad" if turns(joint) else "m"
    most = float(beyond.max())
    return _Excess(
        joint,
        name,
        most,
        f"joint {name!r} leaves its limits {joint.lower:g} to {joint.upper:g} {unit} "
        f"by up to {most:.3g} {unit} {where}",
    )


def far_beyond(joint: Joint) -> float:
    """[rad or m] A joint that is farther beyond a limit is suspect."""
    return FAR_TURN if turns(joint) else max(FAR_SLIDE, joint.upper - joint.lower)


def _in_words(found: list[_Excess]) -> str:
    """One line; the joint that is farthest beyond comes first where there are several."""
    ordered = sorted(found, key=lambda excess: -excess.beyond)
    names = {excess.name for excess in found}
    if len(names) == 1:
        return "; ".join(excess.text for excess in found)
    others = [repr(excess.name) for excess in ordered]
    rest = listed(list(dict.fromkeys(others))[1:], 6)
    return f"{len(names)} joints leave their limits: {ordered[0].text}; also {rest}"
