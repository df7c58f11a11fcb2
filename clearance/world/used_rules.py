"""Rules and allowances that are of nothing: a typing error is no silent gap. Not for: what they say (`rules`)."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from clearance.errors import BadInput, UnknownLink, UnknownObstacle, at, nearest_name
from clearance.world.case import Case, Omission
from clearance.world.pairs import Pair, names_of
from clearance.world.rules import Rule, matches

_Names = tuple[Sequence[str], Sequence[str]]
"""The names that the two bodies of a pair go by."""


def require_rules_used(case: Case, pairs: Iterable[Pair], omitted: Iterable[Omission]) -> None:
    """Nothing, if every rule is of a pair, and what a row says is carried is.

    Args:
        pairs: all that are measured at some time. left_out: what is not, in some phase.

    Raises:
        UnknownLink, UnknownObstacle: a typing error, with the nearest name. BadInput: two bodies that are no pair.
    """
    _require_carried(case)
    if not case.limits.rules:
        return
    found: list[_Names] = [(names_of(case, pair.a), names_of(case, pair.b)) for pair in pairs]
    found += [((one.link,), (one.obstacle,)) for one in omitted if one.obstacle != "*"]
    bodies = sorted({name for pair in found for body in pair for name in body})
    for i, rule in enumerate(case.limits.rules):
        with at(f"limits.rules[{i}].between"):
            _require_match(rule, found, bodies)


def _require_carried(case: Case) -> None:
    carried = [carry.part for carry in case.carries]
    for field, rows in (("limits.rules", case.limits.rules), ("allow", case.allow)):
        for i, row in enumerate(rows):
            if row.while_carried is not None and row.while_carried not in carried:
                raise UnknownObstacle(
                    f"{row.while_carried!r} is never carried",
                    where=f"{field}[{i}].while_carried",
                    valid=nearest_name(row.while_carried, carried),
                )


def _require_match(rule: Rule, pairs: Sequence[_Names], bodies: Sequence[str]) -> None:
    if any(rule.matches(*pair) for pair in pairs):
        return
    for pattern in rule.between:
        if not any(matches(name, pattern) for name in bodies):
            raise UnknownLink(f"no body is called {pattern!r}", valid=nearest_name(pattern, bodies))
    raise BadInput(
        f"no pair matches {list(rule.between)}", valid="patterns of two bodies of a pair"
    )
