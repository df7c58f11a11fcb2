"""Rows of a case file that speak of pairs and parts, to those of the world: limits and their rules, allowances,
what is carried. Not for: whether the names in them are there (`allow`).
"""

from __future__ import annotations

from collections.abc import Sequence

from clearance.errors import at
from clearance.formats.schema import case as schema
from clearance.formats.schema import limits as limits_schema
from clearance.world.carry import Carry
from clearance.world.case import Limits
from clearance.world.rules import Allowance, Rule


def limits_of(given: limits_schema.Limits) -> Limits:
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


def _rule(row: limits_schema.Rule) -> Rule:
    name = row.name or ""
    return Rule(row.patterns, row.window, row.while_carried, name, row.fail, row.warn)


def allowances_of(given: Sequence[limits_schema.AllowedPair]) -> tuple[Allowance, ...]:
    """The pairs that are not measured."""
    return tuple(Allowance(row.patterns, row.window, row.while_carried) for row in given)


def carries_of(given: Sequence[schema.Carry]) -> tuple[Carry, ...]:
    """What is carried.

    Raises:
        BadInput: a part that carries itself.
    """
    carries = []
    for i, row in enumerate(given):
        with at(f"carry[{i}]"):
            is_exact = row.grasp == "exact"
            carries.append(Carry(row.part, row.by, row.window, tuple(row.touch), is_exact))
    return tuple(carries)
