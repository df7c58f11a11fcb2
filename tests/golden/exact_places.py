"""Where the bodies of a case are at a time, by rational arithmetic: riding, moving by a table, carried.

Shares no code with the package. Tables are followed linearly; a table whose body turns is looked up at its rows
only, since slerp is not rational. Not for: shapes, and which pairs are measured (`exact_clearances`).
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from clearance.world.body import Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.timing import Timing
from tests.oracle.kinematics import Pose, link_poses, on, rotation_of, seen_from

STANDING = np.eye(4)


class Places:
    """The poses `world_from_body` of a case's bodies.

    Args:
        case: as it is loaded, with all that changes hands in it.
    """

    def __init__(self, case: Case) -> None:
        self._case = case
        self._obstacles = {obstacle.name: obstacle for obstacle in case.obstacles}
        self._robots = {placed.robot.name: placed for placed in case.robots}
        self._links: dict[tuple[str, Fraction], dict[str, Pose]] = {}

    def of(self, name: str, time: Fraction) -> Pose:
        """That of an obstacle, or of a link as tables call it."""
        if name in self._obstacles:
            begun = [c for c in self._case.carries if c.part == name and c.window.start <= time]
            begun.sort(key=lambda carry: carry.window.start)
            return self._of_part(self._obstacles[name], begun, time)
        robot, _, link = name.rpartition("/")
        placed = self._robots[robot] if robot else self._case.robots[0]
        return self._of_links(placed, time)[link]

    def _of_links(self, placed: PlacedRobot, time: Fraction) -> dict[str, Pose]:
        key = placed.robot.name, time
        if key not in self._links:
            base = placed.world_from_base
            if placed.mount is not None:
                base = on(self.of(placed.mount.on, time), placed.mount.pose)
            self._links[key] = link_poses(placed.robot, _positions(placed, time), base)
        return self._links[key]

    def _of_part(self, obstacle: Obstacle, begun: Sequence[Carry], time: Fraction) -> Pose:
        """After all carries that have begun, of which the last has it or had it."""
        if not begun:
            return self._of_obstacle(obstacle, time)
        *earlier, last = begun
        start = Fraction(last.window.start)
        before = self._of_part(obstacle, earlier, start)
        held = seen_from(self.of(last.by, start), before)
        let_go = time if np.isinf(last.window.end) else min(Fraction(last.window.end), time)
        return on(self.of(last.by, let_go), held)

    def _of_obstacle(self, obstacle: Obstacle, time: Fraction) -> Pose:
        below = obstacle.world_from_body
        if obstacle.mount is not None:
            below = on(self.of(obstacle.mount.on, time), obstacle.mount.pose)
        if obstacle.moves is None:
            return on(STANDING, below)
        table = obstacle.moves
        place = _row(table.times, table.positions, table.timing, time)
        turn = _row(table.times, table.quaternions, table.timing, time, turns=True)
        return on(below, [[*row, x] for row, x in zip(rotation_of(turn), place, strict=True)])


def _positions(placed: PlacedRobot, time: Fraction) -> dict[str, Fraction]:
    """Of all joints that are given one."""
    given = {name: Fraction(value) for name, value in placed.fixed_positions.items()}
    asked = placed.trajectory
    if asked is not None:
        assert asked.velocities is None, "cubics are not followed here"
        row = _row(asked.times, asked.positions, placed.timing, time)
        given |= dict(zip(asked.joint_names, row, strict=True))
    return given


def _row(
    times: np.ndarray, rows: np.ndarray, timing: Timing, time: Fraction, *, turns: bool = False
) -> list[Fraction]:
    """A table's row at a time of the run, on the line between its rows."""
    own = _own_time(times, timing, time)
    i = int(np.searchsorted(times, float(own), side="right")) - 1
    i = max(0, min(i, len(times) - 1))
    row = [Fraction(float(x)) for x in rows[i]]
    if own == Fraction(float(times[i])) or i + 1 == len(times):
        return row
    if turns:
        assert np.array_equal(rows[i], rows[i + 1]), f"{float(own)} s is between two rows that turn"
        return row
    first, second = (Fraction(float(times[k])) for k in (i, i + 1))
    share = (own - first) / (second - first)
    return [
        x + share * (Fraction(float(y)) - x) for x, y in zip(row, rows[i + 1].tolist(), strict=True)
    ]


def _own_time(times: np.ndarray, timing: Timing, time: Fraction) -> Fraction:
    """The table's time at a time of the run."""
    own = (time - Fraction(timing.start)) * Fraction(timing.rate)
    first, last = Fraction(float(times[0])), Fraction(float(times[-1]))
    if own > last and timing.after == "loop":
        return first + (own - first) % (last - first)
    return max(first, min(own, last))
