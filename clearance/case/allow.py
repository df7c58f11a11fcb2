"""Rows of a case file that speak of pairs and parts, to those of the world, and the names that they take from
robots and scene: a typing error must not be a silent gap.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

from clearance.errors import BadInput, UnknownLink, UnknownObstacle, at, nearest_name
from clearance.formats.schema import case as schema
from clearance.world.carry import Carry
from clearance.world.case import Case, Limits
from clearance.world.rules import Allowance, Rule, matches

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


def checked_allowances(rows: Sequence[Allowance], names: PatternNames) -> tuple[Allowance, ...]:
    """The rows, the link first where one of a pair is a link, once each pattern matches a body that it can be of.

    Raises:
        UnknownLink, UnknownObstacle: nothing matches, with the nearest name.
    """
    first = names.links + (names.obstacles if names.obstacles_meet else ())
    second = names.obstacles + (names.links if names.links_meet else ())
    found = tuple(_link_first(row, names) for row in rows)
    for i, row in enumerate(found):
        with at(f"allow[{i}]"):
            what = "body" if names.obstacles_meet else "link"
            _refuse_unmatched(row.between[0], first, what, UnknownLink)
            what = "body" if names.links_meet and names.obstacles_meet else "obstacle"
            _refuse_unmatched(row.between[1], second, what, UnknownObstacle)
    return found


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


def _link_first(row: Allowance, names: PatternNames) -> Allowance:
    """The row; turned round where it is of an obstacle and a link, and of no pair as it stands."""
    first, second = row.between
    if not _matches(first, names.obstacles) or _matches(second, names.obstacles):
        return row
    is_link, is_known = _matches(first, names.links), _matches(second, names.links)
    stays = is_known and names.links_meet if is_link else not is_known and names.obstacles_meet
    return row if stays else replace(row, between=(second, first))


def _matches(pattern: str, names: Iterable[str]) -> bool:
    return any(matches(name, pattern) for name in names)


def _refuse_unmatched(
    pattern: str, names: tuple[str, ...], what: str, fault: type[BadInput]
) -> None:
    if _matches(pattern, names):
        return
    problem = f"no {what} matches" if _WILDCARDS & set(pattern) else f"unknown {what}"
    raise fault(f"{problem} {pattern!r}", valid=nearest_name(pattern, names))


def limits_of(given: schema.Limits) -> Limits:
    """The limits; a rule that gives no `fail` has that of the limits.

    Raises:
        BadDimension: a rule whose `warn` is below its `fail`. DuplicateName: two rules of one name.
    """
    rules = []
    for i, row in enumerate(given.rules):
        with at(f"limits.rules[{i}]"):
            rules.append(_rule(row))
    with at("limits"):
        return Limits(given.fail, given.warn, given.joints, tuple(rules))  # type: ignore[arg-type]


def _rule(row: schema.Rule) -> Rule:
    name = row.name or ""
    return Rule(row.patterns, row.window, row.while_carried, name, row.fail, row.warn)


def allowances_of(given: Sequence[schema.AllowedPair]) -> tuple[Allowance, ...]:
    """The pairs that are not measured."""
    return tuple(Allowance(row.patterns, row.window, row.while_carried) for row in given)


def carries_of(given: Sequence[schema.Carry], obstacles: Sequence[str]) -> tuple[Carry, ...]:
    """What is carried; of an object of several shapes (`name/0`, `name/1`) each.

    Args:
        obstacles: their names.

    Raises:
        BadInput: a part that carries itself.
    """
    carries = []
    for i, row in enumerate(given):
        with at(f"carry[{i}]"):
            is_exact = row.grasp == "exact"
            shapes = [name for name in obstacles if name.startswith(f"{row.part}/")]
            for part in [row.part] if row.part in obstacles or not shapes else shapes:
                carries.append(Carry(part, row.by, row.window, tuple(row.touch), is_exact))
    return tuple(carries)
