"""Reserved outlines: is each kept, how close, who and when, with a picture."""

from __future__ import annotations

import base64
from collections.abc import Iterator
from dataclasses import fields
from typing import Any

from clearance.findings.limit_lines import profile_text
from clearance.record.record import ProfileAnswer
from clearance.record.wording import gap_text, swept_text
from clearance.report.blocks import At, Inline, Picture, Row, Section, Table, faint, number
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import step_link
from clearance.report.topic import Line, Topic


def data(model: ReportModel) -> dict[str, Any]:
    """The answer of each profile."""
    return {"profiles": [_answer_row(answer) for answer in model.record.profiles]}


def _answer_row(answer: ProfileAnswer) -> dict[str, Any]:
    return {field.name: getattr(answer, field.name) for field in fields(answer)}


def lines(model: ReportModel) -> Iterator[Line]:
    """A line for each."""
    return (("profile", profile_text(answer)) for answer in model.record.profiles)


def sections(content: PageContent) -> Iterator[Section]:
    """A table and the pictures; nothing where the case names no profile."""
    answers = content.summary["profiles"]
    if not answers:
        return
    heads = ("Profile", "Plane", "Kept", ">Gap, mm", ">Limit, mm", "Closest", "When")
    pictures = [
        _picture(answer["name"], content.pictures[answer["name"]])
        for answer in answers
        if answer["name"] in content.pictures
    ]
    note = (
        "Gaps are proven for the continuous motion, between the steps too, and rounded down; "
        "the true gap is larger by at most the bound in summary.json. A negative gap is how far the swept "
        "outline is beyond the sketch."
    )
    left_out = dict.fromkeys(text for answer in answers for text in answer["left_out"])
    note = " ".join((note, *(f"{text[0].upper()}{text[1:]}." for text in left_out)))
    table = Table(heads, [_row(answer) for answer in answers], "clickable")
    yield Section("Profiles", [table, faint(note), *pictures])


def _row(answer: dict[str, Any]) -> Row:
    cells = [
        f"{answer['name']} ({answer['mode']})",
        swept_text(answer["plane"], answer["section"], answer["links"]),
        _kept(answer),
        number(gap_text(answer["gap"])),
        number(f"{answer['limit'] * 1000:g}"),
        answer["link"],
        step_link(answer["step"]),
    ]
    return Row(cells, At(answer["step"]))


def _kept(answer: dict[str, Any]) -> Inline:
    if not answer["passed"]:
        return Inline("no", "text-violated")
    return Inline("yes, as far as swept" if answer["left_out"] else "yes")


def _picture(name: str, svg: str) -> Picture:
    source = "data:image/svg+xml;base64," + base64.b64encode(svg.encode()).decode()
    return Picture(source, f"profile {name}")


TOPIC: Topic = Topic(data, lines, sections)
