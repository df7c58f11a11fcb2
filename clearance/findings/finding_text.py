"""A finding in words: what breaks which rule where, and who waives it. Not for: tables of them (`findings`)."""

from __future__ import annotations

from typing import TYPE_CHECKING

from clearance.codes import coded
from clearance.findings.finding import (
    JOINT_LIMITS,
    OF_TOLERANCES,
    PROFILE,
    UNPROVEN,
    WAIVED_TOLERANCES,
    Finding,
)
from clearance.record.wording import (
    at_least_mm,
    gap_text,
    judged_by,
    limit_mm,
    mm,
    of_rule,
    other_time,
    seconds,
    span_text,
)

if TYPE_CHECKING:
    from clearance.findings.judgement import Judgement


def finding_line(finding: Finding) -> str:
    """What it is, how near, and when, in one line."""
    if finding.kind == JOINT_LIMITS:
        return f"{finding.rule}: {finding.text}"
    if finding.kind == PROFILE:
        verdict = "kept" if not finding.broken else "not kept"
        gap = "" if finding.clearance is None else f", {gap_text(finding.clearance)} mm"
        return f"profile {finding.rule!r} {verdict}{gap}, limit {limit_mm(finding.fail)} mm ({finding.text})"
    if finding.kind == UNPROVEN:
        return _unproven(finding)
    if finding.kind in OF_TOLERANCES:
        return _with_tolerances(finding)
    if finding.clearance is None:
        return (
            f"nothing is below the warn limit of {limit_mm(finding.warn)} mm{of_rule(finding.rule)}"
        )
    return f"{_how_near(finding)}: {bodies_text(finding)} at {when_text(finding)}"


def coded_line(finding: Finding) -> str:
    """The same with its code."""
    return coded(finding_line(finding), finding.code)


def _how_near(finding: Finding) -> str:
    assert finding.clearance is not None
    if finding.status == "contact":
        return f"contact{judged_by(finding.rule)}"
    near = f"{mm(finding.clearance)} mm"
    if finding.broken or finding.status == "near":
        name, limit = ("fail", finding.fail) if finding.broken else ("warn", finding.warn)
        return f"{near}, below the {name} limit of {limit_mm(limit)} mm{of_rule(finding.rule)}"
    return f"{near}{judged_by(finding.rule)}"


def _unproven(finding: Finding) -> str:
    name, limit = ("fail", finding.fail) if finding.broken else ("warn", finding.warn)
    who = f": {bodies_text(finding)}" if finding.body_a else ""
    proven = "" if finding.proven is None else f", {at_least_mm(finding.proven)}"
    claim = (
        f"not proven to stay above the {name} limit of {limit_mm(limit)} mm{of_rule(finding.rule)}"
    )
    return f"{claim}{proven}{who}, {stretch_text(finding)}; {finding.text}"


def _with_tolerances(finding: Finding) -> str:
    limit = f"the fail limit of {limit_mm(finding.fail)} mm{of_rule(finding.rule)}"
    if finding.kind == WAIVED_TOLERANCES:
        limit = f"the {limit_mm(finding.fail)} mm of its waiver"
    claim = f"not proven to keep {limit} with the tolerances"
    if finding.proven is None:
        return f"{claim}: {finding.text}"
    remaining = at_least_mm(finding.proven) if finding.proven > 0.0 else "contact is not ruled out"
    who = f": {bodies_text(finding)} at {when_text(finding)}" if finding.body_a else ""
    nominal = "" if finding.clearance is None else f", {mm(finding.clearance)} mm nominal"
    return f"{claim}: {remaining}{nominal}{who}" + (f"; {finding.text}" if finding.text else "")


def bodies_text(finding: Finding) -> str:
    """The two bodies, and which of several stretches it is."""
    names = " - ".join(name for name in (finding.body_a, finding.body_b) if name)
    return f"{names} (occurrence {finding.occurrence + 1})" if finding.occurrence else names


def who_text(finding: Finding) -> str:
    """The names of both bodies, or a text where a finding has none."""
    if finding.kind == UNPROVEN:
        return bodies_text(finding) or "any pair"
    return bodies_text(finding) or finding.text or "no pair is near"


def when_text(finding: Finding) -> str:
    """When it is least: `1.220 s, step 61`."""
    if finding.time is None or finding.step is None:
        return ""
    where = f"step {finding.step}"
    if finding.between:
        where = f"between the steps {finding.step} and {finding.step + 1}"
    return f"{seconds(finding.time, finding.move)}, {where}{other_time(finding.body_b, finding.time_b)}"


def stretch_text(finding: Finding) -> str:
    """From when until when."""
    if finding.start is None or finding.end is None:
        return ""
    return span_text(finding.start, finding.end, finding.moves)


def waived_text(finding: Finding) -> str:
    """How far it is waived, by whom, why and until when, or that it is accepted; empty where neither is."""
    waived = finding.waived
    if waived is None:
        return (
            "accepted: what is not proven with the tolerances may pass" if finding.accepted else ""
        )
    until = f" until {waived.until}" if waived.until else ""
    return (
        f"waived to at least {limit_mm(waived.at_least)} mm{until} by {waived.by}: {waived.reason}"
    )


def waived_lines(judgement: Judgement) -> tuple[str, ...]:
    """What is waived, the worst first."""
    waived = [f for use in judgement.uses for f in use.findings if f.waived is not None]
    waived.sort(key=lambda finding: finding.standing)
    return tuple(f"{finding_line(finding)}; {waived_text(finding)}" for finding in waived)
