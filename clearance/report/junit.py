"""The record as JUnit XML, so that a build server shows a violated limit as a failed test."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from clearance.report.folder import write_file
from clearance.report.pair_judge import PairJudge
from clearance.report.summary import certified_of
from clearance.report.verdict import Verdict, moment_line, profile_text, verdict_of
from clearance.report.wording import (
    certified_text,
    limit_mm,
    limits_text,
    mm,
    moment_text,
    of_rule,
    seconds,
)
from clearance.simulate.certificate import motion_codes
from clearance.simulate.moment import Moment
from clearance.simulate.record import PairMinimum, Record
from clearance.simulate.rule_answer import RuleAnswer
from clearance.simulate.status import STATUSES, Status
from clearance.world.notice import Severity
from clearance.world.rules import DEFAULT

_NO_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no room for, escaped or not."""


def write_junit(record: Record, path: str | Path) -> None:
    """Writes one test case for the verdict, and one for each that can fail by itself: measured pairs by each rule
    that judges them, rules, the certificate, profiles, the cross-check, suspect input and warnings. Pairs that are
    left out are skipped, and so is a rule that judges nothing.

    A pair fails where its least clearance at the samples is below the fail limit of its rule or it touches, or
    where the certificate has seen it so between two; of the pairs of such an interval it names the one it saw
    nearest. The case of the certificate fails where any does, that of the verdict exactly where the run is not
    passed.

    Raises:
        Unwritable: the file cannot be written; an older one is left as it was.
    """
    verdict = verdict_of(record)
    suite = ElementTree.Element("testsuite", name=record.case.name)
    _verdict(suite, record, verdict)
    _rules(suite, record)
    between = _violated_between(record)
    judge = PairJudge.of(record)
    for minimum in record.pair_minima:
        named = (minimum.link, minimum.obstacle, minimum.rule)
        _pair(suite, judge, minimum, between.get(named))
    for pair in record.unmeasured:
        case = _case(suite, pair.link, f"{pair.link} - {pair.obstacle}")
        ElementTree.SubElement(case, "skipped", message=pair.reason)
    _certificate(suite, record)
    for answer in record.profiles:
        case = _case(suite, "profile", answer.name)
        _tell(case, profile_text(answer), None if answer.passed else "ProfileNotKept")
    _cross_check(suite, record)
    _notices(suite, record)
    _count(suite)
    root = ElementTree.Element("testsuites")
    root.append(suite)
    _make_valid(root)
    ElementTree.indent(root)
    write_file(
        Path(path), ElementTree.tostring(root, encoding="utf-8", xml_declaration=True) + b"\n"
    )


def _case(suite: ElementTree.Element, group: str, name: str) -> ElementTree.Element:
    return ElementTree.SubElement(suite, "testcase", classname=group, name=name)


def _tell(case: ElementTree.Element, text: str, fault: str | None) -> None:
    """Fails the case with a kind of fault, or lets it pass with a text."""
    if fault is None:
        ElementTree.SubElement(case, "system-out").text = text
    else:
        ElementTree.SubElement(case, "failure", type=fault, message=text)


def _count(suite: ElementTree.Element) -> None:
    for attribute, tag in (("failures", "failure"), ("skipped", "skipped")):
        suite.set(attribute, str(len(suite.findall(f"testcase/{tag}"))))
    suite.set("tests", str(len(suite.findall("testcase"))))
    suite.set("errors", "0")


def _verdict(suite: ElementTree.Element, record: Record, verdict: Verdict) -> None:
    properties = ElementTree.SubElement(suite, "properties")
    told = {"verdict": verdict.status, "basis": verdict.basis, "exit_code": str(verdict.exit_code)}
    told["not_checked"] = ", ".join(verdict.not_checked)
    told |= {"clocks": verdict.clocks} if verdict.clocks else {}
    for name, value in told.items():
        ElementTree.SubElement(properties, "property", name=name, value=value)
    worst = record.worst
    text = f"{verdict.text()}: least clearance {mm(worst.clearance)} mm at {moment_text(worst)}"
    not_checked = [f"{name} not checked" for name in verdict.not_checked]
    nearest = [f"nearest of all {verdict.nearest}"] if verdict.nearest else []
    text = "; ".join([text, *verdict.reasons, *nearest, *not_checked])
    _tell(_case(suite, "verdict", "verdict"), text, None if verdict.passed else "NotPassed")


def _rules(suite: ElementTree.Element, record: Record) -> None:
    """One case for each rule where there are any: it fails by its worst moment, or if its limit is not proven."""
    limits = record.case.limits
    if not limits.rules:
        return
    answers = {answer.name: answer for answer in record.rules}
    for i, name in enumerate(limits.rule_names):
        case, own = _case(suite, "rule", name), limits.of_rule(i)
        answer = answers.get(name)
        if answer is None:
            ElementTree.SubElement(case, "skipped", message="no pair is judged by it")
            continue
        text = limits_text(own.fail, own.warn)
        if answer.worst is not None:
            text = f"{moment_line(record, answer.worst)}; {text}"
        _tell(case, text, "LimitViolated" if _is_violated(answer) else None)


def _is_violated(answer: RuleAnswer) -> bool:
    """True if a rule is broken at a step or, as far as proven, between two."""
    codes = [STATUSES.index(Status(answer.status))]
    if answer.certificate is not None:
        codes.append(int(motion_codes(answer.certificate, answer.limits, slice(None)).max()))
    return max(codes) >= STATUSES.index(Status.VIOLATED)


def _violated_between(record: Record) -> dict[tuple[str, str, str], str]:
    """The pairs, with their rules, that a certificate has seen below the fail limit between steps, and where
    they are nearest."""
    found: dict[tuple[str, str, str], str] = {}
    for answer in record.rules:
        for moment in _violating_moments(answer):
            pair = (moment.link, moment.obstacle, answer.name)
            found[pair] = f"{mm(moment.clearance)} mm at {moment_text(moment)}"
    return found


def _violating_moments(answer: RuleAnswer) -> Iterator[Moment]:
    """For each pair that a rule's certificate has seen below the fail limit the moment where it was nearest."""
    certificate = answer.certificate
    if certificate is None:
        return
    codes = motion_codes(certificate, answer.limits, slice(None))
    steps = (codes >= STATUSES.index(Status.VIOLATED)) & (certificate.pair >= 0)
    for pair in np.unique(certificate.pair[steps]):
        own = np.flatnonzero(steps & (certificate.pair == pair))
        moment = certificate.moment_of(int(own[np.argmin(certificate.upper_bound[own])]))
        if moment.clearance < answer.limits.fail or moment.clearance <= 0.0:
            yield moment


def _pair(
    suite: ElementTree.Element, judge: PairJudge, minimum: PairMinimum, between: str | None
) -> None:
    by = "" if minimum.rule == DEFAULT else f" [{minimum.rule}]"
    case = _case(suite, minimum.link, f"{minimum.link} - {minimum.obstacle}{by}")
    limits, status = judge.limits[minimum.rule], Status(judge.status_of(minimum))
    text = (
        f"at the samples {mm(minimum.clearance)} mm at step {minimum.step}, {seconds(minimum.time)}"
    )
    if status in (Status.VIOLATED, Status.CONTACT) or between is not None:
        told = text if between is None else f"{between}; {text}"
        limit = f"the fail limit{of_rule(minimum.rule)} is {limit_mm(limits.fail)} mm"
        _tell(case, f"clearance {told}; {limit}", "LimitViolated")
    else:
        near = "near miss: " if status is Status.NEAR else ""
        _tell(case, f"{near}least clearance {text}", None)


def _certificate(suite: ElementTree.Element, record: Record) -> None:
    case = _case(suite, "certificate", "motion between the samples")
    if record.certificate is None:
        message = "looked at the samples only: nothing is said about the motion between them"
        ElementTree.SubElement(case, "skipped", message=message)
        return
    violated = any(map(_is_violated, record.rules))
    text = certified_text(certified_of(record, record.certificate))
    _tell(case, text, "LimitViolated" if violated else None)


def _cross_check(suite: ElementTree.Element, record: Record) -> None:
    check = record.cross_check
    if check is None:
        return
    case = _case(suite, "cross_check", f"agrees with {check.peer}")
    if not check.agrees:
        n_bad = len({row.step for row in check.disagreements})
        message = (
            f"{n_bad} of {check.n_steps} steps differ by more than "
            f"{check.tolerance:g} m; "
            f"greatest difference {check.greatest_difference:g} m at step {check.worst_step}"
        )
        _tell(case, message, "CrossCheckDisagrees")


_FAULTS = {Severity.SUSPECT: "SuspectInput", Severity.VIOLATED: "RuleBroken"}
"""What kind of failure a notice is."""


def _notices(suite: ElementTree.Element, record: Record) -> None:
    """Suspect input fails unless its kind is accepted, and so does a broken rule; a warning passes."""
    for notice in record.notices:
        fault = _FAULTS.get(notice.severity)
        if notice.severity is Severity.SUSPECT and notice.kind in record.case.accept:
            fault = None
        _tell(
            _case(suite, str(notice.severity), f"{notice.kind}: {notice.text}"), notice.text, fault
        )


def _make_valid(root: ElementTree.Element) -> None:
    """Writes characters that XML cannot hold as their escapes, such as \\uffff."""
    for element in root.iter():
        for name, value in element.attrib.items():
            element.set(name, _without_foreign(value))
        if element.text:
            element.text = _without_foreign(element.text)


def _without_foreign(text: str) -> str:
    return _NO_XML.sub(lambda found: found[0].encode("unicode_escape").decode(), text)
