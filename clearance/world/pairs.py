"""Which bodies are measured against which, and why the others are not."""

from __future__ import annotations

from dataclasses import dataclass
from fnmatch import fnmatchcase

from clearance.errors import NothingToMeasure
from clearance.world.body import Body
from clearance.world.case import Case, Omission, PlacedRobot


@dataclass(frozen=True)
class Pair:
    """A link and an obstacle whose clearance is wanted: indices into `case.robots` and so on."""

    i_robot: int
    i_body: int
    i_obstacle: int


def measured_pairs(case: Case) -> tuple[list[Pair], list[Omission]]:
    """The pairs to measure, robots first, then links, then obstacles in their order; and what is left out.

    Raises:
        NothingToMeasure: no pair is left.
    """
    pairs: list[Pair] = []
    unmeasured: list[Omission] = []
    for i_robot, placed in enumerate(case.robots):
        unmeasured += _links_left_out(placed)
        excluded = frozenset(placed.exclude_links)
        for i_body, body in enumerate(placed.robot.bodies):
            if body.name in excluded:
                continue
            for i_obstacle, obstacle in enumerate(case.obstacles):
                rule = _allowing_rule(case, body, obstacle.name)
                if rule is None:
                    pairs.append(Pair(i_robot, i_body, i_obstacle))
                else:
                    reason = f"allowed by {list(rule)}"
                    unmeasured.append(Omission(body.name, obstacle.name, reason))
    if not pairs:
        raise NothingToMeasure(
            "no link-obstacle pair is left to measure",
            valid="at least one obstacle, and a link with geometry that is not excluded or allowed",
        )
    return pairs, unmeasured


def _links_left_out(placed: PlacedRobot) -> list[Omission]:
    with_shape = {body.name for body in placed.robot.bodies}
    excluded = frozenset(placed.exclude_links)
    left_out = [Omission(name, "*", "excluded in the case file") for name in placed.exclude_links]
    left_out += [
        Omission(name, "*", "no geometry")
        for name in placed.robot.link_names
        if name not in with_shape and name not in excluded
    ]
    return left_out


def _allowing_rule(case: Case, link: Body, obstacle: str) -> tuple[str, str] | None:
    for rule in case.allow:
        if matches(link.name, rule[0]) and matches(obstacle, rule[1]):
            return rule
    return None


def matches(name: str, pattern: str) -> bool:
    """True if `pattern` is the name itself (which may hold `[`, `*` or `?`) or a wildcard for it."""
    return name == pattern or fnmatchcase(name, pattern)
