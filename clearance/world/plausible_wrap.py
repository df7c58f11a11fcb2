"""Notices on long turns of continuous joints for which the case does not say which way round they go."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from clearance.world.case import Case
from clearance.world.notice import WRAP, Notice, Severity, listed
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import time_text
from clearance.world.trajectory import SHORTEST
from clearance.world.wrap import LongStep, long_steps


def notices_on_wrap(placed: PlacedRobot, before: str = "") -> list[Notice]:
    """One notice on the joints that turn by more than half a turn in a step, with the longest step.

    Args:
        before: what stands before the names of joints.
    """
    found = _open_steps(placed)
    if not found:
        return []
    first, others = found[0], listed([repr(before + one.joint) for one in found[1:]])
    start, end = placed.timing.run_times(np.array([first.start, first.end])).tolist()
    text = (
        f"joint {before + first.joint!r} turns by more than half a turn in one step, from {first.before:.6g} to "
        f"{first.after:.6g} rad between {time_text(start)} s and {time_text(end)} s"
        f"{f', and in {first.n_steps - 1} more' if first.n_steps > 1 else ''}"
        f"{f' (the same for {others})' if others else ''}: {first.after - first.before:.3g} rad as written, "
        f"{first.shortest:.3g} rad the shortest way; say which with trajectory: {{wrap: as_written}} or "
        "{wrap: shortest}"
    )
    return [Notice(Severity.SUSPECT, WRAP, text, placed.robot.name)]


def shortest_reading(case: Case) -> Case | None:
    """The case in which these turns go the shortest way; None where there are none, or the case accepts them."""
    if WRAP in case.accept or not any(map(_open_steps, case.robots)):
        return None
    return replace(case, robots=tuple(map(_by_shortest, case.robots)))


def _by_shortest(placed: PlacedRobot) -> PlacedRobot:
    if not _open_steps(placed):
        return placed
    return replace(placed, trajectory=replace(placed.given_trajectory, wrap=SHORTEST))


def _open_steps(placed: PlacedRobot) -> list[LongStep]:
    asked = placed.trajectory
    return [] if asked is None or asked.wrap is not None else long_steps(placed.robot, asked)
