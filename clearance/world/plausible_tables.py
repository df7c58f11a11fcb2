"""Tables of poses that look like millimetres or milliseconds, or do not say which way round a body turns.

Not for: joints (`plausible_motion`).
"""

from __future__ import annotations

import numpy as np

from clearance.world.case import Case
from clearance.world.extents import metres
from clearance.world.notice import WRAP, Notice, Severity
from clearance.world.plausible_motion import CREEP_SLIDE, CREEP_TURN, LEAST_SLIDE, LEAST_TURN
from clearance.world.pose_table import PoseTable

LARGE_TRAVEL = 100.0
"""[m] Nothing in a cell goes so far; in millimetres it is usual."""


HALF_TURN = 2e-3
"""[rad] A turn that is as near to half a turn is one: quaternions of three digits are off by so much."""


def notices_on_tables(case: Case) -> list[Notice]:
    """Tables of obstacles that look like another unit, or leave a turn open."""
    texts, halves = [], []
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            texts += _odd(f"obstacle {obstacle.name!r}", obstacle.moves)
            halves += _half_turns(f"obstacle {obstacle.name!r}", obstacle.moves)
    notices = [Notice(Severity.SUSPECT, "units", f"CHECK UNITS: {text}") for text in texts]
    return [*notices, *(Notice(Severity.SUSPECT, WRAP, text) for text in halves)]


def _half_turns(what: str, table: PoseTable) -> list[str]:
    """Notice of half a turn of a body in a step, which is as far either way round."""
    cosines = np.abs((table.quaternions[1:] * table.quaternions[:-1]).sum(axis=1))
    steps = np.flatnonzero(2.0 * cosines < HALF_TURN)
    if not len(steps):
        return []
    start, end = table.times[steps[0] : steps[0] + 2].tolist()
    return [
        f"{what} turns by half a turn in one step, from {start:g} to {end:g} s, and its table does not say which "
        "way round; give a row between"
    ]


def _odd(what: str, table: PoseTable) -> list[str]:
    texts = []
    travel = float(np.linalg.norm(np.ptp(table.positions, axis=0)))
    if travel > LARGE_TRAVEL:
        texts.append(
            f"{what} moves {metres(travel)} m; lengths are in metres, is this millimetres?"
        )
    if _creeps(table):
        length = float(table.times[-1] - table.times[0]) / table.timing.rate
        texts.append(
            f"{what} moves no faster than {CREEP_SLIDE * 1000:g} mm/s and {CREEP_TURN:g} rad/s in {length:g} s; "
            "times are in seconds, is this milliseconds?"
        )
    return texts


def _creeps(table: PoseTable) -> bool:
    """True for a motion that gets somewhere, but never faster than creeping."""
    if len(table) < 2:
        return False
    ways = np.linalg.norm(np.diff(table.positions, axis=0), axis=1)
    chords = np.linalg.norm(np.diff(table.quaternions, axis=0), axis=1)
    turns = 4.0 * np.arcsin(np.minimum(1.0, chords / 2.0))
    lengths = np.diff(table.times) / table.timing.rate
    slow = (ways / lengths).max() <= CREEP_SLIDE and (turns / lengths).max() <= CREEP_TURN
    return bool(slow and (ways.sum() > LEAST_SLIDE or turns.sum() > LEAST_TURN))
