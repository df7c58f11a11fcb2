"""Names that a case takes from robot and scene: a typing error must not be a silent gap."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from clearance.errors import BadInput, UnknownLink, UnknownObstacle, at, nearest_name
from clearance.world.rules import matches

_WILDCARDS = frozenset("*?[")


def checked_pairs(
    pairs: Sequence[Sequence[str]], links: Iterable[str], obstacles: Iterable[str]
) -> tuple[tuple[str, str], ...]:
    """The (link pattern, obstacle pattern) pairs, once each pattern matches something.

    Raises:
        UnknownLink, UnknownObstacle: nothing matches, with the nearest name.
    """
    links, obstacles = tuple(links), tuple(obstacles)
    for i, (link, obstacle) in enumerate(pairs):
        with at(f"allow[{i}]"):
            if (
                _matches(link, obstacles)
                and _matches(obstacle, links)
                and not _matches(link, links)
            ):
                raise UnknownLink(
                    f"{link!r} is an obstacle and {obstacle!r} a link", valid="the link comes first"
                )
            _refuse_unmatched(link, links, "link", UnknownLink)
            _refuse_unmatched(obstacle, obstacles, "obstacle", UnknownObstacle)
    return tuple((link, obstacle) for link, obstacle in pairs)


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


def _matches(pattern: str, names: Iterable[str]) -> bool:
    return any(matches(name, pattern) for name in names)


def _refuse_unmatched(
    pattern: str, names: tuple[str, ...], what: str, fault: type[BadInput]
) -> None:
    if _matches(pattern, names):
        return
    problem = f"no {what} matches" if _WILDCARDS & set(pattern) else f"unknown {what}"
    raise fault(f"{problem} {pattern!r}", valid=nearest_name(pattern, names))
