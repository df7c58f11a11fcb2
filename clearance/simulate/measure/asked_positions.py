"""Configurations that are asked about: usual, suspect, beyond limits, or such that neighbours meet in them.

Neighbours that are apart at home are warned of once where they meet. The free positions of a joint are worked out
once, so that a configuration within them costs a comparison. Not for: clearances (`checker`), runs (`neighbours`).
"""

from __future__ import annotations

import warnings
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from clearance.errors import SuspectInput, at
from clearance.simulate.measure.neighbours import Neighbours, excused_neighbours
from clearance.tolerance import REACH
from clearance.world.case import Case
from clearance.world.joint_limits import far_beyond, notices_on_joints
from clearance.world.joint_positions import joint_extents
from clearance.world.mimics import followers
from clearance.world.notice import Notice, Severity, accepted_kind
from clearance.world.placed_robot import PlacedRobot
from clearance.world.plausible_motion import largest_usual, notices_on_positions
from clearance.world.trajectory import Trajectory


@dataclass(frozen=True, eq=False)
class _Watched:
    """A pair whose joint is the given column of a configuration, and from where to where it is free [rad or m]."""

    pair: Neighbours
    column: int
    free: tuple[float, float]

    def meets_at(self, given: np.ndarray) -> Notice | None:
        """A warning if the two meet at one of the configurations (n, k)."""
        positions = given[:, self.column]
        low, high = self.free
        outside = positions[(positions < low) | (positions > high)]
        return self.pair.meets_at(outside[:, None]) if len(outside) else None


class AskedNeighbours:
    """The neighbours of a case that are apart at home.

    Args:
        names: of the joints that a configuration gives, robot by robot.

    Attributes:
        at_rest: a warning on each pair whose joint no configuration gives, and that meets where it stays.
        free: (k, 2) from where to where each joint of a configuration is in no doubt [rad or m].
    """

    def __init__(self, case: Case, names: Sequence[tuple[str, ...]]) -> None:
        self.at_rest: list[Notice] = []
        self._n_columns = sum(map(len, names))
        self._watched: list[_Watched] = []
        first = 0
        for i, given in enumerate(names):
            for pair in excused_neighbours(case, i):
                if not pair.is_apart_at_home:
                    continue
                if not set(pair.joints) & set(given):
                    fixed = case.robots[i].fixed_positions
                    stays = np.array([[fixed.get(name, 0.0) for name in pair.joints]])
                    self.at_rest += [one] if (one := pair.meets_at(stays)) else []
                elif pair.is_by_one_joint:
                    column = first + given.index(pair.joints[0])
                    self._watched.append(_Watched(pair, column, pair.free_range()))
            first += len(given)
        self._set_free()

    def _set_free(self) -> None:
        self.free = np.tile([-REACH, REACH], (self._n_columns, 1))
        for one in self._watched:
            low, high = self.free[one.column]
            self.free[one.column] = max(low, one.free[0]), min(high, one.free[1])

    def meeting_at(self, given: np.ndarray) -> list[Notice]:
        """A warning on each pair that meets at one of the configurations (n, k); it is not watched any longer."""
        found = [(one, one.meets_at(given)) for one in self._watched]
        self._watched = [one for one, notice in found if notice is None]
        self._set_free()
        return [notice for _, notice in found if notice is not None]


class AskedPositions:
    """Checks the configurations for which a clearance is asked.

    Args:
        names: of the joints that a configuration gives, robot by robot. accept: kinds of suspect input that are
            meant, with those that the case accepts.

    Raises:
        BadInput: neither a kind of suspect input nor the code of one.
    """

    def __init__(
        self, case: Case, names: Sequence[tuple[str, ...]], accept: Collection[str]
    ) -> None:
        self._case, self._names = case, names
        with at("accept"):
            self._accept = frozenset((*case.accept, *map(accepted_kind, accept)))
        self._neighbours = AskedNeighbours(case, names)
        self._far = False
        self._set_usual()

    def are_usual(self, given: np.ndarray) -> bool:
        """True if all configurations (..., k) are finite, within limits, and where neighbours are apart."""
        is_usual = (given >= self._least) & (given <= self._greatest)
        return np.count_nonzero(is_usual) == is_usual.size  # half the time of `all`

    def at_rest(self) -> list[Notice]:
        """The notices on joints that no configuration gives; a case with motion has most of these itself."""
        moves = [placed.trajectory is not None for placed in self._case.robots]
        if any(moves) or any(obstacle.moves is not None for obstacle in self._case.obstacles):
            return self._neighbours.at_rest
        usual = np.clip(0.0, self._least, self._greatest)
        return [*self._notices(usual[None]), *self._neighbours.at_rest]

    def require_not_suspect(self, notices: Collection[Notice]) -> None:
        """Checks that each kind of suspect input among the notices is accepted.

        Raises:
            SuspectInput: the first that is not.
        """
        for one in notices:
            if one.severity is Severity.SUSPECT and not one.accepted_by(self._accept):
                raise SuspectInput(one.text, valid=f"correct it, or accept=[{one.kind!r}]")

    def require_decided(self, undecided: Sequence[tuple[str, str]]) -> None:
        """Checks that no pair may be one inside the other, or that this is accepted.

        Raises:
            SuspectInput: the first that may be.
        """
        if "inside" not in self._accept:
            link, obstacle = undecided[0]
            raise SuspectInput(
                f"link {link} may be inside obstacle {obstacle}, or round it: the surface has holes, cracks or "
                "two sides, and the distance is that of the surfaces alone",
                where="configuration",
                valid="close the mesh, or accept=['inside'], and read `undecided`",
            )

    def judge(self, given: np.ndarray) -> None:
        """Warns, once, of configurations (n, k) beyond the limits of joints, or in which neighbours meet.

        Raises:
            SuspectInput: one is far beyond, as in another unit, and that is not accepted.
        """
        notices = list(self._notices(given))
        self.require_not_suspect(notices)
        beyond = [one for one in notices if one.severity is not Severity.SUSPECT]
        if beyond and "limits" not in self._accept:
            self._far = True
            if not beyond[0].accepted_by(self._accept):
                warnings.warn(f"{beyond[0].line}; further ones are not reported", stacklevel=4)
        for one in self._neighbours.meeting_at(given):
            warnings.warn(one.line, stacklevel=4)
        self._set_usual()

    def _notices(self, given: np.ndarray) -> Iterator[Notice]:
        """The notices of `check` on a trajectory with these rows as samples."""
        first, rule = 0, self._case.limits.joints
        times = np.arange(len(given), dtype=np.float64)
        for placed, names in zip(self._case.robots, self._names, strict=True):
            positions = given[:, first : first + len(names)]
            first += len(names)
            asked = placed.moved_by(Trajectory(times, names, positions))
            before = self._case.prefix_of(placed)
            yield from notices_on_positions(joint_extents(asked), before)
            yield from notices_on_joints(asked, rule, before)

    def _set_usual(self) -> None:
        """Sets (k,) least and greatest positions without any notice that was not given before."""
        pairs = zip(self._case.robots, self._names, strict=True)
        ranges = np.concatenate([self._ranges(placed, names) for placed, names in pairs])
        free = self._neighbours.free
        self._least = np.maximum(ranges[:, 0], free[:, 0])
        self._greatest = np.minimum(ranges[:, 1], free[:, 1])

    def _ranges(self, placed: PlacedRobot, names: Sequence[str]) -> np.ndarray:
        """(k, 2) the usual range of each joint and of all that follow it."""
        ranges = np.tile([-REACH, REACH], (len(names), 1))
        place = {name: i for i, name in enumerate(names)}
        for joint, master, factor, offset in followers(placed.robot):
            if master not in place or factor == 0.0:
                continue
            least, greatest = -REACH, REACH
            if "units" not in self._accept:
                least, greatest = -largest_usual(joint), largest_usual(joint)
            if "limits" not in self._accept:
                beyond = far_beyond(joint) if self._far else 0.0
                least, greatest = (
                    max(least, joint.lower - beyond),
                    min(greatest, joint.upper + beyond),
                )
            ends = sorted(((least - offset) / factor, (greatest - offset) / factor))
            row = ranges[place[master]]
            row[:] = max(row[0], ends[0]), min(row[1], ends[1])
        return ranges
