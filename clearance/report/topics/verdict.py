"""The verdict: what stands on top of every answer, and what puts it in doubt right below."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from clearance.findings.doubts import NOTE, WARNING, doubts_of
from clearance.findings.finding import NOT_PROVEN
from clearance.findings.of_budget import NOT_WORKED_OUT
from clearance.findings.verdict import ACCEPTED, FAIL, UNUSED_WAIVER, Verdict
from clearance.record.wording import count, least_proven, limits_text, mm
from clearance.report.blocks import Bullets, Cell, Content, Header, Inline, capital
from clearance.report.model import PageContent, ReportModel
from clearance.report.moment import depth_of, name_shown, when_of
from clearance.report.topic import Line, Topic
from clearance.world.notice import KINDS, Notice

_TITLES = {
    "clear": "clear",
    "near": "near miss",
    "violated": "limit violated",
    "contact": "contact",
    "suspect": "suspect input",
    UNUSED_WAIVER: UNUSED_WAIVER,
    WARNING: WARNING,
    NOT_PROVEN: NOT_PROVEN,
    FAIL: FAIL,
    ACCEPTED: ACCEPTED,
}

_EXTENTS = {
    "steps": "",
    "pairs": ", each pair at each step",
    "limit": ", exactly below the warn limit, elsewhere a proven bound",
    "minimum": ", for their minimum only",
}


def data(model: ReportModel) -> dict[str, Any]:
    """The verdict: its status, whether it is passed, what it rests on, and why."""
    verdict = model.verdict
    return {
        "verdict": verdict.status,
        "verdict_text": verdict.headline(),
        "measured": verdict.measured,
        "passed": verdict.passed,
        "exit_code": verdict.exit_code,
        "basis": verdict.basis,
        "reasons": list(verdict.reasons),
        "unproven": verdict.unproven,
        "broken": list(verdict.broken),
        "warnings": list(verdict.warnings),
        "suspects": [
            {"code": one.code, "kind": one.kind, "text": one.text} for one in verdict.suspects
        ],
        "doubts": [
            asdict(one) | {"code": one.code}
            for one in doubts_of(model.record, model.judgement)
            if one.kind != NOTE  # `notes` has them
        ],
        "disputed_by": verdict.disputed_by,
        "not_checked": list(verdict.not_checked),
        "nearer": verdict.nearest,
        "clocks": verdict.clocks,
        "waived": list(verdict.waived),
        "n_waivers": verdict.n_waivers,
        "waiver_faults": list(verdict.waiver_faults),
        "at_level": verdict.at_level,
    }


def lines(model: ReportModel) -> Iterator[Line]:
    """What a reader must know beside the clearance: right below the headline."""
    verdict = model.verdict
    if verdict.scope:
        yield "", "; ".join(verdict.scope)
    if verdict.nearest:
        yield "nearest", verdict.nearest
    yield from (("waived", text) for text in verdict.waived)
    yield from (("waivers", text) for text in verdict.waiver_faults)
    yield from (("violated", text) for text in verdict.broken)
    yield from (("not proven", text) for text in verdict.unproven_motion)
    yield from (("tolerances", text) for text in verdict.with_tolerances)
    if verdict.unproven:
        yield "unproven", verdict.unproven
    yield from (("suspect", _suspect(one)) for one in verdict.suspects)
    yield from (("warning", text) for text in verdict.warnings)


def _suspect(notice: Notice) -> str:
    return f"{notice.line} (--accept {notice.kind})" if notice.kind in KINDS else notice.line


def header(content: PageContent) -> Header:
    """Name, verdict, what puts it in doubt, the most critical moment, limits."""
    summary, verdict = content.summary, content.verdict
    signed = summary["sign_off"] or {}
    facts = [
        *_worst_facts(summary),
        ("Certified", _certified_word(summary["certified"])),
        *_limit_facts(summary),
        ("Measured", f"{_extent(summary)}, {summary['motion']} motion"),
        ("Cross-check", _cross_check_word(summary["cross_check"])),
        *((name.capitalize(), value) for name, value in signed.items() if value),
    ]
    others = Bullets(_other_lines(verdict, summary.get("tolerances")), "beside")
    blocks = [Bullets(_headline(summary, verdict), "beside headline"), others]
    shown = [block for block in blocks if block.lines]
    return Header(
        "Clearance report", summary["name"], badge_text(verdict), verdict.shade, shown, facts
    )


def badge_text(verdict: Verdict) -> str:
    """The verdict in a few words."""
    return capital(verdict.headline(_TITLES.__getitem__))


def _worst_facts(summary: dict[str, Any]) -> list[tuple[str, Content]]:
    worst = summary["worst"]
    name = "Least clearance" if summary["nearer"] is None else "Most critical"
    near: Content = [Inline(mm(worst["clearance"]), element="strong"), " mm"]
    if worst["touches"]:
        name, near = "Deepest contact", Inline(depth_of(worst), element="strong")
    return [
        (name, near),
        ("Between", f"{worst['link']} and {worst['obstacle']}"),
        ("At", when_of(worst)),
    ]


def _limit_facts(summary: dict[str, Any]) -> list[tuple[str, Content]]:
    if len(summary["rules"]) == 1:
        limits = summary["limits"]
        return [("Limits", limits_text(limits["fail"], limits["warn"]))]
    rule = next(one for one in summary["rules"] if one["name"] == summary["worst"]["rule"])
    limits = limits_text(rule["fail"], rule["warn"])
    return [("Judged by", name_shown(rule["name"])), ("Its limits", limits)]


def _headline(summary: dict[str, Any], verdict: Verdict) -> list[Content | Cell]:
    """What is most critical by which rule, and what is nearest if that is something else; where there are
    rules."""
    if len(summary["rules"]) == 1:
        return []
    status = summary["worst"]["status"]
    reason = next(iter(verdict.reasons), None) if status != "clear" else None
    found: list[Content | Cell] = [Cell(reason, f"text-{status}")] if reason else []
    return found + ([f"Nearest of all: {verdict.nearest}"] if verdict.nearest else [])


def _other_lines(verdict: Verdict, tolerances: dict[str, Any] | None) -> list[Content | Cell]:
    """What a reader must know beside the clearance, right below the verdict."""
    failing = [
        *(f"Violated: {text}" for text in verdict.beside),
        *map(capital, verdict.unproven_motion),
        *map(capital, verdict.waiver_faults),
    ]
    doubts = [text for text in (verdict.at_level, verdict.unproven) if text]
    doubts += [f"Warning: {text}" for text in verdict.warnings]
    return [
        *(Cell(f"Suspect {one.kind}: {one.line}", "text-suspect") for one in verdict.suspects),
        *(Cell(text, "text-violated") for text in failing),
        *(Cell(f"Waived: {text}", "text-near") for text in verdict.waived),
        *_with_tolerances(tolerances),
        *(Cell(capital(text), "text-near") for text in doubts),
        *map(capital, verdict.scope),
    ]


def _with_tolerances(tolerances: dict[str, Any] | None) -> list[Cell]:
    """What the tolerances leave, a line a rule; marked where a limit is not proven with them."""
    if tolerances is None:
        return []
    marked = tolerances["verdict"] in (NOT_PROVEN, ACCEPTED)
    found = tolerances["lines"] or [f"{capital(NOT_WORKED_OUT)}."]
    return [Cell(line, "text-violated" if marked else "") for line in found]


def _certified_word(certified: dict[str, Any] | None) -> str:
    return "no, measured at the samples only" if certified is None else least_proven(certified)


def _extent(summary: dict[str, Any]) -> str:
    measured = {(pair["link"], pair["obstacle"]) for pair in summary["pairs"]}  # a row a rule
    pairs = f", {count(len(measured), 'pair')}" if measured else ""
    return count(summary["n_steps"], "step") + pairs + _EXTENTS[summary["need"]]


def _cross_check_word(check: dict[str, Any] | None) -> str:
    if check is None:
        return "not asked for"
    return f"agrees with {check['peer']}" if check["agrees"] else f"disagrees with {check['peer']}"


TOPIC: Topic = Topic(data, lines)
