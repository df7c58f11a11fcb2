"""Links and joints in order: one root, parents before children. Not for: what joints do."""

from __future__ import annotations

from collections.abc import Sequence

from clearance.errors import BadRobot, UnknownLink, nearest_name
from clearance.world.robot import Joint


def links_from_root(
    names: Sequence[str], joints: Sequence[Joint]
) -> tuple[tuple[str, ...], tuple[Joint, ...]]:
    """Link names, the root first and parents before children, and the joint above each but the
    first.

    Ties: children of one link come in the order of their joints in the file.

    Raises:
        UnknownLink: a joint's parent or child is not there. BadInput: no links, several roots, a
            link with two parents, or a circle.
    """
    if not names:
        raise BadRobot("the robot has no links", valid="at least one <link> is needed")
    above = _joint_above(names, joints)
    roots = [name for name in names if name not in above]
    if len(roots) > 1:
        raise BadRobot(
            f"links {', '.join(repr(root) for root in roots[:5])} have no parent",
            valid="one root is needed: join the others by joints",
        )
    below: dict[str, list[Joint]] = {name: [] for name in names}
    for joint in joints:
        below[joint.parent].append(joint)
    ordered = _reached(roots, below)
    if len(ordered) < len(names):
        found = frozenset(ordered)
        lost = [name for name in names if name not in found]
        raise BadRobot(
            f"links {', '.join(repr(name) for name in lost[:5])} hang in a circle of joints",
            valid="a tree is needed",
        )
    return tuple(ordered), tuple(above[name] for name in ordered[1:])


def _joint_above(names: Sequence[str], joints: Sequence[Joint]) -> dict[str, Joint]:
    above: dict[str, Joint] = {}
    known = frozenset(names)
    for joint in joints:
        for end, link in (("parent", joint.parent), ("child", joint.child)):
            if link not in known:
                raise UnknownLink(
                    f"unknown {end} link {link!r}",
                    where=f"joint {joint.name!r}",
                    valid=nearest_name(link, names),
                )
        if joint.child in above:
            raise BadRobot(
                f"link {joint.child!r} is the child of joints "
                f"{above[joint.child].name!r} and {joint.name!r}",
                valid="one parent for each link",
            )
        above[joint.child] = joint
    return above


def _reached(roots: list[str], below: dict[str, list[Joint]]) -> list[str]:
    """Links from the root down, depth first."""
    ordered, waiting = [], list(reversed(roots))
    while waiting:
        name = waiting.pop()
        ordered.append(name)
        waiting.extend(joint.child for joint in reversed(below[name]))
    return ordered
