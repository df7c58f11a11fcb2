"""The test cases that a record is to a build server: what can fail by itself, and how it stands.

Not for: writing them (`junit`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

from clearance.codes import coded_of
from clearance.findings.doubts import UNUSED_WAIVER, open_warnings, unproven_motion
from clearance.findings.finding import (
    CLEARANCE,
    OF_TOLERANCES,
    UNPROVEN,
    WAIVED_TOLERANCES,
    Finding,
)
from clearance.findings.finding_text import bodies_text, coded_line, waived_text
from clearance.findings.judgement import Judgement
from clearance.findings.limit_lines import moment_line, profile_text
from clearance.findings.of_budget import budget_lines
from clearance.findings.of_rule import code_of
from clearance.findings.verdict import Verdict
from clearance.record.record import PairMinimum, Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import STATUSES, Status
from clearance.record.wording import (
    at_least_mm,
    certified_text,
    least_text,
    limit_mm,
    limits_text,
    moment_text,
    near_mm,
    of_rule,
    seconds,
    step_text,
)
from clearance.report.junit import TestResult, write_junit
from clearance.report.model import ReportModel
from clearance.report.moment import name_shown
from clearance.report.topics.certainty import certified_of
from clearance.report.topics.pairs import PairJudge, is_loose, may_come_nearer
from clearance.world.notice import Severity
from clearance.world.rules import DEFAULT

VIOLATED = STATUSES.index(Status.VIOLATED)

LIMIT = "LimitViolated"
"""The kind of failure that a clearance below its fail limit is."""


def write_run_junit(model: ReportModel, path: Path) -> None:
    """Writes one test case for the verdict, and one for each thing that can fail by itself.

    What is waived is skipped, with who waives it and why.

    Raises:
        Unwritable: the file cannot be written; an older one is left as it was.
    """
    write_junit(model.record.case.name, [*results_of(model)], path, _properties(model.verdict))


def _properties(verdict: Verdict) -> dict[str, str]:
    properties = {
        "verdict": verdict.status,
        "basis": verdict.basis,
        "exit_code": str(verdict.exit_code),
        "not_checked": ", ".join(verdict.not_checked),
    }
    properties |= (
        {"self_clearance": "; ".join(verdict.self_clearance)} if verdict.self_clearance else {}
    )
    return properties | ({"clocks": verdict.clocks} if verdict.clocks else {})


def results_of(model: ReportModel) -> Iterator[TestResult]:
    """All cases; that of the verdict, which comes first, fails exactly where the run is not passed."""
    record, judgement = model.record, model.judgement
    yield _of_verdict(record, model.verdict)
    yield from _of_waivers(judgement)
    yield from _of_rules(model)
    yield from _of_pairs(model)
    yield from _of_budget(model)
    for pair in record.unmeasured:
        yield TestResult(pair.link, f"{pair.link} - {pair.obstacle}", pair.reason, skipped=True)
    yield _of_certificate(record, judgement)
    for answer in record.profiles:
        fault = "" if answer.passed else "ProfileNotKept"
        yield TestResult("profile", answer.name, profile_text(answer), fault)
    yield from _of_cross_check(record)
    yield from _of_notices(record)


def _of_verdict(record: Record, verdict: Verdict) -> TestResult:
    worst = verdict.worst
    text = f"{verdict.headline()}: {least_text(worst)} at {moment_text(record, worst)}"
    waived = [f"waived: {line}" for line in verdict.waived]
    nearest = [f"nearest of all {verdict.nearest}"] if verdict.nearest else []
    at_level = [verdict.at_level] if verdict.at_level else []
    text = "; ".join([text, *at_level, *verdict.reasons, *waived, *nearest, *verdict.scope])
    return TestResult("verdict", "verdict", text, "" if verdict.passed else "NotPassed")


def _of_waivers(judgement: Judgement) -> Iterator[TestResult]:
    for use in judgement.uses:
        fault = "UnusedWaiver" if use.fault else ""
        text = coded_of(use.fault, UNUSED_WAIVER) if fault else use.waiver.reason
        yield TestResult("waiver", str(use.waiver), text, fault)


def _of_rules(model: ReportModel) -> Iterator[TestResult]:
    """One case for each rule where there are any: it fails by its worst moment, or if its limit is not proven."""
    record, judgement = model.record, model.judgement
    limits, worst_of = record.case.limits, judgement.worst_of
    if not limits.rules:
        return
    for i, name in enumerate(limits.rule_names):
        if not any(answer.name == name for answer in record.rules):
            yield TestResult("rule", name, "no pair is judged by it", skipped=True)
            continue
        own, answers = limits.of_rule(i), [one for one in judgement.judging if one.name == name]
        text, worst = limits_text(own.fail, own.warn), worst_of.get(name)
        if worst is not None:
            line = moment_line(record, worst)
            text = line if text in line else f"{line}; {text}"
        yield TestResult("rule", name, text, LIMIT if any(map(_is_violated, answers)) else "")


def _is_violated(answer: RuleAnswer) -> bool:
    return code_of(answer) >= VIOLATED


def _of_pairs(model: ReportModel) -> Iterator[TestResult]:
    """One case for each finding that is not clear, and for each pair without one, by each rule that judges it."""
    listed, broken = set(), {one.name for one in model.judgement.judging if _is_violated(one)}
    hidden = broken if model.may_lack else set()
    for finding in model.judgement.findings:
        if finding.status != Status.CLEAR:
            listed.add((finding.body_a, finding.body_b, finding.rule))
            yield _unless_hidden(model, _of_finding(finding), finding.rule in hidden)
    judge = PairJudge.of(model.record)
    for minimum in model.session.motion_minima():
        if (minimum.link, minimum.obstacle, minimum.rule) not in listed:
            is_hidden = minimum.proven is None and minimum.rule in hidden
            yield _unless_hidden(model, _of_minimum(model.record, judge, minimum), is_hidden)


def _unless_hidden(model: ReportModel, result: TestResult, is_hidden: bool) -> TestResult:
    """The result; skipped where it is no failure, and a nearer pair may hide that it is one."""
    if not is_hidden or result.fault or result.skipped:
        return result
    text = f"not judged by itself, since its rule is broken and {model.may_lack}; {result.text}"
    return replace(result, text=text, skipped=True)


def _of_finding(finding: Finding) -> TestResult:
    by = "" if finding.rule == DEFAULT else f" [{finding.rule}]"
    name = f"{bodies_text(finding)}{by}"
    group, text = (
        finding.body_a,
        f"{coded_line(finding)} (finding {finding.id})",
    )
    if finding.kind == UNPROVEN:
        group, name = "unproven", f"{bodies_text(finding) or 'the motion between the samples'}{by}"
    if finding.kind in OF_TOLERANCES:
        return _of_tolerances(finding, text)
    if finding.waived is not None:
        return TestResult(group, name, f"{waived_text(finding)}; {text}", skipped=True)
    near = "near miss: " if finding.status == Status.NEAR else ""
    least = "clearance " if finding.kind == CLEARANCE and not near else ""
    return TestResult(group, name, f"{near}{least}{text}", LIMIT if finding.broken else "")


def _of_budget(model: ReportModel) -> Iterator[TestResult]:
    """One case for each rule that is kept without tolerances: whether it is proven to be with them."""
    record, judgement, found = model.record, model.judgement, model.of_tolerances
    yield from map(_of_finding, found)
    broken = {answer.name for answer in judgement.judging if _is_violated(answer)}
    listed = broken | {finding.rule for finding in found}
    for one, line in zip(record.budget or (), budget_lines(record), strict=True):
        if one.rule not in listed:
            yield TestResult("tolerances", name_shown(one.rule), line)


def _of_tolerances(finding: Finding, text: str) -> TestResult:
    group, name = "tolerances", name_shown(finding.rule)
    if finding.kind == WAIVED_TOLERANCES:
        name = f"{bodies_text(finding)} [{name}]"
    if finding.accepted:
        return TestResult(group, name, f"{waived_text(finding)}; {text}", skipped=True)
    return TestResult(group, name, text, "NotProven")


def _of_minimum(record: Record, judge: PairJudge, minimum: PairMinimum) -> TestResult:
    by = "" if minimum.rule == DEFAULT else f" [{minimum.rule}]"
    name = f"{minimum.link} - {minimum.obstacle}{by}"
    status = Status(judge.status_of(minimum))
    over = "at the samples " if minimum.proven is None and not minimum.between else ""
    when = seconds(minimum.time, record.moves.at(minimum.time))
    at = f"{over}{near_mm(minimum.clearance, status, ' mm')} at {when}, step {step_text(minimum)}"
    if status in (Status.VIOLATED, Status.CONTACT):
        fail = judge.limits[minimum.rule].fail
        limit = f"the fail limit{of_rule(minimum.rule)} is {limit_mm(fail)} mm"
        return TestResult(
            minimum.link,
            name,
            f"{'' if status is Status.CONTACT else 'clearance '}{at}; {limit}",
            LIMIT,
        )
    near = "near miss: " if status is Status.NEAR else ""
    return TestResult(minimum.link, name, f"{near}least clearance {at}{_bound(record, minimum)}")


def _bound(record: Record, minimum: PairMinimum) -> str:
    """The proven bound, where a pair may come nearer than was seen by more than the certificate's gap."""
    certificate = record.certificate
    if certificate is None:
        return ""
    if minimum.proven is None:
        nearer = may_come_nearer(certified_of(record, certificate))
        return f"; {nearer[0].lower()}{nearer[1:].removesuffix('.')}"
    return f"; {at_least_mm(minimum.proven)} is proven" if is_loose(record, minimum) else ""


def _of_certificate(record: Record, judgement: Judgement) -> TestResult:
    group, name = "certificate", "motion between the samples"
    if record.certificate is None:
        text = "measured at the samples only: the motion between them is not checked"
        return TestResult(group, name, text, skipped=True)
    violated = any(map(_is_violated, judgement.judging))
    text = certified_text(certified_of(record, record.certificate))
    return TestResult(group, name, text, LIMIT if violated else "")


def _of_cross_check(record: Record) -> Iterator[TestResult]:
    check = record.cross_check
    if check is None:
        return
    n_bad = len({row.step for row in check.disagreements})
    text = (
        f"{n_bad} of {check.n_steps} steps differ by more than {check.tolerance:g} m; "
        f"greatest difference {check.greatest_difference:g} m at step {check.worst_step}"
    )
    fault = "" if check.agrees else "CrossCheckDisagrees"
    yield TestResult("cross_check", f"agrees with {check.peer}", text, fault)


_FAULTS = {
    Severity.SUSPECT: "SuspectInput",
    Severity.VIOLATED: "RuleBroken",
    Severity.UNPROVEN: "NotProven",
}
"""What kind of failure a notice is."""


def _of_notices(record: Record) -> Iterator[TestResult]:
    """Suspect input fails unless its kind is accepted, as does a broken rule, and a warning if asked."""
    warned = open_warnings(record) if record.case.fail_on_warning else ()
    for notice in record.notices:
        fault = "Warning" if notice in warned else _FAULTS.get(notice.severity, "")
        if notice.severity is Severity.SUSPECT and notice.accepted_by(record.case.accept):
            fault = ""
        if notice.severity is Severity.UNPROVEN and notice not in (
            *unproven_motion(record),
            *warned,
        ):
            fault = ""
        name = f"{notice.kind}: {notice.text}"
        yield TestResult(str(notice.severity), name, notice.line, fault)
