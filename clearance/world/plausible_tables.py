"""Tables of poses that look like another unit, leave a turn open, or begin again elsewhere than they end."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from clearance.codes import codes
from clearance.world.case import Case
from clearance.world.extents import metres
from clearance.world.joint_speeds import STEP_SLIDE, STEP_TURN
from clearance.world.notice import IN_MILLIMETRES, START, WRAP, Notice, Severity, listed, units
from clearance.world.plausible_motion import CREEP_SLIDE, CREEP_TURN, LEAST_SLIDE, LEAST_TURN
from clearance.world.pose_table import PoseTable
from clearance.world.timing import time_text

LARGE_TRAVEL = 100.0
"""[m] Nothing in a cell goes so far; in millimetres it is usual."""

FAST_SLIDE, FAST_TURN = 20.0, 100.0
"""[m/s], [rad/s] Nothing in a cell is so fast: delta robots reach 10 m/s. A table that jumps is."""


HALF_TURN = 2e-3
"""[rad] A turn that is as near to half a turn is one: quaternions of three digits are off by so much."""


def notices_on_tables(case: Case) -> list[Notice]:
    """Tables of obstacles that look like another unit, leave a turn open, or begin again elsewhere."""
    texts, halves, backs = list[str](), list[str](), list[str]()
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            backs += _back_to_start(f"obstacle {obstacle.name!r}", obstacle.moves)
            texts += _odd(f"obstacle {obstacle.name!r}", obstacle.moves)
            halves += _half_turns(f"obstacle {obstacle.name!r}", obstacle.moves)
    notices = [units(text) for text in texts]
    notices += [Notice(Severity.SUSPECT, WRAP, text) for text in halves]
    if backs:
        text = f"tables that begin again (after: loop) elsewhere than they end: {listed(backs, 4)}"
        says = f"no way back is measured; accept: [{codes()[START]}] says that it is another part each time"
        notices.append(Notice(Severity.WARNING, START, f"{text}; {says}"))
    return notices


def _back_to_start(what: str, table: PoseTable) -> Iterator[str]:
    """How far a table that begins again is then from its end: as the next part of a line, not as a door."""
    if table.timing.after != "loop":
        return
    last, first = table.quaternions[-1], table.quaternions[0]
    same_side = first if last @ first >= 0.0 else -first
    ways = _ways(table.positions[[-1, 0]], np.array([last, same_side]))
    told = [
        f"{way[0]:.3g} {unit}"
        for way, least, unit in zip(ways, (STEP_SLIDE, STEP_TURN), ("m", "rad"), strict=True)
        if way[0] > least
    ]
    if told:
        yield f"{what} by {' and '.join(told)}"


def _half_turns(what: str, table: PoseTable) -> list[str]:
    """Notice of half a turn of a body in a step, which is as far either way round."""
    cosines = np.abs((table.quaternions[1:] * table.quaternions[:-1]).sum(axis=1))
    steps = np.flatnonzero(2.0 * cosines < HALF_TURN)
    if not len(steps):
        return []
    start, end = table.times[steps[0] : steps[0] + 2].tolist()
    return [
        f"{what} turns by half a turn in one step, from {time_text(start)} to {time_text(end)} s, and its "
        "table does not say which way round; give a row between"
    ]


def _odd(what: str, table: PoseTable) -> list[str]:
    travel = float(np.linalg.norm(np.ptp(table.positions, axis=0)))
    if travel > LARGE_TRAVEL:
        return [f"{what} moves {metres(travel)} m; {IN_MILLIMETRES}"]
    if len(table) < 2:
        return []
    if _creeps(table):
        length = float(table.times[-1] - table.times[0]) / table.timing.rate
        return [
            f"{what} moves no faster than {CREEP_SLIDE * 1000:g} mm/s and {CREEP_TURN:g} rad/s in {length:g} s; "
            "times are in seconds, is this milliseconds?"
        ]
    return _jump(what, table)


def _jump(what: str, table: PoseTable) -> list[str]:
    """The fastest step of a table, if nothing is so fast. A short way is no jump: stamps can lie close."""
    for ways, least, fast, unit in zip(
        _ways(table.positions, table.quaternions),
        (STEP_SLIDE, STEP_TURN),
        (FAST_SLIDE, FAST_TURN),
        ("m", "rad"),
        strict=True,
    ):
        speeds = np.where(ways > least, ways, 0.0) / _lengths(table)
        step = int(speeds.argmax())
        if speeds[step] > fast:
            start, end = table.times[step : step + 2].tolist()
            return [
                f"{what} goes {ways[step]:.3g} {unit} from {time_text(start)} to {time_text(end)} s of its table, "
                f"at {metres(speeds[step])} {unit}/s: does it jump, or are its lengths or times in another unit?"
            ]
    return []


def _ways(positions: np.ndarray, quaternions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(n - 1,) [m] and [rad] How far the n poses of a table are from one to the next."""
    ways = np.linalg.norm(np.diff(positions, axis=0), axis=1)
    chords = np.linalg.norm(np.diff(quaternions, axis=0), axis=1)
    return ways, 4.0 * np.arcsin(np.minimum(1.0, chords / 2.0))


def _lengths(table: PoseTable) -> np.ndarray:
    """(n - 1,) [s] of the run from sample to sample."""
    return np.diff(table.times) / table.timing.rate


def _creeps(table: PoseTable) -> bool:
    """True for a motion that gets somewhere, but never faster than creeping."""
    ways, turns = _ways(table.positions, table.quaternions)
    lengths = _lengths(table)
    slow = (ways / lengths).max() <= CREEP_SLIDE and (turns / lengths).max() <= CREEP_TURN
    return bool(slow and (ways.sum() > LEAST_SLIDE or turns.sum() > LEAST_TURN))


def greatest_speeds_in(table: PoseTable) -> tuple[float, float]:
    """[m/s], [rad/s] The greatest mean speeds in the run, between samples."""
    slide, turn = (
        float((ways / _lengths(table)).max()) for ways in _ways(table.positions, table.quaternions)
    )
    return slide, turn


def changes(table: PoseTable) -> bool:
    """True if the poses of a table differ."""
    return any(np.ptp(one, axis=0).any() for one in (table.positions, table.quaternions))
