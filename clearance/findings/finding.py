"""A finding: a rule that two bodies keep or break, and the name that it has in every run of its case.

Not for: finding them (`of_record`), nor the file they are kept in (`findings_file`).
"""

from __future__ import annotations

import hashlib
import json
from dataclasses import dataclass, replace
from typing import Any

from clearance.codes import codes
from clearance.record.moment import Depth
from clearance.record.status import Status
from clearance.world.made_moves import MadeMoves

CLEARANCE = "clearance"
"""Two bodies and the limits of a rule."""

UNPROVEN = "unproven"
"""A limit of a rule that nothing seen is below, and that is not proven of the motion between the steps."""

TOLERANCES = "tolerances"
"""A limit of a rule that is kept as measured, and that is not proven with the tolerances of the case."""

WAIVED_TOLERANCES = "tolerances of waived"
"""The level of a waiver that is kept as measured, and that is not proven with the tolerances of the case."""

OF_TOLERANCES = (TOLERANCES, WAIVED_TOLERANCES)

PROFILE = "profile"
"""An outline that what the robot sweeps must keep to."""

JOINT_LIMITS = "joint limits"
"""The joints of a robot and their limits, where the case fails by them."""

KINDS = (CLEARANCE, UNPROVEN, *OF_TOLERANCES, PROFILE, JOINT_LIMITS)

NOT_PROVEN = "not proven"
"""The status of a limit that is kept as measured, and that is not proven with the tolerances."""

ORDER = ("clear", "near", NOT_PROVEN, "violated", "contact")
"""All that a finding's status can be, the worst last."""

Point = tuple[float, float, float]


@dataclass(frozen=True)
class AppliedWaiver:
    """The waiver that a finding is waived by.

    Attributes:
        at_least: [m] the clearance that it must keep. proven: [m] what is proven of the bodies that it is of, over
            this finding; None at the samples only.
        until: the last day that it holds, as 2027-03-31; empty for ever.
    """

    at_least: float
    reason: str
    by: str
    until: str = ""
    proven: float | None = None


@dataclass(frozen=True)
class Finding:
    """One rule, kept or broken by two bodies over one stretch of the motion.

    Attributes:
        id: 16 hexadecimal digits of the sha256 of case, kind, rule, bodies and occurrence; nothing else enters it.
        kind: one of `KINDS`. rule: its name; of a profile that of the profile.
        body_a, body_b: names; of what no two bodies do they are empty, or the second is.
        occurrence: 0 for the first stretch along the motion in which the pair breaks the rule, then 1 and so on;
            a pair that keeps it has one finding, 0.
        status: one of `ORDER`; "not proven" of `OF_TOLERANCES` alone.
        clearance: [m] the least, less padding; of a profile its gap; None where nothing was measured.
        proven: [m] a lower bound for the motion over the stretch, of the pair if it is proven by itself, else of
            all pairs of the rule; None at the samples only. Of `OF_TOLERANCES` the least with all errors.
        fail, warn: [m] the limits; of `WAIVED_TOLERANCES` fail is the level of the waiver.
        time: [s] of the least. time_b: [s] when the second body is there, where its clock is another.
        step: of that moment, or before it if it is `between` two.
        start, end: [s] the stretch, proven from outside; of samples from its first step to its last.
            first_step, last_step: inside it.
        point_a, point_b: [m] witness points in the world. joints: [rad] or [m] by name, at that moment.
        penetration, penetration_at_least: [m] bounds of the depth of a contact where it is deepest of what was
            worked out; None where nothing was.
        move: of a program at that moment. moves: the first and the last of the stretch. Empty without a program.
        text: what else is to say, one line.
        waived: by what, if it is. accepted: not proven with the tolerances, which the case lets pass.
    """

    id: str
    kind: str
    rule: str
    body_a: str
    body_b: str
    occurrence: int
    status: str
    clearance: float | None
    proven: float | None
    fail: float
    warn: float
    time: float | None = None
    time_b: float | None = None
    step: int | None = None
    between: bool = False
    start: float | None = None
    end: float | None = None
    first_step: int | None = None
    last_step: int | None = None
    point_a: Point | None = None
    point_b: Point | None = None
    joints: dict[str, float] | None = None
    move: str = ""
    moves: str = ""
    text: str = ""
    waived: AppliedWaiver | None = None
    accepted: bool = False
    penetration: float | None = None
    penetration_at_least: float | None = None

    def with_moves(self, made: MadeMoves) -> Finding:
        """The same with the names of the moves that programs make then."""
        move = "" if self.time is None else made.at(self.time)
        stretch = "" if self.start is None or self.end is None else made.over(self.start, self.end)
        return replace(self, move=move, moves=stretch)

    @property
    def code(self) -> str:
        """The stable code of its kind; empty for a kind that a file has and this version does not."""
        return codes().get(self.kind, "")

    def holds_at(self, time: float) -> bool:
        """True if a time [s] is in its stretch."""
        return self.start is not None and self.end is not None and self.start <= time <= self.end

    @property
    def depth(self) -> Depth | None:
        """Of a contact, where it was worked out."""
        if self.penetration is None or self.penetration_at_least is None:
            return None
        exact = self.penetration == self.penetration_at_least
        return Depth(self.penetration, self.penetration_at_least, exact)

    @property
    def broken(self) -> bool:
        """True if the rule is broken, or not proven with the tolerances; waived, accepted or not."""
        return self.status in (NOT_PROVEN, Status.VIOLATED, Status.CONTACT)

    @property
    def fails(self) -> bool:
        """True if the rule is broken and nothing waives or accepts that."""
        return self.broken and self.waived is None and not self.accepted

    @property
    def standing(self) -> tuple[int, float, str]:
        """What findings are ordered by, the worst first: status, how far it is above the fail limit [m], id."""
        level = self.proven if self.kind in OF_TOLERANCES else self.clearance
        margin = 0.0 if level is None else level - self.fail
        return -ORDER.index(self.status), margin, self.id


@dataclass(frozen=True)
class FindingName:
    """What a finding's id is made of."""

    case: str
    kind: str
    rule: str
    bodies: tuple[str, ...]
    occurrence: int = 0

    @property
    def id(self) -> str:
        """16 hexadecimal digits, whatever the order of the bodies."""
        parts = [self.case, self.kind, self.rule, sorted(self.bodies), self.occurrence]
        return hashlib.sha256(json.dumps(parts).encode()).hexdigest()[:16]

    def finding(self, **known: Any) -> Finding:
        """The finding of this name, kept where nothing else is `known` of it."""
        a, b = (*self.bodies, "", "")[:2]
        kept = {"status": str(Status.CLEAR), "clearance": None, "proven": None}
        named = {"body_a": a, "body_b": b, **kept, **known}
        return Finding(self.id, self.kind, self.rule, occurrence=self.occurrence, **named)
