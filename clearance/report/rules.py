"""The rules of a case in the summary and on the page: limits, when they hold, the moment that stands worst.

Not for: judging (`simulate.answers.run_answer`).
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from markupsafe import Markup

from clearance.record.details import RunDetails
from clearance.record.moment import Moment
from clearance.record.record import Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.wording import limit_mm, mm, other_time, seconds
from clearance.report.markup import element, moment_link, section, table
from clearance.world.rules import DEFAULT, Rule


def told_moment(record: Record, moment: Moment) -> dict[str, Any]:
    """A moment as plain data; its bodies and points under both names that tables have for them."""
    points = list(moment.point_link), list(moment.point_obstacle)
    return {
        "step": moment.step,
        "time": moment.time,
        "time_b": moment.time_b,
        "between": moment.between,
        "clearance": moment.clearance,
        "touches": moment.touches,
        "depth": None if moment.depth is None else moment.depth._asdict(),
        "status": record.status_of(moment),
        "rule": moment.rule,
        "link": moment.link,
        "obstacle": moment.obstacle,
        "point_link": points[0],
        "point_obstacle": points[1],
        "body_a": moment.link,
        "body_b": moment.obstacle,
        "point_a": points[0],
        "point_b": points[1],
    }


def rules_of(record: Record, details: RunDetails) -> list[dict[str, Any]]:
    """All rules of the case in its order, the limits by themselves first; those that judge no pair have no
    status."""
    limits = record.case.limits
    answers = {answer.name: answer for answer in record.rules}
    own: list[Rule | None] = [None, *limits.rules]
    return [
        _told(record, details, i, name, rule, answers.get(name))
        for i, (name, rule) in enumerate(zip(limits.rule_names, own, strict=True))
    ]


def _told(
    record: Record,
    details: RunDetails,
    i: int,
    name: str,
    rule: Rule | None,
    answer: RuleAnswer | None,
) -> dict[str, Any]:
    limits = record.case.limits.of_rule(i)
    window = (-math.inf, math.inf) if rule is None else (rule.window.start, rule.window.end)
    worst = details.worst.get(name)
    sample = None if answer is None else answer.worst_sample
    return {
        "name": name,
        "between": None if rule is None else list(rule.between),
        "from": _finite(window[0]),
        "until": _finite(window[1]),
        "while_carried": None if rule is None else rule.while_carried,
        "fail": limits.fail,
        "warn": limits.warn,
        "status": None if answer is None else answer.status,
        "n_pairs": details.n_pairs.get(name),
        "lower_bound": _proven(answer),
        "worst": None if worst is None else told_moment(record, worst),
        "worst_sample": None if sample is None else told_moment(record, sample),
    }


def _proven(answer: RuleAnswer | None) -> float | None:
    """The least proven bound [m] of what a rule judges; None where nothing is proven."""
    if answer is None or answer.certificate is None:
        return None
    return _finite(float(np.min(answer.certificate.lower_bound)))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def rules(summary: dict[str, Any]) -> Markup:
    """The section; nothing where the case has no rules."""
    told = summary["rules"]
    if len(told) < 2:
        return Markup("")
    heads = (
        "Rule", "Between", "Holds", ">Fail, mm", ">Warn, mm", "Status", ">Least, mm", ">Certified, mm",
        "Where", "When",
    )  # fmt: skip
    worst = [rule for rule in told if rule["worst"] is not None]
    rows = [_row(rule, summary["worst"]["rule"]) for rule in (*worst, *_idle(told))]
    note = (
        "Where rules overlap, the last of them that is of a pair judges it. Least is less padding."
    )
    return section(
        "Rules", table(heads, rows, class_="clickable rules"), element("p", note, class_="faint")
    )


def _idle(told: list[dict[str, Any]]) -> list[dict[str, Any]]:
    return [rule for rule in told if rule["worst"] is None]


def _row(rule: dict[str, Any], worst_of_all: str) -> Markup:
    between = "all other pairs" if rule["between"] is None else " - ".join(rule["between"])
    name: object = name_shown(rule["name"])
    name = element("strong", name) if rule["name"] == worst_of_all else name
    cells = [element("td", name), element("td", between), element("td", when_text(rule))]
    cells += [element("td", limit_mm(rule[level]), class_="number") for level in ("fail", "warn")]
    worst = rule["worst"]
    if worst is None:
        told = "judges nothing" if rule["status"] is None else "nothing nearer was asked for"
        cells += [element("td", told, class_="faint", colspan=5)]
        return element("tr", *cells)
    proven = "" if rule["lower_bound"] is None else mm(rule["lower_bound"])
    at = f"{seconds(worst['time'])}{other_time(worst['obstacle'], worst['time_b'])}"
    cells += [
        element("td", element("span", rule["status"], class_=f"tag {rule['status']}")),
        element("td", mm(worst["clearance"]), class_="number"),
        element("td", proven, class_="number"),
        element("td", f"{worst['link']} - {worst['obstacle']}"),
        element("td", moment_link(worst, at)),
    ]
    moment = {"data_time": worst["time"]} if worst["between"] else {}
    return element("tr", *cells, data_step=worst["step"], tabindex=0, **moment)


def when_text(rule: dict[str, Any]) -> str:
    """When a rule of the summary holds, in a few words."""
    told = [] if rule["from"] is None else [f"from {rule['from']:g} s"]
    told += [] if rule["until"] is None else [f"until {rule['until']:g} s"]
    told += [] if rule["while_carried"] is None else [f"while {rule['while_carried']} is carried"]
    return " ".join(told) or "always"


def name_shown(rule: str) -> str:
    """A rule's name where it stands beside others."""
    return "default limits" if rule == DEFAULT else rule
