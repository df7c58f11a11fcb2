"""What an audit of an SRDF found, as lines, as JSON, and as an SRDF to use. Not for: finding it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict
from typing import Any
from xml.sax.saxutils import quoteattr

from clearance.record.audit import ExcusedPair, PairFinding, PairStatus, ProposedPair
from clearance.record.wording import at_least_mm, count, joint_value, mm
from clearance.world.collision_matrix import ADJACENT, NEVER
from clearance.world.joint_limits import ROUNDING
from clearance.world.mimics import followers, range_of
from clearance.world.notice import listed
from clearance.world.robot import Joint, Robot

SCHEMA = "urn:clearance:audit:1"
"""The name of the JSON Schema, which `clearance schema --results audit` prints."""


def narrowed(robot: Robot) -> list[str]:
    """Each joint that is checked over less than its own limits, since those of its followers hold it, as a line.

    Programs that do not obey limits of followers move it farther.
    """
    lines = []
    for joint in robot.moving_joints:
        low, high = range_of(robot, joint.name)
        if low > high or (low <= joint.lower + ROUNDING and high >= joint.upper - ROUNDING):
            continue
        of = [
            f"'{one.joint.name}'"
            for one in followers(robot)
            if one.master == joint.name != one.joint.name
        ]
        own = "any position" if joint.lower == -math.inf else _span(joint, joint.lower, joint.upper)
        held = f"'{joint.name}' from {_span(joint, low, high)} of {own}"
        lines.append(f"{held}, by the limits of {listed(of)}; other programs may move it farther")
    return lines


def _span(joint: Joint, low: float, high: float) -> str:
    return f"{joint_value(joint.kind, low + 0.0)} to {joint_value(joint.kind, high + 0.0)}"


def audit_summary(robot: Robot, pairs: Sequence[ExcusedPair]) -> dict[str, Any]:
    """The findings as JSON-ready values: lengths in metres, positions in radians or metres."""
    return {
        "$schema": SCHEMA,
        "never_refuted": sum(pair.refuted for pair in pairs),
        "never_unproven": sum(pair.unproven for pair in pairs),
        "adjacent_refuted": sum(pair.hides_contact for pair in pairs),
        "narrowed": narrowed(robot),
        "pairs": [
            {"reason": pair.reason, **asdict(pair.finding), "status": str(pair.finding.status)}
            for pair in pairs
        ],
    }


def audit_headline(pairs: Sequence[ExcusedPair]) -> str:
    """What became of those that are said never to meet, and which neighbours lie apart at home and meet."""
    hidden = sum(pair.hides_contact for pair in pairs)
    if not hidden:
        return _never_in_words(pairs)
    lie = "lies" if hidden == 1 else "lie"
    return (
        f"{_never_in_words(pairs)}; {hidden} excused as {ADJACENT} {lie} apart at home and can meet"
    )


def _never_in_words(pairs: Sequence[ExcusedPair]) -> str:
    never = [pair for pair in pairs if pair.reason == NEVER]
    if not never:
        return f"no pair is excused as {NEVER}; {count(len(pairs), 'excused pair')} checked"
    parts = [
        (sum(pair.refuted for pair in never), "can meet"),
        (sum(pair.unproven for pair in never), "undecided"),
        (sum(pair.finding.status is PairStatus.APART for pair in never), "proven separate"),
    ]
    counts = ", ".join(f"{n} {what}" for n, what in parts if n)
    return f"of {count(len(never), 'pair')} excused as {NEVER}: {counts}"


def audit_rows(robot: Robot, pairs: Sequence[ExcusedPair]) -> Iterator[tuple[str, str, str]]:
    """(pair, reason, finding) of each, what is refuted first, then what is undecided."""
    kinds = {joint.name: joint.kind for joint in robot.joints}
    for pair in sorted(pairs, key=_seriousness):
        found = pair.finding
        yield f"{found.link_a} - {found.link_b}", pair.reason, _finding_text(found, kinds)


def _seriousness(pair: ExcusedPair) -> int:
    order = [PairStatus.MEETS, PairStatus.UNDECIDED, PairStatus.APART]
    is_asked = pair.reason == NEVER or pair.hides_contact
    return order.index(pair.finding.status) + len(order) * (not is_asked)


def _finding_text(found: PairFinding, kinds: Mapping[str, str]) -> str:
    where = ", ".join(
        f"{name} {joint_value(kinds[name], value)}" for name, value in found.positions.items()
    )
    if found.status is PairStatus.APART:
        return f"proven separate: {at_least_mm(found.lower_bound)}; {mm(found.least)} mm occurs"
    at = f" at {where}" if where else ""
    if found.status is PairStatus.MEETS:
        return f"can meet{at}"
    return f"undecided: {found.why}; {mm(found.least)} mm{at}"


def proposed_srdf(robot: Robot, pairs: Sequence[ProposedPair], geometry: str = "collision") -> str:
    """An SRDF with a row for each pair that can be excused, and a comment on each that cannot and why.

    Rows of reason `Never` are proven, within the joint limits of the URDF; those of `Adjacent` are neighbours
    that are together at home, or proven as well.

    Args:
        geometry: which shapes of its links the robot has.
    """
    kinds = {joint.name: joint.kind for joint in robot.joints}
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', f"<robot name={quoteattr(robot.name)}>"]
    proven = "proven not to touch at any position within the joint limits"
    lines.append(f"  <!-- Never: {proven}; geometry: {geometry}. -->")
    lines.append("  <!-- Adjacent: joined by one moving joint; not checked. -->")
    lines += [f"  <!-- checked: {line.replace('--', '- -')} -->" for line in narrowed(robot)]
    for each in pairs:
        ends = f"link1={quoteattr(each.pair.link_a)} link2={quoteattr(each.pair.link_b)}"
        if each.reason is not None:
            lines.append(f'  <disable_collisions {ends} reason="{each.reason}"/>')
    for each in pairs:
        if each.reason is None and each.finding is not None:
            text = f"{each.pair.link_a} - {each.pair.link_b}: {_finding_text(each.finding, kinds)}"
            lines.append(f"  <!-- measured: {text.replace('--', '- -')} -->")
    return "\n".join([*lines, "</robot>", ""])


def proposal_headline(pairs: Sequence[ProposedPair]) -> str:
    """How many pairs are excused, why, and how many are left to measure."""
    n_never = sum(each.reason == NEVER for each in pairs)
    n_adjacent = sum(each.reason == ADJACENT for each in pairs)
    statuses = [each.finding.status for each in pairs if each.reason is None and each.finding]
    n_meet, n_open = statuses.count(PairStatus.MEETS), statuses.count(PairStatus.UNDECIDED)
    proven = f"{n_never} proven never to meet, {n_adjacent} adjacent"
    return f"{count(len(pairs), 'pair')}: {proven}; to be measured: {n_meet} can meet, {n_open} undecided"
