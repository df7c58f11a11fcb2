"""How a rule stands over all of a run: at its steps, and what is proven between. Not for: its findings."""

from __future__ import annotations

from clearance.record.certificate import motion_codes
from clearance.record.rule_answer import RuleAnswer
from clearance.record.status import STATUSES, Status
from clearance.world.case import Case


def code_of(answer: RuleAnswer) -> int:
    """The index into `STATUSES` of the worst of a rule, at a step or, as far as proven, between two."""
    codes = [STATUSES.index(Status(answer.status))]
    if answer.certificate is not None:
        codes.append(int(motion_codes(answer.certificate, answer.limits, slice(None)).max()))
    return max(codes)


def why_undecided(case: Case) -> str:
    """Why a level is neither proven nor seen to be passed, and what helps."""
    if case.clock.slack > 0.0:
        return "a finer proof takes a smaller --certify-mm"
    return "undecided: the motion stays too close to the limit for the searches allowed"
