"""A change of time: a robot begins later, or goes slower. The least is gone up to from below, and never past.

Where at a delay a pair is `missing` short, no point that the robot carries moves faster than `speed`, so no delay
that is longer by less than missing / speed is enough. A robot that takes 1 + s times as long is at the time T
after its start where its table is at T / (1 + s): none is enough that takes it back by less than missing / speed
there.
Not for: changes of place (`search`).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from clearance.errors import BadChange
from clearance.gains.delay_obstruction import is_at_any_delay, stays_whatever
from clearance.gains.lower_bounds import INWARD, motion_radii, way_needed
from clearance.gains.moved_windows import carries_moved, require_own_parts
from clearance.gains.obstruction import Obstruction
from clearance.gains.offsets import columns_of
from clearance.gains.search import SearchResult
from clearance.gains.shortfalls import Requirement, State, keeps, measured, proven
from clearance.record.record import Record
from clearance.simulate.answers.approaches import Approach
from clearance.simulate.answers.point_motion import moves_with_joints
from clearance.simulate.answers.transfers import Transfers
from clearance.world.case import Case
from clearance.world.pairs import bodies_of
from clearance.world.timing import Timing

FINEST = 1e-3
"""[s] Delays are sought this finely: controllers run at some milliseconds."""

FINEST_SHARE = 1e-3
"""[-] So finely it is sought how much longer a path takes."""

MOST_SLOWER = 9.0
"""[-] A path that takes ten times as long is not slowed further."""

MOST_DELAYS = 400
"""That are measured: three quarters of them as finely as is proven, the others evenly up to the longest."""

Longer = Callable[[State, Approach, np.ndarray], np.ndarray]
"""(k,) how much more must be changed at least, so that bodies have come some way (k,) [m] from where they are."""


@dataclass(frozen=True, eq=False)
class TimingResult(SearchResult):
    """Where the search ended.

    Attributes:
        delay: [s], or by what share a path takes longer: the least found that keeps the rules, else the last
            looked at.
        at_least: no less does; infinite where none does.
        stays: a pair that stays as near with any change that is greater; None without one.
    """

    delay: float
    at_least: float
    stays: Obstruction | None = None


def case_later(case: Case, i_robot: int, delay: float) -> Case:
    """The case with one robot that begins later by `delay` [s], with the times of the parts that it carries."""
    timing = case.robots[i_robot].timing
    after = replace(timing, start=timing.start + delay)
    return _retimed(case, i_robot, after, lambda time: time + delay)


def case_slower(case: Case, i_robot: int, more: float) -> Case:
    """The case with one robot whose path takes `more` of its time longer, from its table's time 0 on."""
    timing = case.robots[i_robot].timing
    after = replace(timing, rate=timing.rate / (1.0 + more))
    return _retimed(
        case, i_robot, after, lambda time: timing.start + (time - timing.start) * (1.0 + more)
    )


def _retimed(case: Case, i_robot: int, timing: Timing, later: Callable[[float], float]) -> Case:
    robots = list(case.robots)
    placed = robots[i_robot]
    begins = float(placed.timing.run_times(placed.given_trajectory.times)[0])
    robots[i_robot] = replace(placed, timing=timing)
    carries = carries_moved(case, i_robot, begins, later)
    return replace(case, robots=tuple(robots), carries=carries)


def least_delay(case: Case, i_robot: int, margin: float, most: float) -> TimingResult:
    """The least delay up to `most` [s] at which the rules hold by a margin [m].

    Raises:
        BadInput: nothing else moves, or the robot goes through its path again and again.
    """
    _require_another(case, i_robot)
    require_own_parts(case, i_robot)
    speed = greatest_speed(case, i_robot)

    def longer(state: State, approach: Approach, ways: np.ndarray) -> np.ndarray:
        now, times = state.case.robots[i_robot], approach.times
        known = is_at_any_delay(state.case, i_robot, times)
        since = times - now.timing.run_times(now.given_trajectory.times)[0]
        return np.where(known, _over(ways, speed), np.minimum(_over(ways, speed), since))

    return _least(
        lambda delay: case_later(case, i_robot, delay), longer, i_robot, margin, (FINEST, most)
    )


def least_slowing(case: Case, i_robot: int, margin: float) -> TimingResult:
    """By what share a robot's path takes longer at least, up to `MOST_SLOWER`, so that the rules hold.

    Raises:
        BadInput: as `least_delay`; a table that begins before its time 0.
    """
    _require_another(case, i_robot)
    require_own_parts(case, i_robot)
    placed = case.robots[i_robot]
    if placed.given_trajectory.times[0] < 0.0:
        raise BadChange(
            f"the table of robot {placed.robot.name!r} begins before its time 0, about which it would be slowed",
            valid="a table that begins at 0 or later",
        )
    speed = greatest_speed(case, i_robot) / placed.timing.rate

    def longer(state: State, approach: Approach, ways: np.ndarray) -> np.ndarray:
        now = state.case.robots[i_robot]
        times = approach.times
        at = np.maximum(now.timing.table_times(times), 0.0)
        then = np.maximum(at - _over(ways, speed), 0.0)
        known = is_at_any_delay(state.case, i_robot, times)
        then = np.where(known, then, np.maximum(then, now.given_trajectory.times[0]))
        slower = np.divide(at, then, out=np.full(len(at), np.inf), where=then > 0.0)
        ratio = placed.timing.rate / now.timing.rate
        return np.maximum(slower - 1.0, 0.0) * ratio

    return _least(
        lambda more: case_slower(case, i_robot, more),
        longer,
        i_robot,
        margin,
        (FINEST_SHARE, MOST_SLOWER),
    )


def _over(ways: np.ndarray, speed: float) -> np.ndarray:
    """(k,) [s] that ways (k,) [m] take at least; infinite where nothing moves."""
    return np.divide(ways, speed, out=np.where(ways > 0.0, np.inf, 0.0), where=speed > 0.0)


def _least(
    case_of: Callable[[float], Case],
    longer: Longer,
    i_robot: int,
    margin: float,
    steps: tuple[float, float],
) -> TimingResult:
    """The least change of time found.

    Args:
        steps: how finely it is sought, and up to what.
    """
    finest, most = steps
    wanted, delay, at_least = Requirement(margin, 0.0, np.zeros(0)), 0.0, 0.0
    record: Record | None = None
    stays: Obstruction | None = None
    n_measured = 0
    while n_measured < MOST_DELAYS:
        n_measured += 1
        state = measured(case_of(delay), np.zeros(0), wanted, 0.0)
        if state.worst <= 0.0:
            record = proven(state.case, margin)
            if keeps(record):
                at_least = min(at_least, delay)
                break
        stays = stays_whatever(state, i_robot)
        if stays is not None:
            at_least = np.inf if at_least >= delay else at_least
            break
        excluded = delay + _excluded(state, i_robot, margin, longer)
        at_least = max(at_least, excluded) if at_least >= delay else at_least
        n_left, stride = MOST_DELAYS - n_measured, finest
        if 0 < n_left < MOST_DELAYS // 4:
            stride = max(finest, (most - delay) / n_left)
        if max(excluded, delay + stride) > most:
            break
        delay = max(excluded, delay + stride)
    return TimingResult(state, record, n_measured, delay, at_least, stays)


def greatest_speed(case: Case, i_robot: int) -> float:
    """[m/s] No point of any body moves faster by the joints of a robot, on its table's lines or cubics.

    On a cubic a velocity lies between the least and the greatest of the Bernstein coefficients of its parabola.
    """
    placed = case.robots[i_robot]
    asked = placed.given_trajectory
    mean = np.diff(asked.positions, axis=0) / np.diff(asked.times)[:, None]
    rates = [mean]
    if asked.velocities is not None:
        before, after = asked.velocities[:-1], asked.velocities[1:]
        rates = [before, after, 3.0 * mean - before - after]
    fastest = np.abs(np.concatenate(rates)).max(axis=0) * placed.timing.rate
    columns = columns_of(case, i_robot)
    moving = fastest > 0.0
    radii = [motion_radii(case, body, as_they_are=True)[columns] for body in bodies_of(case)]
    return max(float(one[moving] @ fastest[moving]) for one in radii)


def _excluded(state: State, i_robot: int, margin: float, longer: Longer) -> float:
    """No change that is greater by less is enough.

    Where a moment is not in the run with every delay, or the robot not there, it tells of no longer delay than
    brings the path's beginning to it.
    """
    columns, most = columns_of(state.case, i_robot), 0.0
    transfers = Transfers(state.case, (False, i_robot))
    for approach in state.near:
        a, b = (moves_with_joints(approach.case, body, columns) for body in approach.pair)
        if a == b or transfers.has(approach):
            continue
        ways = np.maximum(way_needed(approach, margin), 0.0)
        most = max(most, float(longer(state, approach, ways).max(initial=0.0)))
    return INWARD * most


def _require_another(case: Case, i_robot: int) -> None:
    """Nothing, if a delay can change anything."""
    placed = case.robots[i_robot]
    others = [
        one for i, one in enumerate(case.robots) if i != i_robot and one.trajectory is not None
    ]
    others_move = bool(others) or any(one.moves is not None for one in case.obstacles)
    if placed.trajectory is None or placed.trajectory.n_steps < 2 or not others_move:
        raise BadChange(
            f"a delay of robot {placed.robot.name!r} changes no clearance",
            valid="a robot that moves, and another actor that moves",
        )
    if placed.timing.after == "loop":
        raise BadChange(
            f"robot {placed.robot.name!r} goes through its path again and again",
            valid="a path that ends",
        )
