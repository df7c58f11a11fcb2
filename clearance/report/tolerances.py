"""What tolerances leave, in words and as plain data: proven, expected, who takes most, what may still grow.

Lengths are rounded down, angles too. Not for: working it out (`clearance.budget`), the page's section
(`tolerance_section`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, replace
from decimal import ROUND_FLOOR, Decimal
from typing import Any

import numpy as np

from clearance.report.wording import depth_mm, limit_mm, mm, moment_text, of_rule
from clearance.simulate.budget_answer import BudgetMoment, ErrorSource, RuleBudget, most_looked_for
from clearance.simulate.record import Record
from clearance.world.budget import Budget

MOST_SOURCES = 3
"""Sources of errors that a line names."""

_KINDS = {
    "position": "position of joint {}",
    "tracking": "tracking of joint {}",
    "frame": "frame of joint {}",
    "base": "base",
    "place": "place",
    "surface": "surface of {}",
    "timing": "clock",
    "facets": "facets",
}


def budget_lines(record: Record) -> tuple[str, ...]:
    """A sentence for each rule on what is proven and what is expected; none without tolerances."""
    budget = record.case.tolerance
    if budget is None or record.budget is None:
        return ()
    return tuple(_line(record, budget, one) for one in record.budget)


def tolerance_lines(record: Record) -> tuple[str, ...]:
    """These, and which grasps are taken as exact."""
    exact = [f"{one.part} by {one.by}" for one in record.case.carries if one.exact_grasp]
    told = budget_lines(record)
    return (*told, f"Grasps taken as exact: {', '.join(exact)}.") if told and exact else told


def _line(record: Record, budget: Budget, one: RuleBudget) -> str:
    proven, expected = one.least, least_expected(one)
    basis = "the samples only" if one.between is None else "the motion"
    waived = " (waived pairs among them)" if record.case.waivers else ""
    left = f"at least {mm(proven)} mm are left{waived}"
    if proven <= 0.0:
        left = "contact is not ruled out"  # a number below 0 says no depth
    told = f"With every error at its worst at once {left}{of_rule(one.rule)}; proven for {basis}."
    if expected is not None:
        spread = f"{budget.coverage:g} sigma, estimate{'' if one.between is not None else ' at the samples'}"
        told += f" Expected ({spread}): {mm(expected)} mm."
    return told


def least_expected(one: RuleBudget) -> float | None:
    """[m] The least expected clearance, of the motion where that is certified. None where it is not worked out.

    Never told below what is proven: three deviations of a single uniform error are more than its worst.
    """
    found = np.append(one.expected, [] if one.expected_between is None else one.expected_between)
    known = found[np.isfinite(found)]
    return max(float(known.min()), one.least) if len(known) else None


def worst_of(record: Record) -> tuple[RuleBudget, BudgetMoment] | None:
    """The moment at which the errors leave least above its fail limit, and what judges it; None where none is."""
    found = [(one, one.worst[0]) for one in record.budget or () if one.worst]
    return min(found, key=lambda pair: pair[1].proven - pair[0].limits.fail, default=None)


def source_text(record: Record, source: ErrorSource) -> str:
    """What an error is of, and when, if not now: `base of left`, `tracking of joint left/j at the grasp (2 s)`."""
    told = _name(record, source)
    return f"{told} at the {source.moment}" if source.moment else told


def _name(record: Record, source: ErrorSource) -> str:
    part = source.part
    if len(record.case.robots) > 1 and part:
        part = f"{source.owner}/{part}"
    told = _KINDS[source.kind]
    if source.kind == "facets":
        return told
    if "{}" in told:
        return told.format(part or source.owner)
    return f"{told} of {source.owner}"


def value_text(value: float, unit: str) -> str:
    """A tolerance with its unit: `0.5 mm`, `0.001 rad`, `0.02 s`."""
    return f"{limit_mm(value)} mm" if unit == "m" else f"{value:.6g} {unit}"


def given_text(source: ErrorSource) -> str:
    """What the budget gives: `2 mm, 0.001 rad`; of a frame that only one is given of, that."""
    given = [pair for pair in source.tolerances if pair[0] > 0.0] or source.tolerances[:1]
    return ", ".join(value_text(value, unit) for value, unit in given)


def largest_text(source: ErrorSource) -> str:
    """What it may be at most, all others as given: `2.31 mm, 0.02 rad or more`; empty where 0 is not enough."""
    told = []
    for value, (given, unit) in zip(source.largest, source.tolerances, strict=False):
        if value is not None:
            more = " or more" if math.inf > value >= most_looked_for(unit, given) else ""
            told.append(_rounded_down(value, unit) + more)
    return ", ".join(told)


def _rounded_down(value: float, unit: str) -> str:
    """Three digits, never more than the value."""
    if not math.isfinite(value):
        return "any"
    exact = Decimal(repr(float(value))) * (1000 if unit == "m" else 1)
    if exact <= 0:
        return f"0 {'mm' if unit == 'm' else unit}"
    last = Decimal(1).scaleb(exact.adjusted() - 2)
    shown = exact.quantize(last, rounding=ROUND_FLOOR).normalize()
    return f"{shown:f} {'mm' if unit == 'm' else unit}"


def source_lines(record: Record) -> Iterator[str]:
    """What takes most at the worst moment, and what of it may be how great at most."""
    found = worst_of(record)
    if found is None:
        return
    one, worst = found
    moment = worst.moment
    where = f"{moment.link} - {moment.obstacle} at {moment_text(moment)}"
    yield f"{mm(moment.clearance)} mm nominal, {mm(worst.proven)} mm proven: {where}"
    taken = [
        f"{source_text(record, source)} {depth_mm(source.proven)} mm ({given_text(source)})"
        for source in worst.sources[:MOST_SOURCES]
        if source.proven > 0.0
    ]
    if taken:
        yield f"most is taken by {', '.join(taken)}"
    yield from _largest_lines(record, one, worst.sources[:MOST_SOURCES])


def _largest_lines(
    record: Record, one: RuleBudget, sources: Sequence[ErrorSource]
) -> Iterator[str]:
    """What of some errors would keep the limit, and which alone are not enough."""
    limit = f"the fail limit of {limit_mm(one.limits.fail)} mm{of_rule(one.rule)}"
    told = [(source_text(record, source), largest_text(source)) for source in sources]
    enough = [f"{name} {largest}" for name, largest in told if largest]
    others = [name for name, largest in told if not largest]
    if enough:
        yield f"greatest that keeps {limit}, others as given: {', '.join(enough)}"
    if others:
        yield f"not enough to keep {limit}, even at 0, alone: {', '.join(others)}"


def tolerances_of(record: Record) -> dict[str, Any] | None:
    """What `summary.json` holds of tolerances; None without any."""
    budget = record.case.tolerance
    if budget is None:
        return None
    return {
        "coverage": budget.coverage,
        "distributions": "normal" if budget.is_normal else "uniform",
        "unproven_ok": budget.unproven_ok,
        "sources": list(budget.sources),
        "lines": list(tolerance_lines(record)),
        "rules": [_told(record, one) for one in record.budget or ()],
    }


def _told(record: Record, one: RuleBudget) -> dict[str, Any]:
    return {
        "rule": one.rule,
        "fail": one.limits.fail,
        "warn": one.limits.warn,
        "keeps": one.keeps,
        "proven": one.least,
        "expected": least_expected(one),
        "basis": "samples" if one.between is None else "motion",
        "worst": [_moment(record, worst) for worst in one.worst],
    }


def _moment(record: Record, worst: BudgetMoment) -> dict[str, Any]:
    moment = worst.moment
    return {
        "step": moment.step,
        "time": moment.time,
        "time_b": moment.time_b,
        "between": moment.between,
        "body_a": moment.link,
        "body_b": moment.obstacle,
        "point_a": list(moment.point_link),
        "point_b": list(moment.point_obstacle),
        "clearance": moment.clearance,
        "proven": worst.proven,
        "expected": max(worst.expected, worst.proven) if math.isfinite(worst.expected) else None,
        "sources": [_source(record, source) for source in worst.sources],
    }


def _source(record: Record, source: ErrorSource) -> dict[str, Any]:
    known = asdict(replace(source, largest=tuple(source.largest)))
    return known | _shown(record, source)


def _shown(record: Record, source: ErrorSource) -> dict[str, str]:
    return {
        "name": source_text(record, source),
        "given": given_text(source),
        "at_most": largest_text(source),
    }
