"""Random paths for the benchmark of robot programs: the moves that ask for them, and where the tool is to be.

Poses follow from the drawn targets by the definitions in the guide, in long doubles, with laws of speed of their
own; no code of the package makes them. Not for: figures (`programs`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import ClassVar, NamedTuple

import numpy as np
from program_arms import LONG, ArmFile, OwnArm, Poses, turned

import clearance as cl
from clearance.geometry.quaternions import quaternions_of
from clearance.programs.carriage import Carriage, steps_of_poses
from clearance.programs.motion import motion_of
from clearance.programs.moves import Move, PathMove, Program
from clearance.world.knots import knots_of
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory

TOOL = np.eye(4)
TOOL[:3, 3] = 0.02, -0.01, 0.1

KINDS = ("lin", "circ", "zone")
ZONE, FAST = 0.004, 100.0
"""[m] The radius of corner zones, and [rad/s] a speed of turns that holds nothing back."""


@dataclass(frozen=True, eq=False)
class OwnLeg:
    """A stretch of a path with its own law of speed.

    Attributes:
        start: rotation (3, 3) and origin (3,) at its beginning. ways: (2, 3) [m]. turns: (2, 3) [rad].
        length: [m] of the way. speed, first, last: [m/s] at most, at its beginning and its end.
        circle: centre, radius vector, the same a quarter on, and angle, of an arc. corner: a parabola.
    """

    start: tuple[np.ndarray, np.ndarray]
    ways: np.ndarray
    turns: np.ndarray
    length: float
    speed: float
    first: float = 0.0
    last: float = 0.0
    circle: tuple[np.ndarray, np.ndarray, np.ndarray, float] | None = None
    corner: bool = False

    ACCELERATION: ClassVar[float] = 1.0

    @property
    def parts(self) -> tuple[float, float, float, float]:
        """Peak speed [m/s], and the seconds of speeding, cruising and slowing."""
        a = self.ACCELERATION
        peak = min(self.speed, float(np.sqrt(a * self.length + (self.first**2 + self.last**2) / 2)))
        up, down = (peak - self.first) / a, (peak - self.last) / a
        rest = self.length - (peak + self.first) / 2 * up - (peak + self.last) / 2 * down
        return peak, up, max(rest, 0.0) / peak, down

    @property
    def duration(self) -> float:
        """[s]."""
        return 2 * self.length / self.speed if self.corner else sum(self.parts[1:])

    def shares(self, times: np.ndarray) -> np.ndarray:
        """(...) the share of the way after times [s]."""
        if self.corner:
            return times / LONG(self.duration)
        peak, up, cruise, down = self.parts
        t = [
            np.clip(times - begin, 0, long)
            for begin, long in ((0, up), (up, cruise), (up + cruise, down))
        ]
        a = self.ACCELERATION
        way = t[0] * self.first + a * t[0] ** 2 / 2 + peak * t[1] + peak * t[2] - a * t[2] ** 2 / 2
        return way / LONG(self.length)

    def poses(self, shares: np.ndarray) -> Poses:
        """The poses (...) at shares of the way."""
        s = np.asarray(shares, dtype=LONG).reshape(-1)
        first, second = (2 * s - s * s, s * s) if self.corner else (s, 0 * s)
        return self.poses_at(first, second, first, second, np.shape(shares))

    def poses_at(
        self,
        a: np.ndarray,
        b: np.ndarray,
        turn_a: np.ndarray,
        turn_b: np.ndarray,
        shape: Sequence[int],
    ) -> Poses:
        """The poses with the point at strokes a, b and the rotation at others, each (n,)."""
        turn = turned(turn_b[:, None] * self.turns[1]) @ turned(turn_a[:, None] * self.turns[0])
        turn = turn @ self.start[0]
        if self.circle is None:
            origin = self.start[1] + a[:, None] * self.ways[0] + b[:, None] * self.ways[1]
        else:
            centre, radius, quarter, angle = self.circle
            at = (angle * a)[:, None]
            origin = centre + np.cos(at) * radius + np.sin(at) * quarter
        return Poses(turn.reshape(*shape, 3, 3), origin.reshape(*shape, 3))


class Plate(NamedTuple):
    """A plate that turns while the tool works on it: rotation and origin of its joint [m], its axis (3,), where it
    begins and how far it goes with the leg [rad]."""

    turn: np.ndarray
    origin: np.ndarray
    axis: np.ndarray
    first: float
    by: float

    @classmethod
    def drawn(cls, draw: np.random.Generator) -> Plate:
        """One near an arm."""
        axis = draw.uniform(-0.4, 0.4, 3).astype(LONG) + np.array([0, 0, 1], dtype=LONG)
        turn, origin = turned(draw.uniform(-0.3, 0.3, (1, 3)))[0], draw.uniform(-0.3, 0.3, 3)
        axis = axis / np.sqrt((axis**2).sum())
        return cls(turn, origin.astype(LONG), axis, *draw.uniform(-0.5, 0.5, 2))

    def joint(self, root: str) -> Joint:
        """Its joint, which holds nothing back."""
        at, axis = matrix((self.turn, self.origin)), self.axis.astype(float)
        return Joint("plate", JointKind.CONTINUOUS, root, "plate", at, axis, velocity=FAST)

    def seen(self, pose: Pose) -> Pose:
        """A pose seen from it where it begins."""
        turn = self.turn @ turned(self.axis[None] * self.first)[0]
        return turn.T @ pose[0], turn.T @ (pose[1] - self.origin)

    def followed(
        self, robot: Robot, link: str, move: PathMove, joints: dict[str, float]
    ) -> Trajectory:
        """What a move on it makes of a robot whose program turns it meanwhile."""
        root, move = robot.link_names[0], replace(move, seen_from="plate")
        beside = replace(
            robot,
            link_names=(*robot.link_names, "plate"),
            joints=(*robot.joints, self.joint(root)),
        )
        move = replace(move, hold={"plate": self.first + self.by})
        program = Program(link, TOOL, (move,), {**joints, "plate": self.first})
        return motion_of(beside, program).trajectory

    def carried(self, poses: Poses, shares: np.ndarray, _: np.ndarray) -> Poses:
        """Poses (m, n) on it at shares of the leg, seen from the root."""
        angles = (self.first + self.by * shares).reshape(-1, 1)
        turn = self.turn @ turned(self.axis * angles).reshape(*shares.shape, 3, 3)
        return Poses(turn @ poses.turn, self.origin + (turn @ poses.origin[..., None])[..., 0])


class Belt(NamedTuple):
    """A conveyor that changes its way at once: times (m,) [s], places (m, 3) [m], and the vectors (m - 1, 3) [rad]
    by which it turns from one time to the next."""

    times: np.ndarray
    places: np.ndarray
    vectors: np.ndarray

    @classmethod
    def drawn(cls, draw: np.random.Generator) -> Belt:
        """One near an arm."""
        times = np.array([-0.5, *np.sort(draw.uniform(0.0, 0.8, 4)), 2.0])
        places = np.cumsum(draw.uniform(-0.03, 0.03, (6, 3)), axis=0)
        vectors = draw.uniform(-0.1, 0.1, (5, 3))
        return cls(times.astype(LONG), places.astype(LONG), vectors.astype(LONG))

    def at(self, i: int, times: np.ndarray) -> Poses:
        """Its poses at times (...) [s] between two of its own."""
        share = ((times - self.times[i]) / (self.times[i + 1] - self.times[i])).reshape(-1, 1)
        turn = np.eye(3, dtype=LONG)
        for vector in self.vectors[:i]:
            turn = turn @ turned(vector[None])[0]
        origin = self.places[i] + share * (self.places[i + 1] - self.places[i])
        turn = turn @ turned(share * self.vectors[i])
        return Poses(turn.reshape(*times.shape, 3, 3), origin.reshape(*times.shape, 3))

    def seen(self, pose: Pose) -> Pose:
        """A pose seen from it at 0 s."""
        (turn,), (origin,) = self.at(0, np.zeros(1, dtype=LONG))
        return turn.T @ pose[0], turn.T @ (pose[1] - origin)

    def followed(
        self, robot: Robot, link: str, move: PathMove, joints: dict[str, float]
    ) -> Trajectory:
        """What a move on it makes of a robot."""
        turns = np.array([self.at(i, one).turn for i, one in enumerate(self.times[:-1])])
        turns = np.concatenate([turns, self.at(len(turns) - 1, self.times[-1]).turn[None]])
        poses = np.hstack([self.places, quaternions_of(turns.astype(float))]).astype(float)
        knots = knots_of(self.times.astype(float), poses, n_rotation=4)
        carriages = {"belt": Carriage("belt", tuple(steps_of_poses(knots)))}
        move = replace(move, seen_from="belt")
        return motion_of(
            robot, Program(link, TOOL, (move,), joints, carriages=carriages)
        ).trajectory

    def carried(self, poses: Poses, _: np.ndarray, times: np.ndarray) -> Poses:
        """Poses (m, n) on it at times (m, n) [s], each row between two of its own, seen from the root."""
        which = np.searchsorted(self.times, times[:, times.shape[1] // 2]) - 1
        turn, origin = np.empty_like(poses.turn), np.empty_like(poses.origin)
        for i in np.unique(which):
            rows = which == i
            own = self.at(i, times[rows])
            turn[rows] = own.turn @ poses.turn[rows]
            origin[rows] = own.origin + (own.turn @ poses.origin[rows][..., None])[..., 0]
        return Poses(turn, origin)


@dataclass(frozen=True, eq=False)
class Motion:
    """A random motion of an arm, and what its path is by its own definition, on a carrier if there is one."""

    own: OwnArm
    trajectory: Trajectory
    legs: tuple[OwnLeg, ...]
    carrier: Plate | Belt | None = None

    @property
    def starts(self) -> np.ndarray:
        """[s] of each leg."""
        return np.cumsum([0.0, *(leg.duration for leg in self.legs)])

    def poses(self, times: np.ndarray) -> Poses:
        """The tool's poses at times (m, n) [s], each row within one leg."""
        middle = times[:, times.shape[1] // 2].astype(float)
        which = np.searchsorted(self.starts[1:-1], middle)
        turn = np.empty((*times.shape, 3, 3), dtype=LONG)
        origin = np.empty((*times.shape, 3), dtype=LONG)
        for i in np.unique(which):
            leg, rows = self.legs[i], which == i
            shares = leg.shares(times[rows] - self.starts[i])
            poses = leg.poses(shares)
            turn[rows], origin[rows] = (
                poses if self.carrier is None else self.carrier.carried(poses, shares, times[rows])
            )
        return Poses(turn, origin)


def random_motions(
    file: ArmFile, n: int, carriers: type[Plate] | type[Belt] | None = None
) -> Iterator[Motion]:
    """Random lines, arcs, and lines with a corner zone between, in turns, that the arm can follow; on plates or
    belts that move meanwhile no zones.
    """
    draw, found = np.random.default_rng(0 if carriers is None else 1), 0
    robot, own = cl.load_robot(file.path), OwnArm.read(file.path, file.link, TOOL)
    kinds = KINDS if carriers is None else KINDS[:2]
    while found < n:
        start = np.array(file.posture)[: len(own.joints)] + draw.uniform(-0.2, 0.2, len(own.joints))
        (turn,), (origin,) = own.poses(start[None].astype(LONG))
        carrier = None if carriers is None else carriers.drawn(draw)
        begin = (turn, origin) if carrier is None else carrier.seen((turn, origin))
        legs, moves = drawn(kinds[found % len(kinds)], begin, draw)
        joints = {joint.name: float(at) for joint, at in zip(own.joints, start, strict=True)}
        try:
            if carrier is None:
                made = motion_of(robot, Program(file.link, TOOL, moves, joints)).trajectory
            else:
                made = carrier.followed(robot, file.link, moves[0], joints)
        except cl.ClearanceError:
            continue
        found += 1
        columns = [made.joint_names.index(joint.name) for joint in own.joints]
        yield Motion(own, made.of_columns(columns), with_corner(legs, made), carrier)


Pose = tuple[np.ndarray, np.ndarray]


def drawn(
    kind: str, start: Pose, draw: np.random.Generator
) -> tuple[tuple[OwnLeg, ...], tuple[Move, ...]]:
    """The legs of a random path, and the moves that ask for it."""
    turn = draw.uniform(-0.3, 0.3, 3).astype(LONG)
    if kind == "circ":
        return drawn_arc(start, turn, draw)
    legs: list[OwnLeg] = []
    for _ in range(2 if kind == "zone" else 1):
        way = draw.uniform(-0.12, 0.12, 3).astype(LONG)
        ways, turns = np.array([way, 0 * way]), np.array([turn / (1 + len(legs)), 0 * turn])
        legs.append(OwnLeg(start, ways, turns, float(np.sqrt((way**2).sum())), 0.25))
        start = end_of(legs[-1])
    zones = [ZONE if i + 1 < len(legs) else 0.0 for i in range(len(legs))]
    moves = tuple(
        PathMove(f"LIN {i}", f"moves[{i}]", matrix(end_of(leg)), zone=zone, turn_speed=FAST)
        for i, (leg, zone) in enumerate(zip(legs, zones, strict=True))
    )
    return tuple(legs), moves


def drawn_arc(
    start: Pose, turn: np.ndarray, draw: np.random.Generator
) -> tuple[tuple[OwnLeg, ...], tuple[Move, ...]]:
    """An arc of up to 3 rad about a random axis; half of them hold the tool to the path."""
    axis, away = np.linalg.qr(draw.normal(size=(3, 2)))[0].T.astype(LONG)
    radius, angle, along = draw.uniform(0.02, 0.1), draw.uniform(0.5, 3.0), draw.random() < 0.5
    circle = start[1] - radius * away, radius * away, radius * np.cross(axis, away), angle
    turns = np.array([axis * angle if along else turn, 0 * turn])
    leg = OwnLeg(start, np.zeros((2, 3)), turns, radius * angle, 0.25, circle=circle)
    via = leg.poses(np.array([0.5])).origin[0].astype(float)
    move = PathMove("CIRC", "moves[0]", matrix(end_of(leg)), via=via, along=along, turn_speed=FAST)
    return (leg,), (move,)


def end_of(leg: OwnLeg) -> Pose:
    """Where a leg ends."""
    turn, origin = leg.poses(np.ones(1))
    return turn[0], origin[0]


def matrix(pose: Pose) -> np.ndarray:
    """(4, 4) a pose in doubles."""
    found = np.eye(4)
    found[:3, :3], found[:3, 3] = pose
    return found


def with_corner(legs: tuple[OwnLeg, ...], made: Trajectory) -> tuple[OwnLeg, ...]:
    """The legs as they are driven: cut where the corner begins and ends, passed as quickly as it is."""
    if len(legs) == 1:
        return legs
    (corner,), (before, after) = made.corners, legs
    speed = 2.0 * corner.radius / (corner.end - corner.start)
    into, out = corner.radius / before.length, corner.radius / after.length
    first = part_of(before, 0.0, 1.0 - into)
    ways = np.array([into * before.ways[0], out * after.ways[0]])
    turns = np.array([into * before.turns[0], out * after.turns[0]])
    middle = OwnLeg(end_of(first), ways, turns, corner.radius, speed, corner=True)
    return replace(first, last=speed), middle, replace(part_of(after, out, 1.0), first=speed)


def part_of(leg: OwnLeg, begin: float, end: float) -> OwnLeg:
    """A part of a line, by shares of it."""
    turn, origin = leg.poses(np.array([begin]))
    share = end - begin
    return replace(
        leg, start=(turn[0], origin[0]), ways=share * leg.ways, turns=share * leg.turns,
        length=share * leg.length,
    )  # fmt: skip
