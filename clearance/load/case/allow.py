"""Names that a case takes from robots and scene: a typing error must not be a silent gap."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from clearance.errors import BadInput, UnknownLink, UnknownObstacle, at, nearest_name
from clearance.late_dataclass import dataclass
from clearance.world.case import Case
from clearance.world.rules import Allowance, matches

_WILDCARDS = frozenset("*?[")


@dataclass(frozen=True)
class PatternNames:
    """What patterns of a case may match.

    Attributes:
        table_links: links as tables name them: `robot/link` where there are several robots.
        links: those, and of several robots the links alone too. obstacles: of the scene.
        links_meet: links are measured against links. obstacles_meet: obstacles are against obstacles.
    """

    table_links: tuple[str, ...]
    links: tuple[str, ...]
    obstacles: tuple[str, ...]
    links_meet: bool
    obstacles_meet: bool


def body_names(case: Case) -> PatternNames:
    """The names of a case's bodies."""
    several = len(case.robots) > 1
    alone = [link for placed in case.robots for link in placed.robot.link_names]
    table_links = [
        case.prefix_of(placed) + link for placed in case.robots for link in placed.robot.link_names
    ]
    mounted = any(placed.mount is not None for placed in case.robots)
    return PatternNames(
        tuple(table_links),
        tuple(dict.fromkeys([*table_links, *alone])),
        tuple(obstacle.name for obstacle in case.obstacles),
        links_meet=several or any(placed.self_clearance for placed in case.robots),
        obstacles_meet=bool(case.carries)
        or mounted
        or any(not obstacle.stands for obstacle in case.obstacles),
    )


def require_allowances(rows: Sequence[Allowance], names: PatternNames) -> None:
    """Nothing, if each pattern matches a body that it can be of: the first a link where one of the pair is.

    Raises:
        UnknownLink, UnknownObstacle: nothing matches, with the nearest name.
    """
    first = names.links + (names.obstacles if names.obstacles_meet else ())
    second = names.obstacles + (names.links if names.links_meet else ())
    for i, row in enumerate(rows):
        with at(f"allow[{i}]"):
            _refuse_turned_round(*row.between, names)
            what = "body" if names.obstacles_meet else "link"
            _refuse_unmatched(row.between[0], first, what, UnknownLink)
            what = "body" if names.links_meet and names.obstacles_meet else "obstacle"
            _refuse_unmatched(row.between[1], second, what, UnknownObstacle)


def require_patterns(given: Sequence[str], names: PatternNames) -> None:
    """Nothing, if each pattern matches a body.

    Raises:
        UnknownLink: nothing matches, with the nearest name.
    """
    for i, pattern in enumerate(given):
        with at(f"[{i}]"):
            _refuse_unmatched(pattern, names.links + names.obstacles, "body", UnknownLink)


def require_link_patterns(given: Sequence[str], links: Iterable[str]) -> None:
    """Nothing, if each pattern matches a link.

    Raises:
        UnknownLink: nothing matches, with the nearest name.
    """
    known = tuple(links)
    for i, pattern in enumerate(given):
        with at(f"[{i}]"):
            _refuse_unmatched(pattern, known, "link", UnknownLink)


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


def _refuse_turned_round(first: str, second: str, names: PatternNames) -> None:
    """Refuses an obstacle before a link, which would be of no pair."""
    is_obstacle = _matches(first, names.obstacles) and not _matches(first, names.links)
    is_link = _matches(second, names.links) and not _matches(second, names.obstacles)
    if is_obstacle and is_link:
        raise UnknownLink(
            f"{first!r} is an obstacle and {second!r} a link", valid="the link comes first"
        )


def _matches(pattern: str, names: Iterable[str]) -> bool:
    return any(matches(name, pattern) for name in names)


def _refuse_unmatched(
    pattern: str, names: tuple[str, ...], what: str, fault: type[BadInput]
) -> None:
    if _matches(pattern, names):
        return
    problem = f"no {what} matches" if _WILDCARDS & set(pattern) else f"unknown {what}"
    raise fault(f"{problem} {pattern!r}", valid=nearest_name(pattern, names))
