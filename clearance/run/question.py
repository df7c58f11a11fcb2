"""What is asked of a case, checked once; and what a run may use, which decides nothing about the answer.

Not for: answering (`answers`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from clearance.errors import BadInput
from clearance.simulate.measure import NEEDS, Progress
from clearance.simulate.resumable_rows import IN_MEMORY, MeasuredRows
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case, Limits
from clearance.world.plausibility import notices_of

MOTIONS = ("kinematic", "simulated")
METHODS = ("exact", "paper")
CONTACT = ("none", "events", "every")


@dataclass(frozen=True, eq=False)
class Question:
    """A case and what is asked of it; one that exists can be answered.

    Attributes:
        case: with the limits that hold, and all that is suspect about it.
        need, method, motion, certify_gap, cross_check, contact, paper_tolerance: as in `check`.
        certify: whether the motion between the steps is proven; never with method "paper", which proves nothing.

    Raises:
        BadInput: an option that is unknown, or some that do not go together.
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

    def __post_init__(self) -> None:
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
        if self.need != "steps" and self.method != "exact":
            raise BadInput(
                f"method {self.method!r} measures every step",
                valid="need 'steps', or method 'exact'",
            )
        if self.need in ("limit", "minimum") and self.cross_check:
            raise BadInput(
                f"cross-check needs every step, not {self.need!r}", valid="need 'steps' or 'pairs'"
            )
        object.__setattr__(self, "certify", self.certify and self.method == "exact")
        object.__setattr__(self, "case", replace(self.case, notices=notices_of(self.case)))

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


@dataclass(frozen=True, eq=False)
class Means:
    """What a run may use.

    Attributes:
        jobs: threads; as many as the machine has to offer if None.
        progress: called with steps done and all steps.
        rows: where they are kept.

    Raises:
        BadInput: fewer than one thread.
    """

    jobs: int | None = None
    progress: Progress | None = None
    rows: MeasuredRows = IN_MEMORY

    def __post_init__(self) -> None:
        if self.jobs is not None and (not isinstance(self.jobs, int) or self.jobs < 1):
            raise BadInput(f"{self.jobs} jobs", valid="1 or more")


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


def _require_tolerance(tolerance: float | None, method: str) -> None:
    if tolerance is None:
        return
    if method != "paper":
        raise BadInput(f"method {method!r} has no tolerance", valid="only method 'paper' has one")
    from clearance.query.paper import checked_tolerance

    checked_tolerance(tolerance)
