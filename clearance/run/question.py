"""What is asked of a case, checked once: the case with all that options change of it, and what is answered of it.

Not for: the options (`options`), and answering (`answers`).
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from datetime import UTC, datetime
from typing import TYPE_CHECKING

from clearance.errors import BadInput, Contradiction
from clearance.extras import require
from clearance.options import Spelling, in_python, spelling
from clearance.run.options import CheckOptions, QuestionOptions
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case
from clearance.world.plausibility import notices_of

if TYPE_CHECKING:
    from typing import Self


@dataclass(frozen=True, eq=False)
class Question(QuestionOptions):
    """A case and what is asked of it; one that exists can be answered.

    Attributes:
        case: with the limits that hold, and all that is suspect about it.
        inside: tell of pairs of which it is open whether one body is inside the other; the verdict rests on that,
            so it is left out only where no verdict is read.

    The other options are those of `QuestionOptions`, by name.

    Raises:
        BadInput: an option that is unknown, or some that do not go together. BadDimension: a gap that is no
            positive length.
    """

    case: Case
    inside: bool = field(default=True, kw_only=True)

    def __post_init__(self) -> None:
        super().__post_init__()
        if not isinstance(self.case, Case):
            given = type(self.case).__name__
            raise BadInput(f"a {given} is given", valid="a Case, as load_case reads one")
        _require_recording(self)
        _require_one_clock(self)
        _require_surfaces(self)
        if self.method != "exact":  # which proves nothing
            object.__setattr__(self, "certify", False)
            object.__setattr__(self, "certify_gap", CERTIFY_GAP)
        today = (self.today or datetime.now(UTC).date()) if self.case.waivers else None
        object.__setattr__(self, "today", today)
        case = replace(self.case, notices=notices_of(self.case))
        object.__setattr__(self, "case", case)

    @classmethod
    def of(cls, case: Case, options: CheckOptions, spelled: Spelling = in_python) -> Self:
        """The question that options ask about a case.

        Args:
            spelled: how errors name an option.

        Raises:
            BadInput: as `CheckOptions.apply`, or what cannot be answered of this case. Unavailable: a library that
                this needs is missing.
        """
        for name, value, extra in NEED_EXTRAS:
            if getattr(options, name) == value:
                require(extra, spelled(name, value))
        if case.profiles:
            require("profiles", "a case with profiles")
        asked = {one.name: getattr(options, one.name) for one in fields(QuestionOptions)}
        with spelling(CheckOptions, spelled):
            return cls(options.apply(case), **asked)

    @property
    def of_rows(self) -> tuple[object, ...]:
        """What of it decides the rows that are measured and certified, beside the case."""
        names = (one.name for one in fields(QuestionOptions) if one.name not in BESIDE_ROWS)
        return tuple(getattr(self, name) for name in names)


BESIDE_ROWS = ("contact", "body_gaps", "cross_check", "today")
"""Options that no row depends on: what an interrupted run has measured is of use whatever they are."""

NEED_EXTRAS = (("cross_check", True, "crosscheck"), ("motion", "simulated", "simulate"))
"""Options that need optional libraries, with the value that does, and the extra that brings them."""


def _require_recording(question: Question) -> None:
    """Nothing, if there is a recording where one is meant, and none else."""
    there = any(placed.recording is not None for placed in question.case.robots)
    if there != (question.motion == "recorded"):
        given = "has a recording" if there else "has no recording"
        raise Contradiction(
            f"motion {question.motion!r} of a case that {given}", valid="both, or neither"
        )


def _require_surfaces(question: Question) -> None:
    """Nothing, if what is asked can be answered of clouds of points, where there are any."""
    clouds = [one.name for one in question.case.obstacles if one.body.is_cloud]
    if clouds and question.method == "paper":
        raise Contradiction(
            f"method 'paper' measures faces, and obstacle {clouds[0]!r} is a cloud of points",
            valid="method 'exact'",
        )


def _require_one_clock(question: Question) -> None:
    """Nothing, if what is asked can be answered where clocks are not tied."""
    if question.case.clock.slack == 0.0:
        return
    for what, given in (("need", "pairs"), ("method", "paper")):
        if getattr(question, what) == given:
            raise Contradiction(
                f"{what} {given!r} asks about one time, and the case's clocks are not tied",
                valid=f"another {what}, or clock: common",
            )
