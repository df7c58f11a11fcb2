"""Equality constraints of an MJCF model as joints that follow others, and what is not followed.

Not for: closed loops and tendons, which are left out and told of (`robot`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from clearance.formats.robot.mjcf.model import MjcfFollower, MjcfModel
from clearance.world.notice import Notice, Severity
from clearance.world.robot import Joint, Mimic


def with_followers(
    joints: Sequence[Joint], model: MjcfModel
) -> tuple[list[Joint], list[str], list[Notice]]:
    """The joints, those that follow one as a line with their mimic; notes, and warnings on what is not followed.

    MuJoCo counts both joints from their references: y - y0 = a0 + a1 (x - x0).
    """
    references = {joint.name: joint.reference for joint in model.joints}
    found = {joint.name: joint for joint in joints}
    notes: list[str] = []
    notices: list[Notice] = []
    for row in model.follows:
        why = _why_not(row, found)
        if not row.active:
            notes.append(f"the equality of joint {row.joint!r} is not active and not followed")
        elif why:
            notices.append(_not_followed(row, why))
        elif row.master is None:
            value = references[row.joint] + row.polynomial[0]
            notices.append(_not_followed(row, f"it is held at {value:g}"))
        else:
            a0, a1 = row.polynomial[:2]
            offset = references[row.joint] + a0 - a1 * references[row.master]
            found[row.joint] = replace(found[row.joint], mimic=Mimic(row.master, a1, offset))
            notes.append(
                f"joint {row.joint!r} follows {row.master!r} by an equality, as if it were rigid"
            )
    return [found[joint.name] for joint in joints], notes, notices


def _why_not(row: MjcfFollower, joints: dict[str, Joint]) -> str:
    for name in (row.joint, row.master):
        if name is not None and name not in joints:
            return f"joint {name!r} has several degrees of freedom"
    if joints[row.joint].mimic is not None:
        return f"it follows {joints[row.joint].mimic.joint!r} already"  # type: ignore[union-attr]
    if any(row.polynomial[2:]):
        return "it is no line but a polynomial"
    return ""


def _not_followed(row: MjcfFollower, why: str) -> Notice:
    text = (
        f"the equality of joint {row.joint!r} is not followed: {why}; give the joint its own values"
    )
    return Notice(Severity.WARNING, "equality", text)
