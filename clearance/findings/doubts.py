"""What stands beside the findings of a run and bears on its answer: suspect input, what was not checked, warnings.

Kept in `findings.json`, so that a comparison knows of a run that is in doubt and has no finding for it. Not for:
the verdict that is drawn from it (`verdict`).
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from clearance.codes import codes
from clearance.world.notice import Notice, Severity

if TYPE_CHECKING:
    from clearance.findings.judgement import Judgement
    from clearance.record.record import Record
    from clearance.world.case import Case

SUSPECT, DISPUTED, UNUSED_WAIVER = "suspect", "disputed", "unused waiver"
UNPROVEN_MOTION = "unproven motion"
NOT_CHECKED, WARNING, ACCEPTED, NOTE = "not checked", "warning", "accepted", "note"

FAILING = (SUSPECT, DISPUTED, UNUSED_WAIVER, UNPROVEN_MOTION)
"""Those by which a run is not passed, whatever was measured."""

KINDS = (*FAILING, NOT_CHECKED, WARNING, ACCEPTED, NOTE)

SURROUNDINGS = "surroundings (the scene is empty)"

SELF_COLLISION = "self-collision"
"""What is not measured unless the case asks for it."""

OWN_FLOOR = "floor and walls of the robot's own file"
"""What is not measured either then, where there are some."""

_VARIES = re.compile(
    r"""[^\s'",;:()]*\w\.[A-Za-z]\w*|\blines? \d+|-?\d+(\.\d+)?(e-?\d+)?(?= ?(s|ms|m|mm|rad|deg|°|%|times)\b)"""
)
"""Parts of a doubt's text that change with the input, and leave the doubt the same."""


@dataclass(frozen=True)
class Doubt:
    """One thing that a reader must know beside the findings.

    Attributes:
        kind: one of `KINDS`. about: of suspect and accepted input its kind ("units", …), of a warning its subject.
        text: one line.
    """

    kind: str
    about: str
    text: str

    @property
    def code(self) -> str:
        """The stable code of its kind; empty for a kind that a file has and this version does not."""
        of = self.about if self.kind in (SUSPECT, WARNING, ACCEPTED) else self.kind
        return not_checked_code(self.text) if of == NOT_CHECKED else codes().get(of, "")

    @property
    def fails(self) -> bool:
        """True if the run is not passed by it."""
        return self.kind in FAILING

    def is_like(self, other: Doubt) -> bool:
        """True if both say the same but for names of files, line numbers and figures with a unit."""
        same = (self.kind, self.about) == (other.kind, other.about)
        return same and _VARIES.sub("", self.text) == _VARIES.sub("", other.text)


def doubts_of(record: Record, judgement: Judgement) -> tuple[Doubt, ...]:
    """All of a record, those that fail it first; each once."""
    found = [*_of_input(record), *_of_answer(record, judgement)]
    return tuple(sorted(dict.fromkeys(found), key=lambda one: KINDS.index(one.kind)))


def open_suspects(record: Record) -> tuple[Notice, ...]:
    """The notices of suspect input that the case does not accept."""
    suspects = (one for one in record.notices if one.severity is Severity.SUSPECT)
    return tuple(one for one in suspects if not one.accepted_by(record.case.accept))


def open_warnings(record: Record) -> tuple[Notice, ...]:
    """The notices that are warnings and that the case does not accept, with motion of which no proof is asked."""
    severities = {Severity.WARNING} | ({Severity.UNPROVEN} if record.certificate is None else set())
    found = (one for one in record.notices if one.severity in severities)
    return tuple(one for one in found if not one.accepted_by(record.case.accept))


def unproven_motion(record: Record) -> tuple[Notice, ...]:
    """The notices of motion that is not proven, where a proof is asked for."""
    if record.certificate is None:
        return ()
    return tuple(one for one in record.notices if one.severity is Severity.UNPROVEN)


def not_checked_code(name: str) -> str:
    """The stable code of what is not checked, whichever robot it is of."""
    return codes().get(re.split(r" of | \(", name)[0], "")


def not_checked(case: Case) -> Iterator[str]:
    """That nothing stands around the robots, and those whose links are not measured against one another."""
    if not case.obstacles:
        yield SURROUNDINGS
    left_out = [placed.robot.name for placed in case.robots if not placed.self_clearance]
    if len(left_out) == len(case.robots):
        yield SELF_COLLISION
    else:
        yield from (f"{SELF_COLLISION} of {name}" for name in left_out)
    for placed in case.robots:
        if placed.robot.brings_surroundings and not placed.self_clearance:
            yield OWN_FLOOR if len(case.robots) == 1 else f"{OWN_FLOOR} ({placed.robot.name})"


def _of_input(record: Record) -> Iterator[Doubt]:
    for notice in record.notices:
        if notice in unproven_motion(record):
            yield Doubt(UNPROVEN_MOTION, notice.about, notice.text)
        elif notice.severity is not Severity.VIOLATED:
            kind = SUSPECT if notice.severity is Severity.SUSPECT else WARNING
            kind = ACCEPTED if notice.accepted_by(record.case.accept) else kind
            yield Doubt(kind, notice.kind, notice.text)
    robots = (note for placed in record.case.robots for note in placed.robot.notes)
    yield from _notes([*record.case.notes, *robots, *record.notes])


def _notes(texts: Iterable[str]) -> Iterator[Doubt]:
    return (Doubt(NOTE, "", text) for text in texts)


def _of_answer(record: Record, judgement: Judgement) -> Iterator[Doubt]:
    yield from (Doubt(NOT_CHECKED, "", text) for text in not_checked(record.case))
    check = record.cross_check
    if check is not None and not check.agrees:
        n_steps = len({row.step for row in check.disagreements})
        yield Doubt(
            DISPUTED, check.peer, f"{check.peer} disagrees at {n_steps} of {check.n_steps} steps"
        )
    for fault in judgement.faults:
        yield Doubt(UNUSED_WAIVER, "", fault)
