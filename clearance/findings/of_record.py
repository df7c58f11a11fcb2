"""All findings of a record, the worst first. Not for: one rule's (`of_rule`), waiving them (`judgement`)."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import replace

from clearance.findings.finding import JOINT_LIMITS, PROFILE, Finding, FindingName
from clearance.findings.judgement import Judgement
from clearance.findings.occurrences import release_level
from clearance.record.contact import StepContact
from clearance.record.record import ProfileAnswer, Record
from clearance.record.rule_answer import MOST_NEAR_STEPS
from clearance.record.session import Session
from clearance.record.status import Status
from clearance.record.wording import swept_text
from clearance.world.notice import Severity


def findings_of(
    record: Record, judgement: Judgement, of_tolerances: Sequence[Finding] = ()
) -> tuple[Finding, ...]:
    """The findings of a record, the worst first; each rule that judges something has one at least.

    What its waivers cover is `waived`, and is there all the same.

    Args:
        of_tolerances: the findings of `of_budget`.
    """
    found = [*_with_depths(record, judgement.findings), *of_tolerances]
    found += [_of_profile(record, answer) for answer in record.profiles]
    found += _of_joints(record)
    return tuple(sorted(found, key=lambda finding: finding.standing))


def _with_depths(record: Record, findings: Sequence[Finding]) -> Iterator[Finding]:
    """The findings; contacts with the depth of the deepest overlap of theirs that was worked out."""
    overlaps: dict[frozenset[str], list[StepContact]] = {}
    for one in record.worked_out:
        overlaps.setdefault(frozenset((one.link, one.obstacle)), []).append(one)
    for finding in findings:
        own = overlaps.get(frozenset((finding.body_a, finding.body_b)), [])
        own = [one for one in own if finding.holds_at(one.time)]
        deepest = max(own, key=lambda one: one.penetration, default=None)
        if finding.status != Status.CONTACT or deepest is None or deepest.known is None:
            yield finding
        else:
            depth = deepest.known
            yield replace(
                finding,
                penetration=depth.penetration,
                penetration_at_least=depth.penetration_at_least,
            )


def why_incomplete(session: Session) -> str:
    """Why a pair below its warn limit could have no finding of its own; empty where none can."""
    record = session.record
    if record.need == "minimum":
        return "only the least of all steps was asked for (need 'minimum')"
    if record.method == "paper":
        return "of each step only the nearest pair is known (method 'paper')"
    if record.case.clock.slack > 0.0:
        return "where clocks are not tied only the nearest pair of each step is known"
    for rule in record.rules:
        if session.is_cut(rule, release_level(rule.limits)):
            return f"more than {MOST_NEAR_STEPS:,} steps are near; only the nearest pair of each is listed"
    return ""


def _of_profile(record: Record, answer: ProfileAnswer) -> Finding:
    status = Status.CLEAR if answer.passed else Status.VIOLATED
    name = FindingName(record.case.name, PROFILE, answer.name, ())
    return name.finding(
        body_a=answer.link,
        status=str(status),
        clearance=float(answer.gap),
        proven=float(answer.gap) if answer.mode != "nearest" else None,
        fail=float(answer.limit),
        warn=float(answer.limit),
        time=float(record.motions[0].times[answer.step]),
        step=int(answer.step),
        text=f"{answer.mode}, {swept_text(answer.plane, answer.section, answer.links)}",
    ).with_moves(record.moves)


def _of_joints(record: Record) -> Iterator[Finding]:
    """The joints beyond their limits, a finding a robot, where the case fails by them."""
    numbers: Counter[tuple[str, str]] = Counter()
    for notice in record.notices:
        if notice.severity is not Severity.VIOLATED:
            continue
        occurrence = numbers[notice.kind, notice.about]
        numbers[notice.kind, notice.about] += 1
        bodies = (notice.about,)
        name = FindingName(record.case.name, JOINT_LIMITS, notice.kind, bodies, occurrence)
        yield name.finding(status=str(Status.VIOLATED), fail=0.0, warn=0.0, text=notice.text)
