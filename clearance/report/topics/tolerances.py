"""What tolerances leave: proven, expected, who takes most, what may still grow, what to tighten first.

Lengths are rounded down, angles too. Not for: working it out (`clearance.budget`), nor the curves.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from decimal import ROUND_FLOOR, Decimal
from typing import Any, ClassVar, NamedTuple

from clearance.findings.of_budget import NOT_WORKED_OUT, least_expected, tolerance_lines
from clearance.record.budget import BudgetMoment, ErrorSource, RuleBudget, most_searched
from clearance.record.record import Record
from clearance.record.wording import depth_mm, limit_mm, mm, moment_text, of_rule
from clearance.report.blocks import (
    Cell,
    Content,
    Inline,
    Paragraph,
    Row,
    Section,
    Table,
    capital,
    faint,
    number,
)
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import moment_link, name_shown, time_of
from clearance.report.topic import Line, Topic, labelled

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
    name = _name(record, source)
    return f"{name} at the {source.moment}" if source.moment else name


def _name(record: Record, source: ErrorSource) -> str:
    part = source.part
    if len(record.case.robots) > 1 and part:
        part = f"{source.owner}/{part}"
    kind = _KINDS[source.kind]
    if source.kind == "facets":
        return kind
    if "{}" in kind:
        return kind.format(part or source.owner)
    return f"{kind} of {source.owner}"


def value_text(value: float, unit: str) -> str:
    """A tolerance with its unit: `0.5 mm`, `0.001 rad`, `0.02 s`."""
    return f"{limit_mm(value)} mm" if unit == "m" else f"{value:.6g} {unit}"


def given_text(source: ErrorSource) -> str:
    """What the budget gives: `2 mm, 0.001 rad`; of a frame that only one is given of, that."""
    given = [pair for pair in source.tolerances if pair[0] > 0.0] or source.tolerances[:1]
    return ", ".join(value_text(value, unit) for value, unit in given)


def largest_text(source: ErrorSource) -> str:
    """What it may be at most, all others as given: `2.31 mm, 0.02 rad or more`; empty where 0 is not enough."""
    sizes = []
    for value, (given, unit) in zip(source.largest, source.tolerances, strict=False):
        if value is not None:
            more = " or more" if math.inf > value >= most_searched(unit, given) else ""
            sizes.append(_rounded_down(value, unit) + more)
    return ", ".join(sizes)


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


def lines(model: ReportModel) -> Iterator[Line]:
    """Where the tolerances leave least, what takes most of it, and where their numbers come from."""
    yield from labelled("tolerances", _lines(model))


def _lines(model: ReportModel) -> Iterator[str]:
    record, session = model.record, model.session
    if record.budget is None:
        return
    found = [(one, session.least_left(one)) for one in model.budgets]
    known = [(one, moments[0].proven - one.limits.fail) for one, moments in found if moments]
    if known:
        worst = min(known, key=lambda pair: pair[1])[0]
        yield from source_lines(record, worst, session.error_sources(worst, 0, MOST_SOURCES))
    assert record.case.tolerance is not None
    yield from record.case.tolerance.sources


def source_lines(record: Record, one: RuleBudget, worst: BudgetMoment) -> Iterator[str]:
    """What takes most at a moment of a rule, and what of it may be how great at most."""
    moment = worst.moment
    where = f"{moment.link} - {moment.obstacle} at {moment_text(record, moment)}"
    yield f"{mm(moment.clearance)} mm nominal, {mm(worst.proven)} mm proven at this moment: {where}"
    causes = [
        f"{source_text(record, source)} {depth_mm(source.proven)} mm ({given_text(source)})"
        for source in worst.sources[:MOST_SOURCES]
        if source.proven > 0.0
    ]
    if causes:
        yield f"largest causes: {', '.join(causes)}"
    yield from _largest_lines(record, one, worst.sources[:MOST_SOURCES])


def _largest_lines(
    record: Record, one: RuleBudget, sources: Sequence[ErrorSource]
) -> Iterator[str]:
    """What of some errors would keep the limit, and which alone are not enough."""
    level = f"{limit_mm(one.limits.fail)} mm"
    limit = f"the fail limit of {level}{of_rule(one.rule)}"
    if one.waiver is not None:
        limit = f"the {level} of its waiver"
    sizes = [(source_text(record, source), largest_text(source)) for source in sources]
    enough = [f"{name} {largest}" for name, largest in sizes if largest]
    others = [name for name, largest in sizes if not largest]
    if enough:
        yield f"greatest value that keeps {limit}, others as given: {', '.join(enough)}"
    if others:
        yield f"not enough to keep {limit}, even at 0, alone: {', '.join(others)}"


def data(model: ReportModel) -> dict[str, Any]:
    """What tolerances leave of each rule; nothing without any."""
    record, budget = model.record, model.record.case.tolerance
    if budget is None:
        return {}
    row = {
        "coverage": budget.coverage,
        "distributions": "normal" if budget.is_normal else "uniform",
        "unproven_ok": budget.unproven_ok,
        "sources": list(budget.sources),
        "lines": list(tolerance_lines(record)),
        "rules": [_rule_row(record, one, moments) for one, moments in model.least_left.items()],
        "verdict": model.verdict.tolerances,
    }
    return {"tolerances": row}


def _rule_row(record: Record, one: RuleBudget, worst: Sequence[BudgetMoment]) -> dict[str, Any]:
    return {
        "rule": one.rule,
        "waived": None if one.waiver is None else list(one.waiver.between),
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


HUES = 6
"""Colours of a bar; further sources begin again."""

METHOD = (
    "Proven: every error takes its worst value, in its worst direction, at once with all others; nothing is "
    "linearised, and the pair that errors bring nearest is searched among all pairs. Expected: an estimate at the "
    "nearest points, no proof; errors are taken as independent."
)


class BarPart(NamedTuple):
    """A piece of a bar, or a mark on it: what it is, its share or place from 0 to 1, and its look."""

    text: str
    share: float
    kind: str = ""


@dataclass(frozen=True)
class BudgetBar:
    """The nominal clearance as a bar: what is proven to be left, then what each error takes."""

    template: ClassVar[str] = "budget_bar"
    narrow: ClassVar[float] = 0.05  # share of a bar that has no room for words
    label: str
    pieces: Sequence[BarPart]
    marks: Sequence[BarPart]


def sections(content: PageContent) -> Iterator[Section]:
    """What is left, what takes it, what to tighten first; nothing where the case has no tolerances."""
    content_of = content.summary.get("tolerances")
    if content_of is None:
        return
    lines = content_of["lines"] or [f"{capital(NOT_WORKED_OUT)}."]
    parts: list[object] = [Paragraph(Inline(line, element="strong")) for line in lines]
    rules = [rule for rule in content_of["rules"] if rule["worst"]]
    if rules:
        worst = min(rules, key=lambda rule: rule["worst"][0]["proven"] - rule["fail"])
        parts += _worst(worst, worst["worst"][0])
    if len(content_of["rules"]) > 1:
        heads = ("Rule", ">Fail, mm", ">Proven, mm", ">Expected, mm", "With tolerances")
        parts.append(Table(heads, [*map(_rule, content_of["rules"])], "budget"))
    yield Section("Tolerances", [*parts, *map(faint, _notes(content_of))])


def _worst(rule: dict[str, Any], moment: dict[str, Any]) -> Iterator[object]:
    """The moment at which the errors leave least: a line, the bar, the table."""
    step = moment["step"]
    where = (
        f"between the steps {step:,} and {step + 1:,}" if moment["between"] else f"step {step:,}"
    )
    heading = f"Least remaining clearance: {moment['body_a']} and {moment['body_b']} at "
    at = moment_link(moment, f"{time_of(moment)}, {where}")
    yield Paragraph([heading, at, f", {mm(moment['clearance'])} mm nominal."])
    yield _bar(moment, rule["fail"])
    heads = ("Error", "Given", ">Takes, mm", ">Std. deviation, mm", "At most, others as given")
    rows = [_source_row(i, one) for i, one in enumerate(moment["sources"])]
    yield Table(heads, rows, "budget", tall=len(rows) > 24)


def _bar(moment: dict[str, Any], fail: float) -> BudgetBar:
    remaining, nominal = max(0.0, moment["proven"]), moment["clearance"]
    shares = [(one["name"], one["proven"]) for one in moment["sources"] if one["proven"] > 0.0]
    whole = max(remaining + sum(value for _, value in shares), nominal, fail) or 1.0
    state = "kept" if moment["proven"] >= fail and remaining > 0.0 else "open"
    pieces = (
        [BarPart(f"remaining {mm(remaining)} mm", remaining / whole, state)]
        if remaining > 0.0
        else []
    )
    pieces += [
        BarPart(f"{name} {depth_mm(value)} mm", value / whole, f"hue{i % HUES}")
        for i, (name, value) in enumerate(shares)
    ]
    marks = [BarPart(f"fail limit {limit_mm(fail)} mm", fail / whole)] if fail > 0.0 else []
    if 0.0 < nominal < 0.999 * whole:
        marks.append(BarPart(f"nominal {mm(nominal)} mm", nominal / whole, "nominal"))
    label = f"of {mm(nominal)} mm nominal, {mm(moment['proven'])} mm are proven to be left"
    return BudgetBar(label, pieces, marks)


def _source_row(i: int, source: dict[str, Any]) -> Row:
    name: list[str | Inline] = [source["name"]]
    if i == 0 and source["proven"] > 0.0:
        first = Inline("tighten first", "tag near")
        name = [Inline(source["name"], element="strong"), " ", first]
    at_most, expected = source["at_most"], source["expected"]
    cells: list[Content | Cell] = [
        [Inline("", f"swatch hue{i % HUES}"), *name],
        source["given"],
        number(depth_mm(source["proven"])),
        number("" if expected is None else depth_mm(expected)),
        Cell(at_most or "not enough alone", "" if at_most else "text-violated"),
    ]
    return Row(cells)


def _rule(rule: dict[str, Any]) -> Row:
    cells: list[Content | Cell] = [
        name_shown(rule["rule"])
        if rule["waived"] is None
        else f"waiver {' - '.join(rule['waived'])}",
        number(limit_mm(rule["fail"])),
        number(mm(rule["proven"])),
        number("" if rule["expected"] is None else mm(rule["expected"])),
        "kept" if rule["keeps"] else Cell("not proven", "text-violated"),
    ]
    return Row(cells)


def _notes(tolerances: dict[str, Any]) -> Iterator[str]:
    normal = tolerances["distributions"] == "normal"
    spread = (
        "normal, their magnitude at three deviations" if normal else "uniform up to their magnitude"
    )
    yield f"{METHOD} {tolerances['coverage']:g} deviations are taken off; errors are {spread}."
    yield from (f"Numbers: {source}." for source in tolerances["sources"])


TOPIC: Topic = Topic(data, lines, sections)
