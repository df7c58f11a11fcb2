"""The page's section on tolerances: what is left, what takes it, what to tighten first. Not for: the curve."""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from clearance.findings.of_budget import NOT_WORKED_OUT
from clearance.record.wording import depth_mm, limit_mm, mm, seconds
from clearance.report.markup import element, moment_link, section, table
from clearance.report.rules import name_shown

HUES = 6
"""Colours of a bar; further sources begin again."""

NARROW = 0.05
"""Share of a bar that has no room for words."""

METHOD = (
    "Proven: every error takes its worst value, in its worst direction, at once with all others; nothing is "
    "linearised, and the pair that errors bring nearest is looked for among all. Expected: an estimate at the "
    "nearest points, no proof; errors are taken as independent."
)


def tolerances(summary: dict[str, Any]) -> Markup:
    """The section; nothing where the case has no tolerances."""
    told = summary.get("tolerances")
    if told is None:
        return Markup("")
    lines = told["lines"] or [f"{NOT_WORKED_OUT[0].upper()}{NOT_WORKED_OUT[1:]}."]
    parts = [element("p", element("strong", line)) for line in lines]
    rules = [rule for rule in told["rules"] if rule["worst"]]
    if rules:
        worst = min(rules, key=lambda rule: rule["worst"][0]["proven"] - rule["fail"])
        parts += _worst(worst, worst["worst"][0])
    if len(told["rules"]) > 1:
        parts.append(_rules(told["rules"]))
    return section("Tolerances", *parts, *_notes(told))


def _worst(rule: dict[str, Any], moment: dict[str, Any]) -> list[Markup]:
    """The moment at which the errors leave least: a line, the bar, the table."""
    step = moment["step"]
    where = (
        f"between the steps {step:,} and {step + 1:,}" if moment["between"] else f"step {step:,}"
    )
    told = f"Where the errors leave least: {moment['body_a']} and {moment['body_b']} at "
    at = moment_link(moment, f"{seconds(moment['time'])}, {where}")
    line = element("p", told, at, f", {mm(moment['clearance'])} mm nominal.")
    return [line, _bar(moment, rule["fail"]), _table(moment)]


def _bar(moment: dict[str, Any], fail: float) -> Markup:
    """The nominal clearance as a bar: what is proven to be left, then what each error takes."""
    left = max(0.0, moment["proven"])
    taken = [(one["name"], one["proven"]) for one in moment["sources"] if one["proven"] > 0.0]
    whole = max(left + sum(value for _, value in taken), moment["clearance"], fail) or 1.0
    state = "kept" if moment["proven"] >= fail and left > 0.0 else "open"
    pieces = [_piece(f"left {mm(left)} mm", left / whole, state)] if left > 0.0 else []
    pieces += [
        _piece(f"{name} {depth_mm(value)} mm", value / whole, f"hue{i % HUES}")
        for i, (name, value) in enumerate(taken)
    ]
    mark = element(
        "i", style=f"left:{100 * fail / whole:.2f}%", title=f"fail limit {limit_mm(fail)} mm"
    )
    marks = [mark] if fail > 0.0 else []
    if 0.0 < moment["clearance"] < 0.999 * whole:
        at = f"left:{100 * moment['clearance'] / whole:.2f}%"
        marks.append(
            element("i", class_="nominal", style=at, title=f"nominal {mm(moment['clearance'])} mm")
        )
    return element(
        "div", *pieces, *marks, class_="budget-bar", role="img", aria_label=_described(moment)
    )


def _piece(text: str, share: float, kind: str) -> Markup:
    shown = text if share > NARROW else ""
    return element("span", shown, class_=kind, style=f"width:{100 * share:.2f}%", title=text)


def _described(moment: dict[str, Any]) -> str:
    return (
        f"of {mm(moment['clearance'])} mm nominal, {mm(moment['proven'])} mm are proven to be left"
    )


def _table(moment: dict[str, Any]) -> Markup:
    heads = ("Error", "Given", ">Takes, mm", ">Std. deviation, mm", "At most, others as given")
    rows = [_row(i, one) for i, one in enumerate(moment["sources"])]
    return table(heads, rows, class_="budget", tall=len(rows) > 24)


def _row(i: int, source: dict[str, Any]) -> Markup:
    name: object = source["name"]
    if i == 0 and source["proven"] > 0.0:
        name = element("strong", name) + " " + element("span", "tighten first", class_="tag near")
    at_most, expected = source["at_most"], source["expected"]
    return element(
        "tr",
        element("td", element("span", class_=f"swatch hue{i % HUES}"), name),
        element("td", source["given"]),
        element("td", depth_mm(source["proven"]), class_="number"),
        element("td", "" if expected is None else depth_mm(expected), class_="number"),
        element("td", at_most or "not enough alone", class_=None if at_most else "text-violated"),
    )


def _rules(rules: list[dict[str, Any]]) -> Markup:
    heads = ("Rule", ">Fail, mm", ">Proven, mm", ">Expected, mm", "With tolerances")
    rows = [
        element(
            "tr",
            element("td", name_shown(rule["rule"])),
            element("td", limit_mm(rule["fail"]), class_="number"),
            element("td", mm(rule["proven"]), class_="number"),
            element(
                "td", "" if rule["expected"] is None else mm(rule["expected"]), class_="number"
            ),
            _kept(rule["keeps"]),
        )
        for rule in rules
    ]
    return table(heads, rows, class_="budget")


def _kept(keeps: bool) -> Markup:
    if keeps:
        return element("td", "kept")
    return element("td", "not proven", class_="text-violated")


def _notes(told: dict[str, Any]) -> list[Markup]:
    normal = told["distributions"] == "normal"
    spread = (
        "normal, their magnitude at three deviations" if normal else "uniform up to their magnitude"
    )
    notes = [f"{METHOD} {told['coverage']:g} deviations are taken off; errors are {spread}."]
    notes += [f"Numbers: {source}." for source in told["sources"]]
    return [element("p", note, class_="faint") for note in notes]
