"""What is asked of a case, checked once.

Not for: answering (`answers`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from datetime import UTC, date, datetime

import numpy as np

from clearance.errors import BadDimension, BadInput
from clearance.simulate.measure.measure import NEEDS
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.plausibility import notices_of

MOTIONS = ("kinematic", "simulated", "recorded")
METHODS = ("exact", "paper")
CONTACT = ("none", "events", "every")


@dataclass(frozen=True, eq=False)
class Question:
    """A case and what is asked of it; one that exists can be answered.

    Attributes:
        case: with the limits that hold, and all that is suspect about it.
        need: "steps" for the clearance of every step; "pairs" for that of every pair at every step as well;
            "limit" for the steps below the warn limit, with a proven lower bound for the others;
            "minimum" for the least of all steps. The worst step is exact in each.
        method: "exact", or "paper" for the first paper's algorithm as published (no guarantee).
        motion: "kinematic" follows the trajectory exactly, "simulated" is what a physics engine's
            controlled robot makes of it, "recorded" what a robot really did, of a case with a recording.
        certify: also prove a lower bound for the motion between the steps, joints moving linearly or, where
            the trajectory has velocities, on cubics; the verdict then rests on it. Without it, and with method
            "paper", which proves nothing, the verdict is of the samples only, and says so.
        certify_gap: [m] how far that bound may be below a distance that occurs; no finer than rounding allows
            (`tolerance.FINEST_CERTIFY_GAP`), with a warning.
        cross_check: also ask FCL at every step.
        contact: of which overlaps depth, volume and way out are worked out, when they are first looked at: the
            deepest moment of each of the "events" (a pair in contact without a break), "every" one, or "none".
            No status depends on it; the worst moment of bodies in contact is the deepest that is worked out.
        body_gaps: tell which gaps between what moves and what stands are of a width that parts of a person may be
            caught in; no verdict depends on it.
        today: the day that the case's waivers are held against; that of the clock, in UTC, if not given; None
            where it has none.
        inside: tell of pairs of which it is open whether one body is inside the other; the verdict rests on that,
            so it is left out only where no verdict is read.
        paper_tolerance: [m] of the paper's rule 1, as `tolerance` of `distance`.

    Raises:
        BadInput: an option that is unknown, or some that do not go together. BadDimension: a gap that is no
            positive length.
    """

    case: Case
    need: str = "steps"
    method: str = "exact"
    motion: str = "kinematic"
    certify: bool = True
    certify_gap: float = CERTIFY_GAP
    cross_check: bool = False
    contact: str = "events"
    paper_tolerance: float | None = None
    today: date | None = None
    body_gaps: bool = False
    inside: bool = True

    def __post_init__(self) -> None:
        if not isinstance(self.case, Case):
            given = type(self.case).__name__
            raise BadInput(f"a {given} is given", valid="a Case, as load_case reads one")
        for what, valid in (
            ("method", METHODS),
            ("motion", MOTIONS),
            ("need", NEEDS),
            ("contact", CONTACT),
        ):
            if getattr(self, what) not in valid:
                given = getattr(self, what)
                raise BadInput(f"unknown {what} {given!r}", valid=f"one of {', '.join(valid)}")
        _require_tolerance(self.paper_tolerance, self.method)
        if self.body_gaps and self.need not in ("steps", "pairs"):
            raise BadInput(
                f"body gaps need the least of every pair, not {self.need!r}",
                valid="need 'steps' or 'pairs'",
            )
        object.__setattr__(self, "certify_gap", _checked_gap(self.certify_gap))
        if self.need != "steps" and self.method != "exact":
            raise BadInput(
                f"method {self.method!r} measures every step",
                valid="need 'steps', or method 'exact'",
            )
        if self.need in ("limit", "minimum") and self.cross_check:
            raise BadInput(
                f"cross-check needs every step, not {self.need!r}", valid="need 'steps' or 'pairs'"
            )
        _require_recording(self)
        _require_one_clock(self)
        _require_surfaces(self)
        object.__setattr__(self, "certify", self.certify and self.method == "exact")
        today = (self.today or datetime.now(UTC).date()) if self.case.waivers else None
        object.__setattr__(self, "today", today)
        case = self.case.telling()
        object.__setattr__(case, "notices", notices_of(case))
        object.__setattr__(self, "case", case)

    @property
    def of_rows(self) -> tuple[object, ...]:
        """What of it decides the rows that are measured and certified, beside the case."""
        return (
            self.need,
            self.method,
            self.motion,
            self.certify,
            self.certify_gap,
            self.paper_tolerance,
        )


def _require_recording(question: Question) -> None:
    """Nothing, if there is a recording where one is meant, and none else."""
    there = any(placed.recording is not None for placed in question.case.robots)
    if there != (question.motion == "recorded"):
        given = "has a recording" if there else "has no recording"
        raise BadInput(
            f"motion {question.motion!r} of a case that {given}", valid="both, or neither"
        )


def _require_surfaces(question: Question) -> None:
    """Nothing, if what is asked can be answered of clouds of points, where there are any."""
    clouds = [one.name for one in question.case.obstacles if one.body.is_cloud]
    if clouds and question.method == "paper":
        raise BadInput(
            f"method 'paper' measures faces, and obstacle {clouds[0]!r} is a cloud of points",
            valid="method 'exact'",
        )


def _require_one_clock(question: Question) -> None:
    """Nothing, if what is asked can be answered where clocks are not tied."""
    if question.case.clock.slack == 0.0:
        return
    for what, given in (("need", "pairs"), ("method", "paper")):
        if getattr(question, what) == given:
            raise BadInput(
                f"{what} {given!r} asks about one time, and the case's clocks are not tied",
                valid=f"another {what}, or clock: common",
            )


def limited(case: Case, limits: Limits | None) -> Case:
    """The case with these limits, or its own.

    Raises:
        BadInput: no limits.
    """
    if limits is None:
        return case
    if not isinstance(limits, Limits):
        raise BadInput(
            f"limits are {limits!r:.60}", valid="a Limits, as Limits(fail=0.005, warn=0.02)"
        )
    return replace(case, limits=limits)


def with_levels(limits: Limits, fail: float | None, warn: float | None) -> Limits:
    """The limits with other levels [m]; None leaves one as it is.

    Raising `fail` alone takes `warn` along, a rule's too that gives no `fail` of its own.

    Raises:
        BadInput: a warn limit below the fail limit.
    """
    if fail is None and warn is None:
        return limits
    if fail is None:
        fail = limits.fail
    if warn is None:
        warn = max(limits.warn, fail)
    if warn < fail:
        raise BadInput(
            f"the warn limit {warn * 1000:g} mm is below the fail limit {fail * 1000:g} mm"
        )
    rules = tuple(
        replace(rule, warn=max(rule.warn, fail))
        if rule.fail is None and rule.warn is not None
        else rule
        for rule in limits.rules
    )
    return replace(limits, fail=fail, warn=warn, rules=rules)


def _checked_gap(gap: float) -> float:
    if not (isinstance(gap, int | float | np.number) and 0.0 < gap < np.inf):
        raise BadDimension(f"a gap of {gap!r:.60} m", where="certify", valid="a length above 0")
    return float(gap)


def _require_tolerance(tolerance: float | None, method: str) -> None:
    if tolerance is None:
        return
    if method != "paper":
        raise BadInput(f"method {method!r} has no tolerance", valid="only method 'paper' has one")
    from clearance.query.paper import checked_tolerance

    checked_tolerance(tolerance)
