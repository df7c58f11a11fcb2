"""What of a case is measured and what is left out: link pairs of each robot by reason, links and pairs by name.

Not for: which pairs those are (`world.self_pairs`, `world.pairs`), nor each by name (`background.unmeasured`).
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from typing import Any

from clearance.record.names import pair_names
from clearance.record.record import CUT, Record
from clearance.record.wording import count
from clearance.world.collision_matrix import ADJACENT
from clearance.world.notice import listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.self_pairs import RIGID, SelfPair, self_pairs

NEIGHBOURS = "neighbours"


def self_clearance_of(record: Record) -> list[dict[str, Any]]:
    """For each robot with self-clearance: the numbers of link pairs, of those measured (always or at some time),
    and of those left out by reason; and one line with all of these."""
    return [
        _answer(record, i)
        for i, placed in enumerate(record.case.robots)
        if placed.self_clearance is not None
    ]


def left_out_lines(record: Record) -> Iterator[str]:
    """The links that the case excludes, and the pairs that it allows or lets touch a part in hand, beside those of
    two links of one robot."""
    case = record.case
    excluded = [case.prefix_of(one) + link for one in case.robots for link in one.exclude_links]
    if excluded:
        yield f"not measured: {count(len(excluded), 'excluded link')}: {listed(excluded)}"
    excuses = {str(row) for row in case.allow}
    excuses |= {carry.excuse(pattern) for carry in case.carries for pattern in carry.touch}
    links = {
        case.prefix_of(one) + link: one for one in case.robots for link in one.robot.link_names
    }
    allowed = {
        (one.link, one.obstacle): None
        for one in record.unmeasured
        if one.reason in excuses
        and (one.obstacle not in links or links[one.link] is not links[one.obstacle])
    }
    at_times = {*zip(*pair_names(case, record.pairs), strict=True)} & allowed.keys()
    for when, pairs in (("", allowed.keys() - at_times), (" at times", at_times)):
        if pairs:
            names = [" - ".join(pair) for pair in allowed if pair in pairs]
            yield f"not measured{when}: {count(len(names), 'allowed pair')}: {listed(names)}"


def self_clearance_lines(record: Record) -> tuple[str, ...]:
    """The line of each robot with self-clearance."""
    return tuple(answer["text"] for answer in self_clearance_of(record))


def _answer(record: Record, i_robot: int) -> dict[str, Any]:
    case, placed = record.case, record.case.robots[i_robot]
    asked = placed.self_clearance
    assert asked is not None
    measured, not_always = _measured(record, i_robot)
    pairs = self_pairs(placed.robot, asked.matrix, trust_never=asked.trust_never)
    left_out = Counter(
        _reason(placed, pair)
        for pair in pairs
        if frozenset((pair.link_a, pair.link_b)) not in measured
    )
    whose = "self-clearance" if len(case.robots) == 1 else f"self-clearance of {placed.robot.name}"
    answer = {
        "robot": placed.robot.name,
        "n_pairs": len(pairs),
        "n_measured": len(measured),
        "n_not_always": len(not_always),
        "left_out": dict(left_out),
    }
    return answer | {"text": f"{whose}: {_text(answer)}"}


def _measured(record: Record, i_robot: int) -> tuple[set[frozenset[str]], set[frozenset[str]]]:
    """The pairs of links of a robot that are measured at some time, and those of them that are not always."""
    case = record.case
    out = {(one.link, one.obstacle): one.reason for one in record.unmeasured}
    measured, not_always = set(), set()
    for pair in record.pairs:
        if pair.a.i_robot != i_robot or pair.b.i_robot != i_robot:
            continue
        why = out.get((pair.a.name_in(case), pair.b.name_in(case)))
        if why != CUT:
            own = frozenset((pair.a.own_name_in(case), pair.b.own_name_in(case)))
            measured.add(own)
            not_always |= {own} if why else set()
    return measured, not_always


def _reason(placed: PlacedRobot, pair: SelfPair) -> str:
    """Why a pair is not measured at any time, as it is counted."""
    asked = placed.self_clearance
    if {pair.link_a, pair.link_b} & {*placed.exclude_links}:
        return "of links that are excluded"
    if pair.excused is None:
        return "allowed"
    if pair.excused == RIGID:
        return RIGID
    if asked is not None and asked.matrix is not None:
        return f"by the SRDF ({pair.excused})"
    return NEIGHBOURS if pair.excused == ADJACENT else f"by {pair.excused}"


def _text(answer: dict[str, Any]) -> str:
    not_always = answer["n_not_always"]
    text = f"{answer['n_measured']} of {answer['n_pairs']} pairs measured"
    text += f" ({not_always} of them not always)" if not_always else ""
    for reason, n in sorted(answer["left_out"].items(), key=_place):
        text += f", {n} {'neighbour' if reason == NEIGHBOURS and n == 1 else reason}"
    return text


def _place(counted: tuple[str, int]) -> tuple[bool, int, str]:
    """Neighbours first, then the reasons for most pairs."""
    reason, n = counted
    return reason != NEIGHBOURS, -n, reason
