"""The one verdict of a run: exit code, page, terminal, JUnit, JSON and `Run.passed` are all taken from it.

Not for: measuring, and the words around it (`wording`, `cli.verdict`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

from clearance.report.wording import count, gap_text, limit_mm, mm, moment_text, span_text
from clearance.simulate.record import ProfileAnswer, Record
from clearance.simulate.replay_frames import codes_of
from clearance.simulate.status import STATUSES, Status
from clearance.world.case import Case
from clearance.world.notice import Notice, Severity

SUSPECT = "suspect"
"""The status where the input is in doubt, whatever was measured."""

MOTION, SAMPLES = "motion", "samples"
"""What a verdict rests on: a proof for the continuous motion, or the samples of the trajectory only."""

SELF_COLLISION = "self-collision"
"""What is not measured unless the case asks for it."""

_PASSING = (Status.CLEAR, Status.NEAR)


@dataclass(frozen=True)
class Verdict:
    """What a run comes to.

    Attributes:
        status: "clear", "near", "violated", "contact", or "suspect" where input is in doubt and not accepted.
        measured: the status by what was measured alone.
        basis: "motion" or "samples".
        reasons: why it is not clear, one line each.
        unproven: the one of them that says that a limit could not be proven though nothing below it occurs.
        suspects: the notices that make it suspect.
        warnings: what a reader must know beside the clearance; suspect input that is accepted is among it.
        disputed_by: the peer that disagrees, if one does.
        not_checked: what was not looked at.
        broken: rules of the case that are broken, beside its limits of clearance.
    """

    status: str
    measured: str
    basis: str
    reasons: tuple[str, ...] = ()
    unproven: str | None = None
    suspects: tuple[Notice, ...] = ()
    warnings: tuple[str, ...] = ()
    disputed_by: str | None = None
    not_checked: tuple[str, ...] = ()
    broken: tuple[str, ...] = ()

    @property
    def exit_code(self) -> int:
        """0 clear or near, 1 violated or contact, 2 suspect, 3 a peer disagrees; the greatest that holds."""
        if self.disputed_by is not None:
            return 3
        if self.status == SUSPECT:
            return 2
        return 0 if self.measured in _PASSING else 1

    @property
    def passed(self) -> bool:
        """True if nothing speaks against it: the exit code is 0."""
        return self.exit_code == 0

    def text(self, shown: Callable[[str], str] = str) -> str:
        """The verdict in a few words, the status written as `shown` says."""
        return verdict_text(self.status, self.measured, self.basis, self.disputed_by, shown)


def verdict_text(
    status: str,
    measured: str,
    basis: str,
    disputed_by: str | None,
    shown: Callable[[str], str] = str,
) -> str:
    """A verdict in a few words; the arguments are as in `Verdict`."""
    text = shown(measured)
    if basis == SAMPLES:
        text += " at the samples only" if measured in _PASSING else ", looked at the samples only"
    if status == SUSPECT:
        text = f"{shown(SUSPECT)} (would be {text})"
    return text if disputed_by is None else f"{text}, but {disputed_by} disagrees"


def verdict_of(record: Record) -> Verdict:
    """The verdict of a record."""
    notices = record.notices
    suspects = [notice for notice in notices if notice.severity is Severity.SUSPECT]
    open_suspects = tuple(one for one in suspects if one.kind not in record.case.accept)
    measured = _measured(record)
    check = record.cross_check
    disputing = None if check is None or check.agrees else check
    unproven = _unproven(record)
    reasons = [reason for reason in (_occurring(record), unproven) if reason is not None]
    reasons += [profile_text(answer) for answer in record.profiles if not answer.passed]
    broken = [f"{one.kind}: {one.text}" for one in notices if one.severity is Severity.VIOLATED]
    reasons += broken
    reasons += [f"suspect {one.kind}: {one.text}" for one in open_suspects]
    if disputing is not None:
        n_steps = count(len(disputing.disagreements), "step")
        reasons.append(f"{disputing.peer} disagrees at {n_steps}")
    return Verdict(
        status=SUSPECT if open_suspects else measured,
        measured=measured,
        basis=SAMPLES if record.certificate is None else MOTION,
        reasons=tuple(reasons),
        unproven=unproven,
        suspects=open_suspects,
        warnings=tuple(_warnings(record, notices)),
        disputed_by=None if disputing is None else disputing.peer,
        not_checked=tuple(_not_checked(record.case)),
        broken=tuple(broken),
    )


def _not_checked(case: Case) -> Iterator[str]:
    """The robots whose links are not measured against one another."""
    left_out = [placed.robot.name for placed in case.robots if not placed.self_clearance]
    if len(left_out) == len(case.robots):
        yield SELF_COLLISION
    else:
        yield from (f"{SELF_COLLISION} of {name}" for name in left_out)


def _measured(record: Record) -> str:
    """The worst that any step, the motion between, a profile or a rule of the case says."""
    worst = int(codes_of(record.steps).max())
    broken = any(notice.severity is Severity.VIOLATED for notice in record.notices)
    if broken or not all(answer.passed for answer in record.profiles):
        worst = max(worst, STATUSES.index(Status.VIOLATED))
    return str(STATUSES[worst])


def _occurring(record: Record) -> str | None:
    """The moment of least clearance, if it is below a limit."""
    worst = record.worst
    limits = record.rule(worst.rule).limits
    where = f"{worst.link} - {worst.obstacle} at {moment_text(worst)}"
    if worst.touches:
        return f"contact: {where}"
    for name, limit in (("fail", limits.fail), ("warn", limits.warn)):
        if worst.clearance < limit:
            return (
                f"{mm(worst.clearance)} mm, below the {name} limit of {limit_mm(limit)} mm: {where}"
            )
    return None


def _unproven(record: Record) -> str | None:
    """The limit that the proof does not reach though nothing that was seen is below it."""
    certificate, limits = record.certificate, record.case.limits
    if certificate is None:
        return None
    step = certificate.worst_interval
    least = float(certificate.lower_bound[step])
    times = record.motions[0].times[step : step + 2]
    for name, limit in (("fail", limits.fail), ("warn", limits.warn)):
        if least < limit <= record.worst.clearance:
            return (
                f"not proven to stay above the {name} limit of {limit_mm(limit)} mm: at least {mm(least)} mm, "
                f"{span_text(float(times[0]), float(times[-1]))}; a finer proof takes a smaller --certify-mm"
            )
    return None


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
    told = [one.text for one in notices if one.severity is Severity.WARNING]
    told += [
        f"{one.text} (accepted: {one.kind})"
        for one in notices
        if one.severity is Severity.SUSPECT and one.kind in record.case.accept
    ]
    return list(dict.fromkeys(told))
