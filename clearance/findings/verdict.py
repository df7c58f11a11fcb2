"""The one verdict of a run: exit code, page, terminal, JUnit, JSON and `Run.passed` are all taken from it.

Not for: measuring, and the words around it (`wording`, `cli.verdict`).
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.codes import coded, codes
from clearance.findings.doubts import (
    DISPUTED,
    SUSPECT,
    UNUSED_WAIVER,
    not_checked,
    not_checked_code,
    open_suspects,
    unproven_motion,
)
from clearance.findings.finding import (
    CLEARANCE,
    NOT_PROVEN,
    PROFILE,
    UNPROVEN,
    WAIVED_TOLERANCES,
    Finding,
)
from clearance.findings.finding_text import coded_line, waived_lines
from clearance.findings.judgement import Judgement
from clearance.findings.of_budget import tolerance_lines
from clearance.findings.of_rule import code_of, why_undecided
from clearance.findings.self_clearance import self_clearance_lines
from clearance.record.certificate import contact_is_open
from clearance.record.moment import Moment
from clearance.record.record import ProfileAnswer, Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import STATUSES, Status
from clearance.record.wording import (
    clock_text,
    count,
    depth_text,
    gap_text,
    limit_mm,
    mm,
    moment_text,
    not_measured_text,
    of_rule,
    span_text,
)
from clearance.tolerance import SEEN_AT_LEVEL
from clearance.world.case import Case
from clearance.world.notice import Notice, Severity
from clearance.world.plausible_recordings import not_measured
from clearance.world.rules import DEFAULT

MOTION, SAMPLES, POSE = "motion", "samples", "pose"
"""What a verdict rests on: a proof for the continuous motion, the samples of the trajectory only, or one pose."""

FAIL, KEPT, ACCEPTED = "fail", "kept", "accepted"
"""What tolerances make of limits: proven to be kept with them, or not, which may pass; else `NOT_PROVEN`, and the
headline says "fail"."""

_PASSING = (Status.CLEAR, Status.NEAR)


@dataclass(frozen=True)
class Verdict:
    """What a run comes to.

    Attributes:
        status: "clear", "near", "violated", "contact", "suspect" where input is in doubt and not accepted, or
            "unused waiver" where a waiver has expired, or is not needed, and all else is well; "not proven" where
            all limits are kept as measured and one is not proven to be with the case's tolerances, or a stretch of
            a program is not.
        measured: the status by what was measured alone, less what is waived.
        basis: "motion", "samples" or "pose", of a run of one step.
        reasons: why it is not clear, one line each.
        unproven: the one of them that says that a limit could not be proven though nothing below it occurs.
        unproven_motion: stretches of a program that are not proven, one line a robot.
        suspects: the notices that make it suspect.
        warnings: what a reader must know beside the clearance; suspect input that is accepted is among it.
        disputed_by: the peer that disagrees, if one does.
        not_checked: what was not looked at.
        self_clearance: how many pairs of links are measured, and why not the others, one line a robot.
        broken: rules of the case that are broken, beside its limits of clearance.
        worst: the most critical moment, of what fails where that is not all waived.
        nearest: the moment of least clearance of all, in one line, where that is not the most critical one.
        clocks: when it holds: how far the actors' clocks may be apart, and which stretches are not measured; empty
            for one clock and all of the run.
        waived: what is below a limit and waived, one line each. n_waivers: how many waivers that takes.
        waiver_faults: what is wrong with waivers, one line each.
        tolerances: what they make of limits that are kept as measured: "kept", "not proven", or "accepted" where
            that is so and may pass; empty without any.
        left: what they leave of the worst limit that is not proven with them, in a few words.
        with_tolerances: what they leave, one line each.
        at_level: that the worst is at a limit but for rounding; empty where none is.
    """

    status: str
    measured: str
    basis: str
    worst: Moment
    reasons: tuple[str, ...] = ()
    unproven: str | None = None
    suspects: tuple[Notice, ...] = ()
    warnings: tuple[str, ...] = ()
    disputed_by: str | None = None
    not_checked: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()
    nearest: str | None = None
    clocks: str = ""
    waived: tuple[str, ...] = ()
    n_waivers: int = 0
    waiver_faults: tuple[str, ...] = ()
    tolerances: str = ""
    left: str = ""
    with_tolerances: tuple[str, ...] = ()
    at_level: str = ""
    self_clearance: tuple[str, ...] = ()
    unproven_motion: tuple[str, ...] = ()

    @property
    def scope(self) -> tuple[str, ...]:
        """The pairs of links that were measured, and all that was not checked, one line each."""
        left_out = (
            coded(f"{name} not checked", not_checked_code(name)) for name in self.not_checked
        )
        return (*self.self_clearance, *left_out)

    @property
    def exit_code(self) -> int:
        """0 clear or near, 1 violated, contact, not proven with tolerances or of a program, or an unused waiver,
        2 suspect, 3 a peer disagrees; the greatest that holds."""
        if self.disputed_by is not None:
            return 3
        if self.status == SUSPECT:
            return 2
        failing = self.waiver_faults or self.tolerances == NOT_PROVEN
        failing = failing or self.unproven_motion
        return 0 if self.measured in _PASSING and not failing else 1

    @property
    def passed(self) -> bool:
        """True if nothing speaks against it: the exit code is 0."""
        return self.exit_code == 0

    @property
    def shade(self) -> str:
        """The status whose colour it has: nothing is green that fails, or that only the samples show."""
        if self.disputed_by or self.status in (UNUSED_WAIVER, NOT_PROVEN):
            return str(Status.VIOLATED)
        by_samples = self.basis == SAMPLES and self.status == Status.CLEAR
        return str(Status.NEAR) if by_samples else self.status

    @property
    def reservations(self) -> tuple[str, ...]:
        """What a reader must know beside the headline, one line each."""
        return (
            *([f"nearest of all {self.nearest}"] if self.nearest else []),
            *(f"waived: {line}" for line in self.waived),
            *self.waiver_faults,
            *self.unproven_motion,
            *self.with_tolerances,
            *self.scope,
            *(f"suspect {one.kind}: {one.line}" for one in self.suspects),
            *self.warnings,
        )

    def text(self) -> str:
        """The verdict with its reservations, in one line."""
        return "; ".join((self.headline(), *self.reservations))

    def headline(self, shown: Callable[[str], str] = str) -> str:
        """The verdict in a few words, the status written as `shown` says."""
        text, passing = shown(self.measured), self.measured in _PASSING
        if passing and self.tolerances not in ("", KEPT):
            decision = shown(ACCEPTED if self.tolerances == ACCEPTED else FAIL)
            text, passing = f"{decision}: limit not proven with tolerances ({self.left})", False
        if self.n_waivers:
            text += f" with {count(self.n_waivers, 'waiver')}"
        if self.tolerances == KEPT:
            text += " with tolerances"
        if self.unproven_motion:
            text = f"{shown(NOT_PROVEN)} on part of the motion, {text} as measured"
        if self.basis == SAMPLES:
            text += " at the samples only" if passing else ", measured at the samples only"
        elif self.basis == POSE:
            text += " at a single pose"
        if self.clocks:
            text += f", {self.clocks}"
        if self.status in (SUSPECT, UNUSED_WAIVER):
            text = f"{shown(self.status)} (would be {text})"
        return text if self.disputed_by is None else f"{text}, but {self.disputed_by} disagrees"


def _when(case: Case) -> str:
    told = (clock_text(case.clock.slack), not_measured_text(not_measured(case)))
    return ", ".join(filter(None, told))


def _left(of_tolerances: Sequence[Finding]) -> str:
    """The worst limit that is not proven with tolerances: proven, required and nominal; empty where all are."""
    if not of_tolerances:
        return ""
    worst = min(of_tolerances, key=lambda finding: finding.standing)
    proven = "nothing proven"
    if worst.proven is not None:
        proven = f"{mm(worst.proven)} mm proven" if worst.proven > 0.0 else "contact not ruled out"
    required = f", {limit_mm(worst.fail)} mm required"
    if worst.kind == WAIVED_TOLERANCES:
        required = ", the level of a waiver required"
    nominal = "" if worst.clearance is None else f"; nominal {mm(worst.clearance)} mm"
    return f"{proven}{required}{nominal}"


def verdict_of(
    record: Record, judgement: Judgement | None = None, of_tolerances: Sequence[Finding] = ()
) -> Verdict:
    """The verdict of a record.

    Args:
        judgement: with the waivers of the case; None where it has none.
        of_tolerances: the limits that are not proven with the tolerances of the case, as `of_budget` finds them.
    """
    notices = record.notices
    suspects = open_suspects(record)
    measured = _measured(record, judgement)
    check = record.cross_check
    disputing = None if check is None or check.agrees else check
    judging = record.rules if judgement is None else judgement.judging
    unproven = _unproven(record, judging)
    worst = record.worst if judgement is None else judgement.worst
    shown = _deciding(record, worst)
    reasons = [reason for reason in (_occurring(record, worst), unproven) if reason is not None]
    open_lines = [coded_line(finding) for finding in of_tolerances]
    reasons = [*open_lines, *reasons] if measured in _PASSING else [*reasons, *open_lines]
    not_proven = tuple(one.line for one in unproven_motion(record))
    reasons = [*not_proven, *reasons] if measured in _PASSING else [*reasons, *not_proven]
    faults = () if judgement is None else judgement.faults
    waiver_faults = tuple(_of_kind(fault, UNUSED_WAIVER) for fault in faults)
    reasons += waiver_faults
    kept = (_of_kind(profile_text(one), PROFILE) for one in record.profiles if not one.passed)
    broken = [f"{one.kind}: {one.line}" for one in notices if one.severity is Severity.VIOLATED]
    reasons += [*kept, *broken, *(f"suspect {one.kind}: {one.line}" for one in suspects)]
    if disputing is not None:
        n_steps = count(len(disputing.disagreements), "step")
        reasons.append(_of_kind(f"{disputing.peer} disagrees at {n_steps}", DISPUTED))
    return Verdict(
        status=SUSPECT
        if suspects
        else _less_open(measured, [*of_tolerances, *not_proven], waiver_faults),
        measured=measured,
        basis=record.basis,
        worst=shown,
        reasons=tuple(reasons),
        unproven=unproven,
        suspects=suspects,
        warnings=tuple(_warnings(record, notices)),
        disputed_by=None if disputing is None else disputing.peer,
        not_checked=tuple(not_checked(record.case)),
        self_clearance=self_clearance_lines(record),
        unproven_motion=not_proven,
        broken=tuple(broken),
        nearest=_nearest(record, shown),
        clocks=_when(record.case),
        waived=() if judgement is None else waived_lines(judgement),
        n_waivers=0 if judgement is None else len(judgement.covering),
        waiver_faults=waiver_faults,
        tolerances=_tolerances(record.case, measured, of_tolerances),
        left=_left(of_tolerances),
        with_tolerances=tolerance_lines(record),
        at_level=_at_level(judging),
    )


def _of_kind(text: str, kind: str) -> str:
    """A line with the code of its kind."""
    return coded(text, codes()[kind])


def _less_open(measured: str, open_limits: Sequence[object], waiver_faults: Sequence[str]) -> str:
    """The status, where no input is suspect."""
    if measured not in _PASSING:
        return measured
    return NOT_PROVEN if open_limits else UNUSED_WAIVER if waiver_faults else measured


def _tolerances(case: Case, measured: str, open_limits: Sequence[Finding]) -> str:
    """What tolerances make of what passes without them; empty where there are none."""
    if case.tolerance is None or measured not in _PASSING:
        return ""
    if not open_limits:
        return KEPT
    return ACCEPTED if case.tolerance.unproven_ok else NOT_PROVEN


def _measured(record: Record, judgement: Judgement | None) -> str:
    """The worst that any step, the motion between, a profile or a rule of the case says, less what is waived."""
    if judgement is None:
        worst = max(map(code_of, record.rules))
    else:
        worst = STATUSES.index(Status(judgement.status))
    broken = any(notice.severity is Severity.VIOLATED for notice in record.notices)
    if broken or not all(answer.passed for answer in record.profiles):
        worst = max(worst, STATUSES.index(Status.VIOLATED))
    return str(STATUSES[worst])


def moment_line(record: Record, moment: Moment) -> str:
    """How near what comes to what and when, and the limit that it is below, if it is: with its rule."""
    limits = record.rule(moment.rule).limits
    if moment.touches:
        return f"contact {contact_line(record, moment)}"
    where = f"{moment.link} - {moment.obstacle} at {moment_text(record, moment)}"
    for name, limit in (("fail", limits.fail), ("warn", limits.warn)):
        if limits.below(moment.clearance, limit):
            below = f"below the {name} limit of {limit_mm(limit)} mm{of_rule(moment.rule)}"
            return f"{mm(moment.clearance)} mm, {below}: {where}"
    if moment.clearance <= 0.0:
        return f"{mm(moment.clearance)} mm less padding{_judged_by(moment)}: {where}"
    return f"{mm(moment.clearance)} mm{_judged_by(moment)}: {where}"


def contact_line(record: Record, moment: Moment) -> str:
    """The depth of a contact, the two bodies and the moment, and the rule that judges them, if there is one."""
    where = f"{moment.link} - {moment.obstacle} at {moment_text(record, moment)}"
    near = depth_text(moment.depth) if moment.depth else f"({depth_text(None)})"
    return f"{near}{_judged_by(moment)}: {where}"


def _judged_by(moment: Moment) -> str:
    return "" if moment.rule == DEFAULT else f", judged by rule {moment.rule!r}"


def _occurring(record: Record, worst: Moment | None) -> str | None:
    """The most critical moment of what decides, if it is below a limit."""
    if worst is None or record.status_of(worst) == Status.CLEAR:
        return None
    return _of_kind(moment_line(record, worst), CLEARANCE)


def _deciding(record: Record, judged: Moment | None) -> Moment:
    """The most critical moment of what fails beside what is waived; else that of all."""
    if judged is None or record.status_of(judged) in _PASSING or _same(judged, record.worst):
        return record.worst
    return judged


def _same(one: Moment, other: Moment) -> bool:
    fields = ("time", "link", "obstacle", "rule")
    return all(getattr(one, name) == getattr(other, name) for name in fields)


def _nearest(record: Record, worst: Moment) -> str | None:
    """The moment of least clearance, where another is more critical."""
    nearest = record.nearest
    return None if nearest is worst or _same(nearest, worst) else moment_line(record, nearest)


def _unproven(record: Record, judging: Sequence[RuleAnswer]) -> str | None:
    """The limit that the proof does not reach though nothing that was seen is below it."""
    for name in ("fail", "warn"):
        for rule in judging:
            text = _not_reached(record, rule, name)
            if text is not None:
                return text
    return None


def _not_reached(record: Record, rule: RuleAnswer, name: str) -> str | None:
    """That a rule's limit of a name is not proven, if nothing was seen below it."""
    certificate = rule.certificate
    if certificate is None:
        return None
    step = certificate.worst_interval
    least, limit = float(certificate.lower_bound[step]), getattr(rule.limits, name)
    seen = np.inf if rule.worst is None else rule.worst.clearance
    is_open = rule.limits.below(least, limit) or (limit <= 0.0 and _contact_is_open(rule))
    if not is_open or rule.limits.below(seen, limit):
        return None
    start, end = map(float, record.motions[0].times[[step, step + 1]])
    when = span_text(start, end, record.moves.over(start, end))
    above = f"above the {name} limit of {limit_mm(limit)} mm" if limit > 0.0 else "out of contact"
    told = (
        f"not proven to stay {above}{of_rule(rule.name)}: at least "
        f"{mm(least)} mm, {when}; {why_undecided(record.case)}"
    )
    return _of_kind(told, UNPROVEN)


def _at_level(judging: Sequence[RuleAnswer]) -> str:
    """A line that the least clearance of a rule equals its limit but for rounding; empty if none does."""
    for rule, name in itertools.product(judging, ("fail", "warn")):
        level, worst, limits = getattr(rule.limits, name), rule.worst, rule.limits
        if worst is None or worst.touches:
            continue
        apart = float(np.linalg.norm(np.subtract(worst.point_link, worst.point_obstacle)))
        if apart <= SEEN_AT_LEVEL * limits.rounding and not _contact_is_open(rule):
            return f"touches but for rounding ({max(apart, worst.clearance):.2g} m apart)"
        certificate = rule.certificate
        proven = worst.clearance if certificate is None else float(certificate.lower_bound.min())
        if level > 0.0 and not limits.below(proven, level):
            off = abs(worst.clearance - level)
            if off <= limits.rounding:
                return f"equal to the {name} limit{of_rule(rule.name)} but for rounding ({off:.2g} m): kept"
    return ""


def _contact_is_open(rule: RuleAnswer) -> bool:
    certificate = rule.certificate
    return certificate is not None and bool(contact_is_open(certificate, rule.limits).any())


def profile_text(answer: ProfileAnswer) -> str:
    """Whether a profile is kept, how close it comes, who and when."""
    verdict = "kept" if answer.passed else "NOT KEPT"
    what = "distance" if answer.mode == "nearest" else "gap"
    at = "" if answer.section is None else f" at {answer.section:g} m"
    return (
        f"{answer.name} ({answer.mode}, {answer.plane}{at}): {verdict}, {what} {gap_text(answer.gap)} mm, "
        f"limit {answer.limit * 1000:g} mm, {answer.link}, step {answer.step}"
    )


def _warnings(record: Record, notices: tuple[Notice, ...]) -> list[str]:
    """Warnings, and suspect input that is accepted; each once."""
    told = [one.line for one in notices if one.severity is Severity.WARNING]
    if record.certificate is None:
        told += [one.line for one in notices if one.severity is Severity.UNPROVEN]
    told += [
        f"{one.line} (accepted: {one.kind})"
        for one in notices
        if one.severity is Severity.SUSPECT and one.kind in record.case.accept
    ]
    return list(dict.fromkeys(told))
