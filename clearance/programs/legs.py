"""The legs of a program: moves, cut where corner zones begin, and the corners between; how fast each begins and
ends. Not for: joints along them (`motion`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from clearance.errors import BadProgram, at
from clearance.geometry.pose import inverse
from clearance.programs.arm import Arm
from clearance.programs.carriage import Carriage
from clearance.programs.following import Follower, joints_on_path
from clearance.programs.joint_way import RUN_UP, JointWay, fastest, limits_of_joint_move
from clearance.programs.moves import (
    SHARE_OF_WAY,
    SHORTEST,
    JointMove,
    Move,
    PathMove,
    Run,
)
from clearance.programs.time_law import UNLIMITED, Limits, Piece, trapezoid
from clearance.programs.tool_path import Stretch, arc, corner, line

LONGEST = 100.0
"""[m] A longer way is a mistake."""

Way = Stretch | JointWay
"""How the tool, or the joints, go in a move or in a part of one."""


@dataclass(frozen=True, eq=False)
class Corner:
    """A corner zone.

    Attributes:
        radius: [m]. moves: it is between. sides: the parts of both ways that it takes the place of. limits: of
            these.
        is_cut: one side would take more than `SHARE_OF_WAY`.
        joints: (k,) about where the joints are at the corner; None between lines and arcs.
    """

    radius: float
    moves: tuple[JointMove | PathMove, JointMove | PathMove]
    sides: tuple[Way, Way]
    limits: tuple[Limits, Limits]
    is_cut: bool
    joints: np.ndarray | None = None

    @property
    def sizes(self) -> np.ndarray:
        """(2,) of both sides."""
        return np.array([size_of(side) for side in self.sides])


@dataclass(frozen=True, eq=False)
class Leg:
    """A move, or a part of one, or the corner after it.

    Attributes:
        way: how it goes; None in a corner beside a joint move, and where nothing moves. pieces: how fast, within
            limits. corner: the zone that it is; None where it is none.
    """

    move: Move
    way: Way | None = None
    limits: Limits = UNLIMITED
    pieces: tuple[Piece, ...] = ()
    corner: Corner | None = None


class PlannedWay(NamedTuple):
    """How a move goes; None where nothing moves. joints: (k,) at its end, as far as joint moves after it need
    them. limits: of its speed, in the size of the way."""

    move: Move
    way: Way | None
    joints: np.ndarray
    limits: Limits


def legs_of(arm: Arm, ways: Sequence[PlannedWay]) -> Iterator[Leg]:
    """The legs of moves that follow one another without a stop.

    Raises:
        BadInput: a zone beside a move of no length; with the move.
    """
    before, legs = 0.0, list[Leg]()
    for (move, way, joints, limits), (next_move, following, _, next_limits) in pairwise(ways):
        assert way is not None and following is not None
        assert isinstance(move, JointMove | PathMove)
        assert isinstance(next_move, JointMove | PathMove)
        with at(move.where):
            radius, into, out = _cut(arm, move.zone, way, following)
        legs.append(Leg(move, way.part(before, 1.0 - into), limits))
        first, second = way.part(1.0 - into, 1.0), following.part(0.0, out)
        both = (limits, next_limits)
        zone = Corner(radius, (move, next_move), (first, second), both, radius < move.zone)
        if isinstance(first, Stretch) and isinstance(second, Stretch):
            _require_same_joints(move, first, second)
            legs.append(Leg(move, corner(first, second), corner=zone))
        else:
            is_cut = SHARE_OF_WAY in (into, out)
            legs.append(Leg(move, corner=replace(zone, is_cut=is_cut, joints=joints)))
        before = out
    last, way, _, limits = ways[-1]
    if way is None:
        yield Leg(last)
        return
    yield from _with_speeds(arm, [*legs, Leg(last, way.part(before, 1.0), limits)])


def _require_same_joints(move: JointMove | PathMove, first: Stretch, second: Stretch) -> None:
    """Nothing, if the same joints follow on both sides of a corner zone at the end of a move."""
    assert first.joints_on_path is not None and second.joints_on_path is not None
    if not np.array_equal(first.joints_on_path.free, second.joints_on_path.free):
        with at(move.where):
            fault = "other joints are held after the corner zone than before it"
            raise BadProgram(
                fault, where="hold", valid="hold the same joints on both sides, or write zone: 0"
            )


def is_none(way: Way) -> bool:
    """True where nothing moves: the next way begins where this one does."""
    if isinstance(way, JointWay):
        return way.share < SHORTEST or not way.whole.any()
    return size_of(way) < SHORTEST


def ways_of(
    arm: Arm, run: Run, start: np.ndarray, carriage: Carriage | None = None, now: float = 0.0
) -> list[PlannedWay]:
    """How the moves of a run go, from where the joints are (k,).

    Args:
        carriage: what carries their targets by itself; None for nothing. now: [s] when the run begins.

    Raises:
        BadInput: an arc that is none, a target out of reach, a zone beside joints in a frame that moves by itself;
            with the move.
    """
    pose, joints, found = arm.poses(start[None])[0], start, list[PlannedWay]()
    if carriage is not None:
        pose = inverse(carriage.at(np.array([now])).poses[0]) @ pose
    for i, move in enumerate(run):
        way: Way | None = None
        with at(move.where):
            if isinstance(move, JointMove):
                _refuse_zone(run, carriage)
                way = _joint_way_to(arm, move, joints, carriage, now)
                joints = way.target
                pose = arm.poses(joints[None])[0]
            elif isinstance(move, PathMove):
                way = _stretch(arm, pose, move, joints)
                if not is_none(way):
                    pose = way.poses(np.array([[1.0, 0.0]]))[0]
                    # on a carriage, what needs the joints then is refused, by its zone or by its hold
                    later = run[i + 1 :] if carriage is None else []
                    joints = _joints_after(arm, way, joints, later)
        found.append(PlannedWay(move, way, joints, _limits_of(arm, move, way)))
    return found


def _refuse_zone(run: Run, carriage: Carriage | None) -> None:
    """Nothing, if no corner zone joins a joint move to what moves by itself.

    Raises:
        BadInput: one does.
    """
    if carriage is not None and len(run) > 1:
        raise BadProgram(
            f"a corner zone beside a joint move, and {carriage.name!r} moves by itself",
            where="zone",
            valid="write zone: 0 before and after the joint move",
        )


MOST_TRIES = 60
"""Times that a joint move to what moves by itself is planned anew, until it arrives when it is planned to."""

ON_TIME = 1e-11
"""[s] by which it may arrive early or late."""


def _joint_way_to(
    arm: Arm, move: JointMove, joints: np.ndarray, carriage: Carriage | None, now: float
) -> JointWay:
    """The way of a joint move; to a pose on a carriage, where that is when the joints arrive.

    Raises:
        BadInput: it is not caught up with.
    """
    if move.pose is None or carriage is None:
        return JointWay.of(arm, move, joints)
    arrival = now
    for i in range(MOST_TRIES):
        pose = carriage.at(np.array([arrival])).poses[0] @ move.pose
        try:
            way = JointWay.of(arm, replace(move, pose=pose), joints)
        except BadProgram:
            if i == 0:
                raise
            break
        planned, arrival = arrival, now + duration_of(arm, move, way)
        if abs(arrival - planned) <= ON_TIME:
            carriage.require_known(arrival)
            return way
    raise BadProgram(
        f"the joints do not catch up with a target on {carriage.name!r}, which moves on meanwhile",
        valid="a greater speed, or a target that moves more slowly",
    )


def duration_of(arm: Arm, move: JointMove, way: JointWay) -> float:
    """[s] A joint move takes that begins and ends at rest."""
    if is_none(way):
        return 0.0
    return sum(
        one.duration for one in trapezoid(*limits_of_joint_move(arm.joints, way.whole, move))
    )


def _stretch(arm: Arm, start: np.ndarray, move: PathMove, joints: np.ndarray) -> Stretch:
    """The path of a move from a pose (4, 4), where the joints are (k,).

    Raises:
        BadInput: an arc that is none, or a way that is too long.
    """
    end = move.pose
    if move.keeps_orientation:
        end = end.copy()
        end[:3, :3] = start[:3, :3]
    with np.errstate(over="ignore"):  # a way so long is refused
        found = line(start, end) if move.via is None else arc(start, move.via, end, move.along)
        length = found.length
    if not length <= LONGEST:
        raise BadProgram(f"a way of {length:.3g} m", valid=f"{LONGEST:g} m or less")
    return replace(found, joints_on_path=joints_on_path(arm, move.hold, joints, move.free))


def _joints_after(arm: Arm, way: Stretch, joints: np.ndarray, later: Run) -> np.ndarray:
    """(k,) the joints at the end of a path; those that follow it only where later moves of the run need them."""
    follower = Follower(arm, way, joints)
    free = {joint.name for joint, is_free in zip(arm.joints, follower.free, strict=True) if is_free}
    for one in later:
        if isinstance(one, JointMove) or (isinstance(one, PathMove) and free & {*(one.hold or {})}):
            return follower.positions(np.ones(1))[0]
    return joints + follower.joints_on_path.held[0]


def _cut(arm: Arm, zone: float, before: Way, after: Way) -> tuple[float, float, float]:
    """The radius of a corner zone [m], and what share of either way it takes: at most `SHARE_OF_WAY`.

    Between lines and arcs the radius is the same on both sides; beside joint moves each side is cut alone.

    Raises:
        BadInput: one side is none, or turns on the spot.
    """
    sides = before, after
    for side in sides:
        if is_none(side) or (isinstance(side, Stretch) and side.length < SHORTEST):
            fault = "a corner zone beside a line of no length"
            raise BadProgram(
                fault,
                where="zone",
                valid="write zone: 0, or moves that the tool's point goes along",
            )
    lengths = [_half(side) for side in sides if isinstance(side, Stretch)]
    radius = min(zone, *lengths) if len(lengths) == 2 else zone
    into, out = (
        side.ways[0].share_within(min(radius, _half(side)))
        if isinstance(side, Stretch)
        else side.share_within(arm, radius, at_end)
        for side, at_end in ((before, True), (after, False))
    )
    return radius, min(into, SHARE_OF_WAY), min(out, SHARE_OF_WAY)


def _half(stretch: Stretch) -> float:
    """[m] How far, straight, the middle of a line or an arc is from its ends."""
    middle = stretch.poses(np.array([[SHARE_OF_WAY, 0.0]]))[0]
    return float(np.linalg.norm((middle - stretch.start)[:3, 3]))


def size_of(way: Way) -> float:
    """The length of a way [m]; of a turn on the spot in rad, where joints are held alone in s, and of joints as a
    share of the move."""
    if isinstance(way, JointWay):
        return way.share
    sizes = way.length, way.turned, way.least_time
    return next((one for one in sizes if one >= SHORTEST), 0.0)


def _limits_of(arm: Arm, move: Move, way: Way | None) -> Limits:
    """How fast the whole way of a move may be gone along, and how much faster each second."""
    if way is None or is_none(way):
        return UNLIMITED
    if isinstance(way, JointWay):
        assert isinstance(move, JointMove)
        return limits_of_joint_move(arm.joints, way.whole, move)
    assert isinstance(move, PathMove)
    by_held = size_of(way) / max(way.least_time, 1e-300)
    most, change = np.inf, np.inf
    if way.length >= SHORTEST:
        most = min(move.speed, move.turn_speed * way.length / max(way.turned, 1e-300))
        change = move.acceleration
    elif way.turned >= SHORTEST:
        most, change = move.turn_speed, move.turn_speed / RUN_UP
    found = Limits(min(most, by_held), min(change, by_held / RUN_UP))
    return found if move.time is None else found.lasting(size_of(way), move.time)


def _with_speeds(arm: Arm, run: list[Leg]) -> Iterator[Leg]:
    """Legs that follow one another without a stop, with the pieces of their speed."""
    speeds = _speeds_at_ends(arm, run)
    for leg, first, last in zip(run, speeds, speeds[1:], strict=False):
        if leg.corner is not None:
            rate = first / (2.0 * leg.corner.sizes[0])
            yield replace(leg, pieces=(Piece(1.0 / rate, 0.0, rate, 0.0),))
            continue
        assert leg.way is not None
        if is_none(leg.way):
            if isinstance(leg.way, JointWay):
                yield leg
            continue
        size, (most, change) = size_of(leg.way), leg.limits
        yield replace(
            leg, pieces=tuple(trapezoid(most / size, change / size, first / size, last / size))
        )


def _speeds_at_ends(arm: Arm, run: Sequence[Leg]) -> list[float]:
    """The speed at the beginning of each leg, and at the end of the last, in the sizes of the way there: 0 where
    it stops."""
    most = [0.0] * (len(run) + 1)
    for i, leg in enumerate(run):
        if leg.corner is not None:
            rate = _rate_in_corner(arm, leg.corner)
            most[i], most[i + 1] = 2.0 * rate * leg.corner.sizes
    for i in (*range(len(run)), *reversed(range(len(run)))):
        leg = run[i]
        if leg.corner is not None:
            sizes = leg.corner.sizes
            rate = min(most[i] / sizes[0], most[i + 1] / sizes[1])
            most[i], most[i + 1] = rate * sizes
            continue
        assert leg.way is not None
        if is_none(leg.way):
            most[i] = most[i + 1] = min(most[i], most[i + 1])
            continue
        gained = 2.0 * leg.limits.change * size_of(leg.way)
        most[i + 1] = min(most[i + 1], float(np.sqrt(most[i] ** 2 + gained)))
        most[i] = min(most[i], float(np.sqrt(most[i + 1] ** 2 + gained)))
    return most


def _rate_in_corner(arm: Arm, zone: Corner) -> float:
    """[1/s] How fast a corner is passed: as both sides allow, and so that its bend takes no more than the
    acceleration."""
    before, after = zone.moves
    rates = [
        limits.speed / (2.0 * size_of(side))
        for side, limits in zip(zone.sides, zone.limits, strict=True)
    ]
    if zone.joints is None:
        assert isinstance(before, PathMove) and isinstance(after, PathMove)
        first, second = (side.ways[0] for side in zone.sides if isinstance(side, Stretch))
        turned = second.slopes(np.zeros(1)) - first.slopes(np.ones(1))
        bend = float(np.linalg.norm(turned)) + 2.0 * (first.bend + second.bend)
        acceleration = min(before.acceleration, after.acceleration)
        on_path = (side.joints_on_path for side in zone.sides if isinstance(side, Stretch))
        held = [one.held[0] for one in on_path if one is not None]
        bends = np.abs(held[1] - held[0]) / fastest(arm.joints)
        rates.append(float(np.sqrt(0.5 / RUN_UP / max(float(bends.max()), 1e-12))))
    else:
        ways = [
            _joint_way(arm, side, zone.joints, share)
            for side, share in zip(zone.sides, (1.0, 0.0), strict=True)
        ]
        bend = float((np.abs(ways[1] - ways[0]) / fastest(arm.joints)).max())
        acceleration = 1.0 / RUN_UP
    return float(min(*rates, np.sqrt(acceleration / max(2.0 * bend, 1e-12))))


def _joint_way(arm: Arm, side: Way, joints: np.ndarray, share: float) -> np.ndarray:
    """(k,) about how far the joints go on one side of a corner, from how they go at its share that is the
    corner."""
    if isinstance(side, JointWay):
        return side.share * side.whole
    return Follower(arm, side, joints).rates_at(joints, share)
