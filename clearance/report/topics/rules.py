"""The rules of a case: limits, when they hold, the most critical moment.

Not for: judging (`simulate.answers.run_answer`).
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from typing import Any

import numpy as np

from clearance.record.rule_answer import RuleAnswer
from clearance.record.wording import (
    depth_text,
    limit_mm,
    limits_text,
    mm,
    moment_text,
    near_mm,
    other_time,
)
from clearance.report.blocks import Cell, Content, Inline, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import at_moment, moment_link, moment_row, name_shown, time_of
from clearance.report.topic import Line, Topic
from clearance.world.rules import Rule
from clearance.world.timing import time_text


def data(model: ReportModel) -> dict[str, Any]:
    """The limits, and all rules of the case in its order, the limits by themselves first."""
    limits = model.record.case.limits
    answers = {answer.name: answer for answer in model.record.rules}
    n_pairs = Counter(pair.rule for pair in model.session.pair_minima())
    own: list[Rule | None] = [None, *limits.rules]
    rules = [
        _rule_row(model, i, rule, answers.get(name)) | {"name": name, "n_pairs": n_pairs.get(name)}
        for i, (name, rule) in enumerate(zip(limits.rule_names, own, strict=True))
    ]
    return {
        "limits": {name: getattr(limits, name) for name in ("fail", "warn", "joints")},
        "rules": rules,
    }


def _rule_row(
    model: ReportModel, i: int, rule: Rule | None, answer: RuleAnswer | None
) -> dict[str, Any]:
    """A rule; one that judges no pair has no status."""
    record = model.record
    limits = record.case.limits.of_rule(i)
    worst = None if answer is None else model.worst_of[answer.name]
    window = (-math.inf, math.inf) if rule is None else (rule.window.start, rule.window.end)
    sample = None if answer is None else answer.worst_sample
    return {
        "between": None if rule is None else list(rule.between),
        "from": _finite(window[0]),
        "until": _finite(window[1]),
        "while_carried": None if rule is None else rule.while_carried,
        "fail": limits.fail,
        "warn": limits.warn,
        "status": None if answer is None else answer.status,
        "lower_bound": _proven(answer),
        "worst": None if worst is None else moment_row(record, worst),
        "worst_sample": None if sample is None else moment_row(record, sample),
    }


def _proven(answer: RuleAnswer | None) -> float | None:
    """The least proven bound [m] of what a rule judges; None where nothing is proven."""
    if answer is None or answer.certificate is None:
        return None
    return _finite(float(np.min(answer.certificate.lower_bound)))


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def lines(model: ReportModel) -> Iterator[Line]:
    """One line for each rule of the case, if it has any: how it stands, and its worst moment."""
    limits = model.record.case.limits
    answers = {answer.name: answer for answer in model.record.rules}
    for i, name in enumerate(limits.rule_names if limits.rules else ()):
        own = limits.of_rule(i)
        standing = _standing(model, answers.get(name))
        yield "rule", f"{name} ({limits_text(own.fail, own.warn)}): {standing}"


def _standing(model: ReportModel, answer: RuleAnswer | None) -> str:
    if answer is None:
        return "judges nothing"
    if answer.worst is None:
        return f"{answer.status}, nothing nearer was asked for"
    worst = model.worst_of[answer.name] or answer.worst
    near = depth_text(worst.depth) if worst.touches else f"{mm(worst.clearance)} mm"
    return f"{answer.status}, {near}, {worst.link} - {worst.obstacle} at {moment_text(model.record, worst)}"


def sections(content: PageContent) -> Iterator[Section]:
    """The rules as a table; nothing where the case has none."""
    rules = content.summary["rules"]
    if len(rules) < 2:
        return
    heads = (
        "Rule", "Between", "Holds", ">Fail, mm", ">Warn, mm", "Status", ">Least, mm", ">Certified, mm",
        "Where", "When",
    )  # fmt: skip
    in_order = sorted(rules, key=lambda rule: rule["worst"] is None)
    rows = [_row(rule, content.summary["worst"]["rule"]) for rule in in_order]
    note = "Where rules overlap, the last one that matches a pair judges it. Least has the padding taken off."
    yield Section("Rules", [Table(heads, rows, "clickable rules"), faint(note)])


def _row(rule: dict[str, Any], worst_of_all: str) -> Row:
    name: Content = name_shown(rule["name"])
    if rule["name"] == worst_of_all:
        name = Inline(name_shown(rule["name"]), element="strong")
    between = "all other pairs" if rule["between"] is None else " - ".join(rule["between"])
    levels = [number(limit_mm(rule[level])) for level in ("fail", "warn")]
    cells: list[Content | Cell] = [name, between, when_text(rule), *levels]
    worst = rule["worst"]
    if worst is None:
        why = "judges nothing" if rule["status"] is None else "nothing nearer was asked for"
        return Row([*cells, Cell(why, "faint", colspan=5)])
    at = f"{time_of(worst)}{other_time(worst['obstacle'], worst['time_b'])}"
    found: list[Content | Cell] = [
        Inline(rule["status"], f"tag {rule['status']}"),
        number(near_mm(worst["clearance"], rule["status"])),
        number("" if rule["lower_bound"] is None else mm(rule["lower_bound"])),
        f"{worst['link']} - {worst['obstacle']}",
        moment_link(worst, at),
    ]
    return Row([*cells, *found], at_moment(worst))


def when_text(rule: dict[str, Any]) -> str:
    """When a rule of the summary holds, in a few words."""
    parts = [] if rule["from"] is None else [f"from {time_text(rule['from'])} s"]
    parts += [] if rule["until"] is None else [f"until {time_text(rule['until'])} s"]
    parts += [] if rule["while_carried"] is None else [f"while {rule['while_carried']} is carried"]
    return " ".join(parts) or "always"


TOPIC: Topic = Topic(data, lines, sections)
