"""The one verdict of a run: exit code, page, terminal, JUnit, JSON and `Run.passed` are all taken from it.

Not for: measuring, and the words around it (`wording`, `report.terminal`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NoReturn

from clearance.codes import coded, coded_of
from clearance.errors import refuse_truth
from clearance.findings.doubts import (
    DISPUTED,
    SUSPECT,
    UNUSED_WAIVER,
    WARNING,
    not_checked,
    not_checked_code,
    open_suspects,
    open_warnings,
    unproven_motion,
)
from clearance.findings.finding import (
    CLEARANCE,
    NOT_PROVEN,
    PROFILE,
    WAIVED_TOLERANCES,
    Finding,
)
from clearance.findings.finding_text import coded_line, waived_lines
from clearance.findings.judgement import Judgement
from clearance.findings.limit_lines import (
    at_level_line,
    moment_line,
    profile_text,
    unproven_line,
)
from clearance.findings.of_budget import tolerance_lines
from clearance.findings.self_clearance import left_out_lines, self_clearance_lines
from clearance.record.moment import Moment
from clearance.record.record import CrossCheck, Record
from clearance.record.status import STATUSES, Status
from clearance.record.wording import (
    clock_text,
    count,
    limit_mm,
    mm,
    not_measured_text,
)
from clearance.world.case import Case
from clearance.world.notice import Notice, Severity
from clearance.world.plausible_recordings import not_measured

MOTION, SAMPLES, POSE = "motion", "samples", "pose"
"""What a verdict rests on: a proof for the continuous motion, the samples of the trajectory only, or one pose."""

FAIL, KEPT, ACCEPTED = "fail", "kept", "accepted"
"""What tolerances make of limits: proven to be kept with them, or not, which may pass; else `NOT_PROVEN`, and the
headline says "fail"."""

BEYOND = ("limits", "joint limits")
"""Kinds of notices on motions that the robot cannot make."""

_PASSING = (Status.CLEAR, Status.NEAR)


@dataclass(frozen=True)
class Verdict:
    """What a run comes to.

    Attributes:
        status: "clear", "near", "violated", "contact", "suspect" where input is in doubt and not accepted, or
            "unused waiver" where a waiver has expired, or is not needed, and all else is well; "warning" where one
            fails the run, as the case asks; "not proven" where all limits are kept as measured and one is not
            proven to be with the case's tolerances, or a stretch of a program is not.
        measured: the status by what was measured alone, less what is waived.
        basis: "motion", "samples" or "pose", of a run of one step.
        reasons: why it is not clear, one line each.
        unproven: the one of them that says that a limit could not be proven though nothing below it occurs.
        unproven_motion: stretches of a program that are not proven, one line a robot.
        suspects: the notices that make it suspect.
        warnings: what a reader must know beside the clearance; suspect input that is accepted is among it.
        warned: those that fail the run: the ones that are not accepted, where the case asks for that.
        disputed_by: the peer that disagrees, if one does.
        not_checked: what was not looked at.
        self_clearance: how many pairs of links are measured, and why not the others, one line a robot.
        simulated: the motion is that of a simulated robot, not the trajectory.
        excused: links that are excluded, and pairs that are allowed, one line each.
        broken: rules of the case that are broken, beside its limits of clearance. beside: these and the profiles
            that are not kept.
        worst, worst_sample: the most critical moment, and step: of what is not waived where that is not clear,
            else of all. Whoever tells one moment of a run tells this one.
        nearest: the moment of least clearance of all, in one line, where that is not the most critical one.
        clocks: when it holds: how far the actors' clocks may be apart, and which stretches are not measured; empty
            for one clock and all of the run. has_holes: some are not measured.
        waived: what is below a limit and waived, one line each. n_waivers: how many waivers that takes.
        waiver_faults: what is wrong with waivers, one line each.
        tolerances: what they make of limits that are kept as measured: "kept", "not proven", or "accepted" where
            that is so and may pass; empty without any.
        left: what they leave of the worst limit that is not proven with them, in a few words.
        with_tolerances: what they leave, one line each.
        at_level: that the worst is at a limit but for rounding; empty where none is.
        beyond: that joints go farther, or are faster, than they may: the robot cannot move so; else empty.
    """

    status: str
    measured: str
    basis: str
    worst: Moment
    worst_sample: Moment
    reasons: tuple[str, ...] = ()
    unproven: str | None = None
    suspects: tuple[Notice, ...] = ()
    warnings: tuple[str, ...] = ()
    disputed_by: str | None = None
    not_checked: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()
    nearest: str | None = None
    clocks: str = ""
    waived: tuple[str, ...] = ()
    n_waivers: int = 0
    waiver_faults: tuple[str, ...] = ()
    tolerances: str = ""
    remaining: str = ""
    with_tolerances: tuple[str, ...] = ()
    at_level: str = ""
    self_clearance: tuple[str, ...] = ()
    unproven_motion: tuple[str, ...] = ()
    beyond: str = ""
    excused: tuple[str, ...] = ()
    warned: tuple[str, ...] = ()
    simulated: bool = False
    has_holes: bool = False

    def __bool__(self) -> NoReturn:
        refuse_truth(self, "passed")

    @property
    def scope(self) -> tuple[str, ...]:
        """The pairs of links that were measured, and all that was not checked, one line each."""
        left_out = (
            coded(f"{name} not checked", not_checked_code(name)) for name in self.not_checked
        )
        return (*self.self_clearance, *left_out, *self.excused)

    @property
    def exit_code(self) -> int:
        """0 clear or near, 1 violated, contact, not proven with tolerances or of a program, an unused waiver, or a
        warning that fails, 2 suspect, 3 a peer disagrees; the greatest that holds."""
        if self.disputed_by is not None:
            return 3
        if self.status == SUSPECT:
            return 2
        failing = self.waiver_faults or self.tolerances == NOT_PROVEN
        failing = failing or self.unproven_motion or self.warned
        return 0 if self.measured in _PASSING and not failing else 1

    @property
    def passed(self) -> bool:
        """True if nothing speaks against it: the exit code is 0."""
        return self.exit_code == 0

    @property
    def shade(self) -> str:
        """The status whose colour it has: nothing is green that fails, or of which only a part is measured."""
        if self.disputed_by or self.status in (UNUSED_WAIVER, NOT_PROVEN, WARNING):
            return str(Status.VIOLATED)
        in_part = (self.basis == SAMPLES or self.has_holes) and self.status == Status.CLEAR
        return str(Status.NEAR) if in_part else self.status

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
            text, passing = (
                f"{decision}: limit not proven with tolerances ({self.remaining})",
                False,
            )
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
        if self.simulated:
            text += ", in simulated motion"
        if self.clocks:
            text += f", {self.clocks}"
        if self.beyond:
            text += f", {self.beyond}"
        if self.status in (SUSPECT, UNUSED_WAIVER, WARNING):
            text = f"{shown(self.status)} (would be {text})"
        return text if self.disputed_by is None else f"{text}, but {self.disputed_by} disagrees"


def _when(case: Case) -> str:
    parts = (clock_text(case.clock.slack), not_measured_text(not_measured(case)))
    return ", ".join(filter(None, parts))


def _remaining(of_tolerances: Sequence[Finding]) -> str:
    """The worst limit that is not proven with tolerances: proven and required; empty where all are."""
    if not of_tolerances:
        return ""
    worst = min(of_tolerances, key=lambda finding: finding.standing)
    proven = "nothing proven"
    if worst.proven is not None:
        proven = f"{mm(worst.proven)} mm proven" if worst.proven > 0.0 else "contact not ruled out"
    by = " by a waiver" if worst.kind == WAIVED_TOLERANCES else ""
    return f"{proven}, {limit_mm(worst.fail)} mm required{by}"


def verdict_of(
    record: Record, judgement: Judgement, of_tolerances: Sequence[Finding] = ()
) -> Verdict:
    """The verdict of a record.

    Args:
        judgement: with the waivers of the case.
        of_tolerances: the limits that are not proven with the tolerances of the case, as `of_budget` finds them.
    """
    notices = record.notices
    suspects = open_suspects(record)
    measured = _measured(record, judgement)
    check = record.cross_check
    disputing = None if check is None or check.agrees else check
    judging = judgement.judging
    unproven = unproven_line(record, judging)
    worst, sample, is_open = _most_critical(record, judgement)
    occurring = [coded_of(moment_line(record, worst), CLEARANCE)] if is_open else []
    reasons = [*occurring, *([] if unproven is None else [unproven])]
    open_lines = [coded_line(finding) for finding in of_tolerances]
    reasons = [*open_lines, *reasons] if measured in _PASSING else [*reasons, *open_lines]
    not_proven = tuple(one.line for one in unproven_motion(record))
    reasons = [*not_proven, *reasons] if measured in _PASSING else [*reasons, *not_proven]
    waiver_faults = tuple(coded_of(fault, UNUSED_WAIVER) for fault in judgement.faults)
    reasons += waiver_faults
    profiles = [coded_of(profile_text(one), PROFILE) for one in record.profiles if not one.passed]
    broken = [f"{one.kind}: {one.line}" for one in notices if one.severity is Severity.VIOLATED]
    beside = [*profiles, *broken]
    passes = record.status_of(worst) in _PASSING
    reasons = [*beside, *reasons] if passes else [*reasons, *beside]
    warned = open_warnings(record) if record.case.fail_on_warning else ()
    reasons += _in_doubt(suspects, warned, disputing)
    return Verdict(
        status=SUSPECT
        if suspects
        else _less_open(measured, [*of_tolerances, *not_proven], waiver_faults, warned),
        measured=measured,
        basis=record.basis,
        worst=worst,
        worst_sample=sample,
        reasons=tuple(reasons),
        unproven=unproven,
        suspects=suspects,
        warnings=tuple(_warnings(record)),
        warned=tuple(one.line for one in warned),
        disputed_by=None if disputing is None else disputing.peer,
        not_checked=tuple(not_checked(record.case)),
        self_clearance=self_clearance_lines(record),
        excused=tuple(left_out_lines(record)),
        unproven_motion=not_proven,
        broken=tuple(broken),
        beside=tuple(beside),
        nearest=_nearest(record, worst),
        clocks=_when(record.case),
        has_holes=bool(not_measured(record.case)),
        beyond="joints beyond their limits" if any(one.kind in BEYOND for one in notices) else "",
        waived=waived_lines(judgement),
        n_waivers=len(judgement.covering),
        waiver_faults=waiver_faults,
        tolerances=_tolerances(record.case, measured, of_tolerances),
        remaining=_remaining(of_tolerances),
        with_tolerances=tolerance_lines(record),
        at_level=at_level_line(judging),
        simulated=record.motion_kind == "simulated",
    )


def _in_doubt(
    suspects: Sequence[Notice], warned: Sequence[Notice], disputing: CrossCheck | None
) -> Iterator[str]:
    """Why a run fails whatever was measured, one line each."""
    yield from (f"suspect {one.kind}: {one.line}" for one in suspects)
    yield from (f"warning {one.kind}: {one.line}" for one in warned)
    if disputing is not None:
        n_steps = count(len(disputing.disagreements), "step")
        yield coded_of(f"{disputing.peer} disagrees at {n_steps}", DISPUTED)


def _less_open(measured: str, *open_things: Sequence[object]) -> str:
    """The status, where no input is suspect: limits that are open, then waivers, then warnings, decide."""
    if measured not in _PASSING:
        return measured
    found = zip((NOT_PROVEN, UNUSED_WAIVER, WARNING), open_things, strict=True)
    return next((status for status, things in found if things), measured)


def _tolerances(case: Case, measured: str, open_limits: Sequence[Finding]) -> str:
    """What tolerances make of what passes without them; empty where there are none."""
    if case.tolerance is None or measured not in _PASSING:
        return ""
    if not open_limits:
        return KEPT
    return ACCEPTED if case.tolerance.unproven_ok else NOT_PROVEN


def _measured(record: Record, judgement: Judgement) -> str:
    """The worst that any step, the motion between, a profile or a rule of the case says, less what is waived."""
    worst = STATUSES.index(Status(judgement.status))
    broken = any(notice.severity is Severity.VIOLATED for notice in record.notices)
    if broken or not all(answer.passed for answer in record.profiles):
        worst = max(worst, STATUSES.index(Status.VIOLATED))
    return str(STATUSES[worst])


def _most_critical(record: Record, judgement: Judgement) -> tuple[Moment, Moment, bool]:
    """The moment and the step that decide, and whether they are below a limit; of all where nothing but what is
    waived is."""
    judged = judgement.worst
    if judged is None or record.status_of(judged) == Status.CLEAR:
        return record.worst, record.worst_sample, False
    return judged, judgement.worst_sample or record.worst_sample, True


def _same(one: Moment, other: Moment) -> bool:
    fields = ("time", "link", "obstacle", "rule")
    return all(getattr(one, name) == getattr(other, name) for name in fields)


def _nearest(record: Record, worst: Moment) -> str | None:
    """The moment of least clearance, where another is more critical."""
    nearest = record.nearest
    return None if nearest is worst or _same(nearest, worst) else moment_line(record, nearest)


def _warnings(record: Record) -> list[str]:
    """Warnings, then those and suspect input that are accepted; each once."""
    lines = [one.line for one in open_warnings(record)]
    lines += [
        f"{one.line} (accepted: {entry})"
        for one in record.notices
        if one.severity in (Severity.SUSPECT, Severity.WARNING)
        and (entry := one.accepted_by(record.case.accept))
    ]
    return list(dict.fromkeys(lines))
