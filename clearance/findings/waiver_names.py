"""Names in a waiver that nothing has: a typing error, or a body that is gone. Not for: judging (`judgement`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from clearance.errors import nearest_name
from clearance.record.record import Record
from clearance.world.case import Case
from clearance.world.rules import matches
from clearance.world.waiver import Waiver


def unknown_name(record: Record, waiver: Waiver) -> str:
    """What a waiver names that is not there, with the nearest name; empty where all is."""
    return unknown_among([record.case], [rule.name for rule in record.rules], waiver)


def unknown_among(cases: Iterable[Case], rules: Sequence[str], waiver: Waiver) -> str:
    """What a waiver names that none of some cases has, with the nearest name; empty where all is.

    Args:
        rules: the names of those of all cases.
    """
    if not any(matches(name, waiver.rule) for name in rules):
        return f"no rule is called {waiver.rule!r}; {nearest_name(waiver.rule, rules)}"
    bodies = list(dict.fromkeys(name for case in cases for name in _bodies(case)))
    for pattern in waiver.between:
        if not any(matches(name, pattern) for name in bodies):
            return f"no body is called {pattern!r}; {nearest_name(pattern, bodies)}"
    return ""


def _bodies(case: Case) -> list[str]:
    """All names that bodies go by: of a link also the one without its robot's."""
    links = [link for placed in case.robots for link in placed.robot.link_names]
    full = [
        case.prefix_of(placed) + link for placed in case.robots for link in placed.robot.link_names
    ]
    return [*full, *links, *(obstacle.name for obstacle in case.obstacles)]
