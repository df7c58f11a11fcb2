"""What the best that a search reached is up against: other pairs, and limits of joints.

Not for: what is plain before any search (`obstruction`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from clearance.gains.joint_ranges import joint_ranges
from clearance.gains.obstruction import Obstruction
from clearance.gains.programme import Box
from clearance.gains.shortfalls import State
from clearance.gains.tool_poses import ToolMove
from clearance.world.placed_robot import PlacedRobot

CLOSE = 1e-5
"""[m], [rad] or that a second: a pair or a joint that is no farther from what it must keep is up against it."""

MOST = 4
"""Lines of each sort."""


def bound_by(
    state: State, blocked: Obstruction, changed: Sequence[PlacedRobot] = ()
) -> tuple[str, ...]:
    """Pairs beside the blocked one that want all that they have, and joints at a limit at that moment.

    Args:
        changed: the robots whose paths are changed, as they were reached.
    """
    joints = [line for placed in changed for line in _joints(placed, blocked.time)]
    return (*_pairs(state, blocked)[:MOST], *joints[:MOST])


def joints_at_limits(placed: PlacedRobot) -> tuple[str, ...]:
    """The joints of a path that are at a limit at any moment, with the one at which they are most so."""
    lines = []
    for one in joint_ranges(placed):
        worst = int(one.headroom.argmin())
        if one.headroom[worst] < CLOSE:
            time = placed.timing.start + one.times[worst] / placed.timing.rate
            lines.append(f"joint {one.joint} is at its {one.what} at {time:.3f} s")
    return tuple(lines[:MOST])


def ends_reached(x: np.ndarray, box: Box) -> tuple[str, ...]:
    """The variables of a shift that are at an end of what they may be."""
    names = [*(f"the shift along {axis}" for axis in "xyz"), "the turn"]
    return tuple(
        f"{name} is as far as it may go"
        for name, value, low, high in zip(names, x, *box, strict=False)
        if low < high and (value > high - CLOSE or value < low + CLOSE)
    )


def tools_at_limits(moves: Iterable[ToolMove]) -> tuple[str, ...]:
    """The moments at which a tool has moved or turned as far as it may."""
    return tuple(
        f"tool {one.link} has no more to give at {one.keep.time:.3f} s"
        for one in moves
        if one.far > one.keep.far - CLOSE or one.turn > one.keep.turn - CLOSE
    )


def _pairs(state: State, blocked: Obstruction) -> list[str]:
    by_pair = dict[tuple[str, str], str]()
    for approach in state.near:
        names = approach.pair.a.name_in(approach.case), approach.pair.b.name_in(approach.case)
        missing = state.missing(approach)
        if {*names} == {blocked.body_a, blocked.body_b} or not len(missing):
            continue
        if missing.max() < -CLOSE:
            continue
        time = approach.times[missing.argmax()]
        by_pair.setdefault(names, f"{names[0]} and {names[1]} have no more to give at {time:.3f} s")
    return list(by_pair.values())


def _joints(placed: PlacedRobot, time: float) -> list[str]:
    """The joints that are at a limit at the samples next to a time of the run [s]."""
    own = placed.timing.table_times(time)
    lines = []
    for one in joint_ranges(placed):
        after = int(np.clip(np.searchsorted(one.times, own), 0, len(one.times) - 1))
        near = one.headroom[max(after - 1, 0) : after + 1]
        if near.min() < CLOSE:
            lines.append(f"joint {one.joint} is at its {one.what}")
    return lines
