"""Names from any file: what a line of text, a table and a report in XML can show, and that all are different."""

from __future__ import annotations

import unicodedata
from collections.abc import Iterable, Sequence

from clearance.errors import BadInput, BadShape, DuplicateName, UnknownLink, at, nearest_name
from clearance.world.body import Obstacle
from clearance.world.robot import Robot

_BIDIRECTIONAL = frozenset(
    "\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069"
)
"""Characters that turn the direction in which text is drawn, and so what it seems to say."""

_FAULTS = {
    "Cc": "a control character",
    "Cs": "half of a surrogate pair",
    "Zl": "a line separator",
    "Zp": "a paragraph separator",
}


def checked_name(name: str) -> str:
    """The name, if it is text on one line without hidden characters.

    Raises:
        BadInput: with its characters escaped.
    """
    if name.isascii() and name.isprintable():
        return name  # as most are
    for letter in name:
        fault = _fault(letter)
        if fault:
            raise BadInput(f"{name!a:.60} holds {fault}", valid="text on one line is needed")
    return name


def require_own_names(kind: str, names: Sequence[str]) -> None:
    """Refuses two of one kind with one name, which would be one row in a table, and names of several lines.

    Args:
        kind: "link", "joint", "obstacle" or the like, for the message.

    Raises:
        DuplicateName, BadInput: the first that is not, at its place in `names`.
    """
    seen: set[str] = set()
    for i, name in enumerate(names):
        with at(f"{kind}s[{i}]"):
            if checked_name(name) in seen:
                raise DuplicateName(f"two {kind}s have the name {name!r}", valid="each name once")
        seen.add(name)


def _fault(letter: str) -> str:
    if letter in _BIDIRECTIONAL:
        return "a character that turns the direction of text"
    code = ord(letter)
    if code & 0xFFFE == 0xFFFE or 0xFDD0 <= code <= 0xFDEF:
        return "a code that is no character"
    return _FAULTS.get(unicodedata.category(letter), "")


def checked_links(given: Sequence[str], links: Iterable[str]) -> tuple[str, ...]:
    """The given link names, once all are there.

    Raises:
        UnknownLink: with the nearest name.
    """
    known = frozenset(links)
    for i, name in enumerate(given):
        if name not in known:
            raise UnknownLink(
                f"unknown link {name!r}", where=f"[{i}]", valid=nearest_name(name, known)
            )
    return tuple(given)


def require_surfaces(robot: Robot) -> None:
    """Refuses links that are clouds of points."""
    for body in robot.bodies:
        if body.is_cloud:
            raise BadShape(
                f"link {body.name!r} of robot {robot.name!r} is a cloud of points",
                valid="links have surfaces; only obstacles may be clouds",
            )


def require_distinct_names(robots: Sequence[Robot], obstacles: Sequence[Obstacle]) -> None:
    """Refuses names that several links or obstacles share."""
    for i, robot in enumerate(robots):
        if "/" in robot.name:
            raise BadInput(
                f"robot {robot.name!r} has a '/' in its name",
                where=f"robots[{i}]",
                valid="another name, since links of several robots are called robot/link",
            )
    names = {robot.name for robot in robots}
    names |= {f"{robot.name}/{link}" for robot in robots for link in robot.link_names}
    names |= {link for robot in robots for link in robot.link_names}  # as patterns say them
    for i, obstacle in enumerate(obstacles):
        if obstacle.name in names:
            raise DuplicateName(
                f"an obstacle and a robot or its link are both called {obstacle.name!r}",
                where=f"obstacles[{i}]",
                valid="another name for the obstacle",
            )


def require_other_names(robot: Robot, obstacles: Sequence[Obstacle]) -> None:
    """Refuses an obstacle with a link's name where a name could be either's."""
    for obstacle in obstacles:
        if obstacle.name in robot.link_names:
            raise DuplicateName(
                f"an obstacle and a link of robot {robot.name!r} are both called {obstacle.name!r}",
                valid="another name for the obstacle, since links are meant by their names too",
            )
