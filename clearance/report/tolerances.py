"""What tolerances leave, in words and as plain data: proven, expected, who takes most, what may still grow.

Lengths are rounded down, angles too. Not for: working it out (`clearance.budget`), the page's section
(`tolerance_section`).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from decimal import ROUND_FLOOR, Decimal
from typing import Any

from clearance.findings.tolerance_lines import least_expected, tolerance_lines
from clearance.record.budget import BudgetMoment, ErrorSource, RuleBudget, most_looked_for
from clearance.record.record import Record
from clearance.record.wording import depth_mm, limit_mm, mm, moment_text, of_rule

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


def source_lines(record: Record, one: RuleBudget, worst: BudgetMoment) -> Iterator[str]:
    """What takes most at a moment of a rule, and what of it may be how great at most."""
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


def tolerances_of(
    record: Record, left: Mapping[str, Sequence[BudgetMoment]]
) -> dict[str, Any] | None:
    """What `summary.json` holds of tolerances; None without any. `left` as in `RunDetails`."""
    budget = record.case.tolerance
    if budget is None:
        return None
    return {
        "coverage": budget.coverage,
        "distributions": "normal" if budget.is_normal else "uniform",
        "unproven_ok": budget.unproven_ok,
        "sources": list(budget.sources),
        "lines": list(tolerance_lines(record)),
        "rules": [_told(record, one, left[one.rule]) for one in record.budget or ()],
    }


def _told(record: Record, one: RuleBudget, worst: Sequence[BudgetMoment]) -> dict[str, Any]:
    return {
        "rule": one.rule,
        "fail": one.limits.fail,
        "warn": one.limits.warn,
        "keeps": one.keeps,
        "proven": one.least,
        "expected": least_expected(one),
        "basis": "samples" if one.between is None else "motion",
        "worst": [_moment(record, each) for each in worst],
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
    return asdict(source) | _shown(record, source)


def _shown(record: Record, source: ErrorSource) -> dict[str, str]:
    return {
        "name": source_text(record, source),
        "given": given_text(source),
        "at_most": largest_text(source),
    }
