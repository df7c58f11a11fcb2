"""What carries a frame by time tables of its own, a conveyor or another robot: its pose, as numbers and as series.

The way from the robot's root to the frame is a chain of fixed poses, slides and turns. Between two knots of a
table a joint moves on a cubic; a pose goes straight and turns about one axis at constant speed, as in the engine.
Not for: where the chain comes from (`case.places`), how joints follow (`following`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from clearance.errors import BadProgram
from clearance.geometry.quaternions import half_skew, rotations_of
from clearance.programs.series import (
    ORDER,
    majorant_of_turns,
    matrix_product,
    moved,
    product,
    turns_about,
)
from clearance.world.kinematic_chain import ChainJoint
from clearance.world.knots import Knots
from clearance.world.slerp import arcs_between
from clearance.world.timing import Timing

AT_KNOT = 1e-9
"""[s] A time that is this near to a knot is at it."""


SMOOTH = 0.01
"""[m/s] and [rad/s] By less the speed of a carriage changes from row to row of a table with many rows."""


class Cubics(NamedTuple):
    """Cubics of time, piece by piece: constant before the first of m knots and after the last.

    Attributes:
        knots: (m,) [s]. powers: (4, m + 1, c) their coefficients, the time counted from the piece's first knot.
    """

    knots: np.ndarray
    powers: np.ndarray

    @classmethod
    def of(cls, knots: Knots, columns: Sequence[int]) -> Cubics:
        """Some columns of a table that does not jump."""
        a, b = knots.after[:-1, columns], knots.before[1:, columns]
        length = np.diff(knots.times)[:, None]
        mean = (b - a) / length
        powers = np.zeros((4, len(knots.times) + 1, len(columns)))
        powers[0, 0], powers[0, 1:] = knots.before[0, columns], knots.after[:, columns]
        powers[1, 1:-1] = mean
        if knots.rates_before is not None and knots.rates_after is not None:
            va, vb = knots.rates_after[:-1, columns], knots.rates_before[1:, columns]
            powers[1, 1:-1] = va
            powers[2, 1:-1] = (3.0 * mean - 2.0 * va - vb) / length
            powers[3, 1:-1] = (va + vb - 2.0 * mean) / length**2
        return cls(knots.times, powers)

    def places(self, times: np.ndarray, before: bool = False) -> np.ndarray:
        """(n,) the piece that begins at, or is about, each time; with `before` the one that ends there."""
        return np.searchsorted(self.knots, times + (-AT_KNOT if before else AT_KNOT))

    def series(self, times: np.ndarray, half: np.ndarray, places: np.ndarray) -> np.ndarray:
        """(ORDER + 1, n, c) about times (n,) [s], in units of half (n,) [s], on pieces (n,)."""
        x = (times - self.knots[np.maximum(places - 1, 0)])[:, None]
        unit = half[:, None]
        c0, c1, c2, c3 = self.powers[:, places]
        found = np.zeros((ORDER + 1, *c0.shape))
        found[0] = c0 + x * (c1 + x * (c2 + x * c3))
        found[1] = unit * (c1 + x * (2.0 * c2 + 3.0 * x * c3))
        found[2] = unit**2 * (c2 + 3.0 * x * c3)
        found[3] = unit**3 * c3
        return found


class Slide(NamedTuple):
    """A way along axes (c, 3) by numbers of a table [m], and how far each may be off them [m]."""

    table: Cubics
    axes: np.ndarray
    off: float = 0.0


class Turn(NamedTuple):
    """A turn about an axis by angles of a table [rad], and how far each may be off them [rad].

    Attributes:
        axes: (3,), or (m + 1, 3) of each piece. first: (m + 1, 3, 3) what is turned before that; None for nothing.
    """

    table: Cubics
    axes: np.ndarray
    first: np.ndarray | None = None
    off: float = 0.0


class Handed(NamedTuple):
    """Ways that take turns, as a part changes hands; where one begins the pose is that of the one before.

    Attributes:
        starts: (m,) [s] when all but the first begin. ways: (m + 1) steps of each.
        until: [s] from when on nobody knows.
    """

    starts: np.ndarray
    ways: tuple[tuple[Step, ...], ...]
    until: float = np.inf

    def series(self, times: np.ndarray, half: np.ndarray, before: bool) -> Carried:
        """What `series_of` says of the ways of the times."""
        turns = np.searchsorted(self.starts, times + (-AT_KNOT if before else AT_KNOT))
        n = len(times)
        turn, origin = np.zeros((ORDER + 1, n, 3, 3)), np.zeros((ORDER + 1, n, 3))
        majorants, turned, off = np.zeros((2, ORDER + 2, n)), np.zeros(n), np.zeros(2)
        for k in np.unique(turns):
            rows = turns == k
            own = series_of(self.ways[k], times[rows], half[rows], before)
            turn[:, rows], origin[:, rows] = own.turn, own.origin
            majorants[:, :, rows] = own.turn_majorant, own.way_majorant
            turned[rows], off = own.turned, np.maximum(off, own.off)
        return Carried(turn, origin, majorants[0], majorants[1], turned, off)


Step = np.ndarray | Slide | Turn | Handed
"""A fixed pose (4, 4) [m], or what moves."""


def steps_of_joint(joint: ChainJoint, knots: Knots, column: int, off: float) -> list[Step]:
    """A joint of a chain by the column of a table that it follows.

    Args:
        off: [rad or m] how far that may be off its cubics.
    """
    table = Cubics.of(knots, [column])
    powers = joint.factor * table.powers
    powers[0] += joint.offset
    own, off = table._replace(powers=powers), abs(joint.factor) * off
    moves = Turn(own, joint.axis, off=off) if joint.turns else Slide(own, joint.axis[None], off)
    return [joint.before, moves]


def steps_of_poses(knots: Knots) -> list[Step]:
    """Poses of a table: straight ways, and turns about one axis at constant speed."""
    quaternions = knots.after[:, 3:]
    arcs = arcs_between(quaternions[:-1], quaternions[1:])
    turned = rotations_of(quaternions)
    angles = np.zeros((4, len(knots.times) + 1, 1))
    angles[1, 1:-1] = arcs[:, 3:] / np.diff(knots.times)[:, None]
    axes = np.tile([0.0, 0.0, 1.0], (len(knots.times) + 1, 1))
    axes[1:-1] = arcs[:, :3]
    turn = Turn(Cubics(knots.times, angles), axes, np.concatenate([turned[:1], turned]))
    return [Slide(Cubics.of(knots, [0, 1, 2]), np.eye(3)), turn]


class Carried(NamedTuple):
    """Poses of a carriage about the middles of n intervals, as series in halves of each.

    Attributes:
        turn: (ORDER + 1, n, 3, 3). origin: (ORDER + 1, n, 3) [m].
        turn_majorant, way_majorant: (ORDER + 2, n) of both.
        turned: (n,) [rad] how far it turns from the middle.
        off: (2,) [m] and [rad] how far its own joints may be off, all slides and all turns together.
    """

    turn: np.ndarray
    origin: np.ndarray
    turn_majorant: np.ndarray
    way_majorant: np.ndarray
    turned: np.ndarray
    off: np.ndarray

    def rows(self, i: np.ndarray) -> Carried:
        """Those of some intervals."""
        turn, way = self.turn_majorant[:, i], self.way_majorant[:, i]
        return Carried(self.turn[:, i], self.origin[:, i], turn, way, self.turned[i], self.off)

    def then(self, other: Carried) -> Carried:
        """Those of another carriage that is on this one."""
        series = self.seen(other.turn, other.origin)
        majorants = self.majorants(other.turn_majorant, other.way_majorant)
        return Carried(*series, *majorants, self.turned + other.turned, self.off + other.off)

    def seen(self, turn: np.ndarray, origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The series of a pose on it, seen from the root."""
        way = matrix_product(self.turn, origin[..., None])[..., 0]
        return matrix_product(self.turn, turn), self.origin + way

    def majorants(self, turn: np.ndarray, origin: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The majorants of a pose on it, seen from the root."""
        way = product(self.turn_majorant, origin)
        return product(self.turn_majorant, turn), self.way_majorant + way

    @property
    def poses(self) -> np.ndarray:
        """(n, 4, 4) at the middles [m]."""
        found = np.tile(np.eye(4), (len(self.turned), 1, 1))
        found[:, :3, :3], found[:, :3, 3] = self.turn[0], self.origin[0]
        return found


class Moved(NamedTuple):
    """Poses (n, 4, 4) [m] of a carriage, how fast its origin moves and how it turns (n, 3) [m/s], [rad/s]."""

    poses: np.ndarray
    speeds: np.ndarray
    spins: np.ndarray

    def rates(self, poses: np.ndarray, rates: np.ndarray) -> np.ndarray:
        """(n, 6) how poses (n, 4, 4) on it move, seen from the root, that move on it by rates (n, 6)."""
        turn = self.poses[:, :3, :3]
        way, at, spin = (
            (turn @ one[..., None])[..., 0] for one in (rates[:, :3], poses[:, :3, 3], rates[:, 3:])
        )
        return np.hstack([way + self.speeds + np.cross(self.spins, at), spin + self.spins])


@dataclass(frozen=True, eq=False)
class Carriage:
    """Where something is over time that moves by itself, seen from the root of a program's robot.

    Attributes:
        name: of what moves. steps: from the root to it.
    """

    name: str
    steps: tuple[Step, ...]

    @cached_property
    def knots(self) -> np.ndarray:
        """(m,) [s] the times between which it moves on one cubic, in order."""
        times = list[float]()
        for one in _all_of(self.steps):
            if isinstance(one, Handed):
                times += [*one.starts, *([one.until] if np.isfinite(one.until) else [])]
            elif not isinstance(one, np.ndarray):
                times += [*one.table.knots]
        return np.unique(times)

    @cached_property
    def until(self) -> float:
        """[s] When nobody knows any more where it is."""
        ends = (one.until for one in _all_of(self.steps) if isinstance(one, Handed))
        return min(ends, default=np.inf)

    @cached_property
    def turning_points(self) -> np.ndarray:
        """(m,) [s] those of the knots at which its speed changes at once, by more than `SMOOTH`."""
        before, after = (self.at(self.knots, before) for before in (True, False))
        speeds, spins = after.speeds - before.speeds, after.spins - before.spins
        return self.knots[np.abs(np.hstack([speeds, spins])).max(axis=1) > SMOOTH]

    def require_known(self, time: float) -> None:
        """Nothing, if it is known where it is until a time [s].

        Raises:
            BadInput: it is carried by what a program moves.
        """
        if time > self.until + AT_KNOT:
            raise BadProgram(
                f"from {self.until:.6g} s on {self.name!r} is carried by what a program moves, or is not there; "
                f"the move in its frame ends at {time:.6g} s",
                valid="moves that end before, or a frame on what it lies on",
            )

    def in_time_of(self, timing: Timing) -> Carriage:
        """The same by the time of a table that a run follows so."""
        if timing.start == 0.0 and timing.rate == 1.0:
            return self
        return replace(self, steps=_by_time_of(self.steps, timing))

    def at(self, times: np.ndarray, before: bool = False) -> Moved:
        """Where it is at times (n,) [s], and how it moves from then on; until then with `before`."""
        found = self.series(times, np.ones(len(times)), before)
        spins = half_skew(found.turn[1] @ np.swapaxes(found.turn[0], 1, 2))
        return Moved(found.poses, found.origin[1], spins)

    def series(self, times: np.ndarray, half: np.ndarray, before: bool = False) -> Carried:
        """About times (n,) [s] in units of half (n,) [s], which reaches no farther than the next knots."""
        return series_of(self.steps, times, half, before)


def series_of(
    steps: Sequence[Step], times: np.ndarray, half: np.ndarray, before: bool = False
) -> Carried:
    """The poses at the end of steps, as `Carriage.series`."""
    for i, one in enumerate(steps):
        if isinstance(one, Handed):
            found = _series(steps[:i], times, half, before).then(one.series(times, half, before))
            return found.then(series_of(steps[i + 1 :], times, half, before))
    return _series(steps, times, half, before)


def _all_of(steps: Sequence[Step]) -> Iterator[Step]:
    """Steps, and those of ways that take turns."""
    for one in steps:
        yield one
        for way in one.ways if isinstance(one, Handed) else ():
            yield from _all_of(way)


def _by_time_of(steps: Sequence[Step], timing: Timing) -> tuple[Step, ...]:
    """The steps by the time of a table that a run follows so."""
    found, scale = list[Step](), np.power(1.0 / timing.rate, np.arange(4))[:, None, None]
    for one in steps:
        if isinstance(one, Handed):
            ways = tuple(_by_time_of(way, timing) for way in one.ways)
            one = Handed(timing.table_times(one.starts), ways, timing.table_times(one.until))
        elif not isinstance(one, np.ndarray):
            knots = timing.table_times(one.table.knots)
            one = one._replace(table=Cubics(knots, one.table.powers * scale))
        found.append(one)
    return tuple(found)


def _series(steps: Sequence[Step], times: np.ndarray, half: np.ndarray, before: bool) -> Carried:
    """The same of steps that stay the same."""
    n = len(times)
    turn, origin = np.zeros((ORDER + 1, n, 3, 3)), np.zeros((ORDER + 1, n, 3))
    turn[0] = np.eye(3)
    turns, lengths, off = np.zeros((ORDER + 2, n)), np.zeros((ORDER + 2, n)), np.zeros(2)
    for one in steps:
        assert not isinstance(one, Handed)
        if isinstance(one, np.ndarray):
            origin += turn @ one[:3, 3]
            turn = turn @ one[:3, :3]
            lengths[0] += np.linalg.norm(one[:3, 3])
            continue
        places = one.table.places(times, before)
        series = one.table.series(times, half, places)
        if isinstance(one, Slide):
            ways = series @ one.axes
            origin += matrix_product(turn, ways[..., None])[..., 0]
            sizes = np.linalg.norm(ways, axis=2)
            lengths += moved(sizes)
            lengths[0] += sizes.sum(axis=0)
            off[0] += one.off
            continue
        axes = one.axes[places] if one.axes.ndim == 2 else one.axes
        if one.first is not None:
            turn = turn @ one.first[places]
        turn = matrix_product(turn, turns_about(axes, series[..., 0]))
        turns += moved(np.abs(series[..., 0]))
        off[1] += one.off
    majorant = majorant_of_turns(turns)
    turned = turns[1:].sum(axis=0)
    return Carried(turn, origin, majorant, product(majorant, lengths), turned, off)
