"""What is asked of every case of a batch. Not for: which cases there are (`manifest`)."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass, field, replace
from datetime import UTC, date, datetime
from pathlib import Path

from clearance.case.tolerance.tolerance_file import tolerance_digest, with_tolerance
from clearance.errors import BadInput
from clearance.run import Question
from clearance.run.question import with_levels
from clearance.tolerance import CERTIFY_GAP
from clearance.world.case import Case
from clearance.world.waiver import Waiver


@dataclass(frozen=True)
class CaseOptions:
    """What is asked of a case; its `repr` distinguishes it in keys.

    Attributes:
        need, certify, certify_gap: as in `run.Question`.
        fail, warn: [m] limits instead of the case's, as `with_levels` takes them.
        accept: kinds of suspect input that decide no verdict, beside the case's.
        tolerance: absolute path of a file with tolerances instead of the cases'; empty for theirs. tolerance_key:
            sha256 of what is in it; in the `repr` in place of it.
        waivers: beside those of each case, `shared` by many. waivers_key: sha256 of what they are on that day; in
            the `repr` in place of them.
        today: the day that waivers are held against, as 2027-03-31; it decides only cases that have some, so it is
            not in the `repr`. Empty for the day that it is.
    """

    need: str = "limit"
    certify: bool = True
    certify_gap: float = CERTIFY_GAP
    fail: float | None = None
    warn: float | None = None
    accept: tuple[str, ...] = ()
    waivers_key: str = ""
    tolerance_key: str = ""
    tolerance: str = field(default="", repr=False, compare=False)
    today: str = field(default="", repr=False)
    waivers: tuple[Waiver, ...] = field(default=(), repr=False, compare=False)

    def question(self, case: Case) -> Question:
        """The question about a case.

        Raises:
            BadInput: a warn limit below the fail limit; tolerances that are not of this case, or are others than
                the key is of.
        """
        case = self._with_tolerance(case)
        limits = with_levels(case.limits, self.fail, self.warn)
        accepted = tuple(dict.fromkeys([*case.accept, *self.accept]))
        if limits is not case.limits or accepted != case.accept or self.waivers:
            waivers = (*case.waivers, *self.waivers)
            case = replace(case, limits=limits, accept=accepted, waivers=waivers)
        return Question(
            case,
            need=self.need,
            certify=self.certify,
            certify_gap=self.certify_gap,
            today=self.day,
        )

    def _with_tolerance(self, case: Case) -> Case:
        if not self.tolerance:
            return case
        path = Path(self.tolerance)
        if tolerance_digest(path) != self.tolerance_key:
            raise BadInput("it was changed during the batch", where=path.name, valid="once more")
        return with_tolerance(case, path)

    @property
    def day(self) -> date | None:
        """That which waivers are held against; None for the day that it is."""
        return date.fromisoformat(self.today) if self.today else None

    def waived_by(self, waivers: tuple[Waiver, ...]) -> CaseOptions:
        """The same with waivers."""
        today = self.day or datetime.now(UTC).date()
        told = [(waiver, waiver.is_expired(today)) for waiver in waivers]
        key = hashlib.sha256(repr(told).encode()).hexdigest() if waivers else ""
        return replace(self, waivers=waivers, waivers_key=key)

    def of_report(self) -> CaseOptions:
        """The same for a full report, which shows every step."""
        return replace(self, need="steps")
