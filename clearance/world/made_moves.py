"""The moves that the programs of a case make, and when: what is told beside a time. Not for: making them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.trajectory import MoveSpan


@dataclass(frozen=True, eq=False)
class RobotMoves:
    """The moves of one robot's program that take time.

    Attributes:
        robot: its name. names: (m,) of the moves, with that of the robot before them where several have programs.
        starts, ends: (m,) [s] of the run. repeats: whether it begins again at its end.
    """

    robot: str
    names: Sequence[str]
    starts: np.ndarray
    ends: np.ndarray
    repeats: bool

    @classmethod
    def of(cls, placed: PlacedRobot, prefix: str) -> RobotMoves:
        """Those of a robot that has some."""
        spans = _spans(placed)
        edges = placed.timing.run_times(np.array([*(one.start for one in spans), spans[-1].end]))
        names = [prefix + one.name for one in spans]
        repeats = placed.timing.after == "loop"
        return cls(placed.robot.name, names, edges[:-1], edges[1:], repeats)

    def places(self, times: np.ndarray) -> np.ndarray:
        """(n,) which move is made at times (n,) [s]; -1 for none. The end of a move is its own, not the next's."""
        first, last = self.starts[0], self.ends[-1]
        if self.repeats:
            times = np.where(times > last, first + (times - first) % (last - first), times)
        found = np.minimum(np.searchsorted(self.ends, times), len(self.ends) - 1)
        return np.where((times >= first) & (times <= last), found, -1)


@dataclass(frozen=True)
class MadeMoves:
    """The moves of all programs of a case, a robot each; none where no robot has a program."""

    robots: tuple[RobotMoves, ...] = ()

    @classmethod
    def of(cls, case: Case) -> MadeMoves:
        """Those of a case."""
        programmed = [placed for placed in case.robots if _spans(placed)]
        several = len(programmed) > 1
        prefixes = (case.prefix_of(placed) if several else "" for placed in programmed)
        return cls(tuple(map(RobotMoves.of, programmed, prefixes)))

    def codes(self, times: np.ndarray) -> tuple[np.ndarray, list[str]]:
        """(n,) which of some names is of times (n,) [s], -1 where no program goes on; and the names."""
        if not self.robots:
            return np.full(len(times), -1), []
        rows = np.stack([one.places(times) for one in self.robots], axis=1)
        each, codes = np.unique(rows, axis=0, return_inverse=True)
        names = [self._name(row) for row in each.tolist()]
        found = codes.reshape(-1)
        return np.where(np.array([not name for name in names])[found], -1, found), names

    def _name(self, places: Sequence[int]) -> str:
        by_robot = zip(self.robots, places, strict=True)
        return ", ".join(one.names[i] for one, i in by_robot if i >= 0)

    def at(self, time: float) -> str:
        """The move at a time [s], of each robot that makes one; empty where none does."""
        return self._name([int(one.places(np.array([time]))[0]) for one in self.robots])

    def over(self, start: float, end: float) -> str:
        """The first and the last move of a stretch [s]: `LIN 3 to LIN 5`."""
        return " to ".join(dict.fromkeys(filter(None, (self.at(start), self.at(end)))))

    def named(self, row: Any) -> Any:
        """Plain data, in which a row with a time has its `move`, and one with a start and an end its `moves`."""
        if not self.robots:
            return row
        if isinstance(row, list):
            return [self.named(one) for one in row]
        if not isinstance(row, dict):
            return row
        found = {key: self.named(value) for key, value in row.items()}
        if isinstance(time := row.get("time"), float):
            found["move"] = self.at(time)
        start, end = row.get("start"), row.get("end")
        if isinstance(start, float) and isinstance(end, float):
            found["moves"] = self.over(start, end)
        return found


def _spans(placed: PlacedRobot) -> list[MoveSpan]:
    """The moves of a robot's program that take time."""
    moves = () if placed.trajectory is None else placed.trajectory.moves
    return [one for one in moves if one.end > one.start]
