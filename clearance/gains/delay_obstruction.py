"""Pairs that no change of a robot's time parts, and of which delays a moment of a run still tells.

Not for: delays that are enough (`delay`).
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.gains.obstruction import AT_REST, NOT_MOVED, ON_ITS_WAY, Obstruction, pair_at
from clearance.gains.shortfalls import SAME, State
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import Thing, owners_of
from clearance.simulate.answers.transfers import Transfers
from clearance.world.case import Case
from clearance.world.pairs import names_of
from clearance.world.rules import PairPattern
from clearance.world.timing import Timing


def stays_whatever(state: State, i_robot: int) -> Obstruction | None:
    """The worst pair that falls short, and does with every later start and every slower path; None without one."""
    transfers = Transfers(state.case, (False, i_robot))
    found = [
        pair_at(state, approach, row, why)
        for approach in state.near
        if not transfers.has(approach)
        for row, why in _staying(state, approach, i_robot)
    ]
    return min(found, key=lambda one: one.clearance - one.wanted, default=None)


def is_at_any_delay(case: Case, i_robot: int, times: np.ndarray) -> np.ndarray:
    """(n,) True for moments [s of the run] that are in the run whatever the delay of a robot, which is there then.

    A run begins with the first path that does not loop; of robots that are not in the cell before their path no
    moment tells.
    """
    begin = min(
        (
            _begins(case, thing)
            for thing in _moving(case)
            if thing != (False, i_robot) and _timing(case, thing).after != "loop"
        ),
        default=np.inf,
    )
    return (case.robots[i_robot].timing.after != "absent") & (times >= begin)


def _staying(state: State, approach: Approach, i_robot: int) -> Iterator[tuple[int, str]]:
    """The worst row of each reason for which a pair stays as near, and the reason."""
    case, at = state.case, approach.times
    missing = state.missing(approach)
    is_always = is_at_any_delay(case, i_robot, at)
    movers = _movers(case, approach)
    own: Thing = (False, i_robot)
    all_hold = all(_timing(case, one).after == "hold" for one in movers)
    reasons = (
        (NOT_MOVED, is_always & (own not in movers)),
        (ON_ITS_WAY, np.full(len(at), movers == {own} and _is_timeless(case, approach))),
        (AT_REST, is_always & (own in movers) & (at <= _begins(case, own) + SAME)),
        (
            AT_REST,
            (at >= state.record.timeline.times[-1] - SAME)
            & all_hold
            & _is_timeless(case, approach),
        ),
    )
    for why, stays in reasons:
        rows = np.flatnonzero(stays & (missing > 0.0))
        if len(rows):
            yield int(rows[np.argmax(missing[rows])]), why
            return


def _movers(case: Case, approach: Approach) -> set[Thing]:
    """What moves either body of a pair, where it follows a path of its own."""
    under = {one for body in approach.pair for one in owners_of(approach.case, body)}
    return under & {*_moving(case)}


def _moving(case: Case) -> Iterator[Thing]:
    """All that follows a path of its own."""
    for i, placed in enumerate(case.robots):
        if placed.trajectory is not None:
            yield False, i
    for i, obstacle in enumerate(case.obstacles):
        if obstacle.moves is not None:
            yield True, i


def _timing(case: Case, thing: Thing) -> Timing:
    is_obstacle, i = thing
    if not is_obstacle:
        return case.robots[i].timing
    moves = case.obstacles[i].moves
    assert moves is not None
    return moves.timing


def _begins(case: Case, thing: Thing) -> float:
    """[s of the run] When a path begins."""
    is_obstacle, i = thing
    moves = case.obstacles[i].moves if is_obstacle else case.robots[i].given_trajectory
    assert moves is not None
    return float(_timing(case, thing).run_times(moves.times)[0])


def _is_timeless(case: Case, approach: Approach) -> bool:
    """True if no rule of a pair, and no leave to touch, is of a stretch of time, and neither body is carried."""
    plain = approach.case
    names = [names_of(plain, body) for body in approach.pair]
    patterns: list[PairPattern] = [*case.allow, *case.limits.rules]
    if any(one.when and one.matches(*names) for one in patterns):
        return False
    parts = {one.part for one in case.carries}
    under = {thing for body in approach.pair for thing in owners_of(plain, body)}
    return not any(is_obstacle and case.obstacles[i].name in parts for is_obstacle, i in under)
