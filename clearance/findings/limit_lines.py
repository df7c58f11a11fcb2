"""How a clearance stands against its limits, in words: below one, equal to it, or not proven to keep it.

Not for: findings (`finding_text`), nor what a run comes to (`verdict`).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence

import numpy as np

from clearance.codes import coded_of
from clearance.findings.finding import UNPROVEN
from clearance.findings.of_rule import why_undecided
from clearance.record.certificate import contact_is_open
from clearance.record.moment import Moment
from clearance.record.record import ProfileAnswer, Record
from clearance.record.rule_answer import RuleAnswer
from clearance.record.wording import (
    at_least_mm,
    depth_text,
    gap_text,
    judged_by,
    limit_mm,
    limits_text,
    moment_text,
    of_rule,
    padded_mm,
    span_text,
    swept_text,
)
from clearance.tolerance import SEEN_AT_LEVEL


def moment_line(record: Record, moment: Moment) -> str:
    """How near what comes to what and when, and the limit that it is below, if it is: with its rule."""
    limits = record.rule(moment.rule).limits
    if moment.touches:
        return f"contact{' ' if moment.depth else ', '}{contact_line(record, moment)}"
    where = f"{moment.link} - {moment.obstacle} at {moment_text(record, moment)}"
    for name, limit in (("fail", limits.fail), ("warn", limits.warn)):
        if limits.below(moment.clearance, limit):
            below = f"below the {name} limit of {limit_mm(limit)} mm{of_rule(moment.rule)}"
            return f"{padded_mm(moment, (limit,))}, {below}: {where}"
    kept = f" ({limits_text(limits.fail, limits.warn)})" if record.case.limits.rules else ""
    return f"{padded_mm(moment)}{judged_by(moment.rule)}{kept}: {where}"


def contact_line(record: Record, moment: Moment) -> str:
    """The depth of a contact, the two bodies and the moment, and the rule that judges them, if there is one."""
    where = f"{moment.link} - {moment.obstacle} at {moment_text(record, moment)}"
    return f"{depth_text(moment.depth)}{judged_by(moment.rule)}: {where}"


def unproven_line(record: Record, judging: Sequence[RuleAnswer]) -> str | None:
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
    line = (
        f"not proven to stay {above}{of_rule(rule.name)}: {at_least_mm(least)}, {when}; "
        f"{why_undecided(record.case)}"
    )
    return coded_of(line, UNPROVEN)


def at_level_line(judging: Sequence[RuleAnswer]) -> str:
    """A line that the least clearance of a rule equals its limit but for rounding; empty if none does."""
    for rule, name in itertools.product(judging, ("fail", "warn")):
        level, worst, limits = getattr(rule.limits, name), rule.worst, rule.limits
        if worst is None or worst.touches:
            continue
        distance = float(np.linalg.norm(np.subtract(worst.point_link, worst.point_obstacle)))
        if distance <= SEEN_AT_LEVEL * limits.rounding and not _contact_is_open(rule):
            return f"touches but for rounding ({max(distance, worst.clearance):.2g} m apart)"
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
    what = "distance" if answer.mode == "nearest" else "gap"
    swept = swept_text(answer.plane, answer.section, answer.links)
    text = (
        f"{answer.name} ({answer.mode}, {swept}): {answer.kept_text}, {what} {gap_text(answer.gap)} mm, "
        f"limit {answer.limit * 1000:g} mm, {answer.link}, step {answer.step}"
    )
    return "; ".join((text, *answer.left_out))
