"""A program's motion: samples of joints and their velocities, and how far joints are off the cubics between,
proven.

Straight lines and arcs of the tool are sampled so finely that every joint is within `PATH_ERROR` of its cubic.
Between two moves without a corner zone the tool stops. Not for: files, and what corner zones take of clearances
(`corner`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from clearance.errors import (
    BadDimension,
    BadInput,
    BadProgram,
    UnknownJoint,
    UnknownLink,
    at,
    nearest_name,
)
from clearance.programs.arm import Arm
from clearance.programs.corner import PATH_ERROR, corner_of
from clearance.programs.following import Follower
from clearance.programs.inverse import nearest_joints
from clearance.programs.legs import Leg, legs_of, targets_of
from clearance.programs.moves import STEP_TURN, JointMove, PathMove, Program, Wait
from clearance.programs.path_samples import PathSamples
from clearance.programs.time_law import trapezoid
from clearance.world.corner_zone import CornerZone
from clearance.world.robot import Joint, Robot
from clearance.world.trajectory import MoveSpan, Trajectory

MOST_HALVINGS = 8
"""Times that intervals are halved until that is proven."""

SAME_SPEED = 1e-5
"""[rad/s] or [m/s]: speeds of a joint that differ by less differ by rounding."""

MOST_SAMPLES = 1_000_000
"""Most samples of a program: a step in the wrong unit needs more."""

RUN_UP = 0.25
"""[s] In which a joint reaches its greatest speed, where nothing else is known."""

USUAL_SPEED = 1.0
"""[rad/s] or [m/s]: the greatest speed of a joint of which no file says it."""


@dataclass(frozen=True, eq=False)
class ProgramMotion:
    """What a program makes a robot do.

    Attributes:
        trajectory: samples with velocities; its `path_error` holds for lines and arcs.
        notes: what was assumed, one line each.
    """

    trajectory: Trajectory
    notes: tuple[str, ...] = ()


def motion_of(robot: Robot, program: Program) -> ProgramMotion:
    """The motion of a program.

    Raises:
        BadInput: a target that cannot be reached, a joint beyond its limits, a singularity on the way: with the
            move, where the tool is, and the joints. UnknownLink, UnknownJoint: with the nearest name.
    """
    if program.link not in robot.link_names:
        valid = nearest_name(program.link, robot.link_names)
        raise UnknownLink(f"there is no link {program.link!r}", where="tool.link", valid=valid)
    if not 1e-5 <= program.step <= 1.0:
        raise BadDimension(f"a step of {program.step * 1e3:g} mm", valid="0.01 to 1000 mm")
    arm = Arm(robot, program.link, program.link_from_tool)
    samples = _Samples(arm, program, _start_of(robot, arm, program))
    for leg in legs_of(arm, program, samples.at):
        with at(leg.move.where):
            samples.add(leg)
    return samples.motion()


def _start_of(robot: Robot, arm: Arm, program: Program) -> np.ndarray:
    """(k,) where the joints of the arm are at first."""
    names = [joint.name for joint in robot.moving_joints]
    for name in program.start:
        if name not in names:
            valid = nearest_name(name, names)
            raise UnknownJoint(f"unknown joint {name!r}", where="start", valid=valid)
    missing = [joint.name for joint in arm.joints if joint.name not in program.start]
    if missing:
        raise BadProgram(
            f"no position of {', '.join(missing)}",
            where="start",
            valid="one for each joint of the arm",
        )
    return np.array([program.start[joint.name] for joint in arm.joints])


@dataclass(eq=False)
class _Samples:
    """The samples of legs, one after another.

    Attributes:
        at: (k,) where the joints are. now: [s]. error: [rad or m] the greatest proven deviation on lines and arcs.
    """

    arm: Arm
    program: Program
    at: np.ndarray
    now: float = 0.0
    error: float = 0.0
    times: list[np.ndarray] = field(default_factory=list)
    positions: list[np.ndarray] = field(default_factory=list)
    velocities: list[np.ndarray] = field(default_factory=list)
    spans: list[MoveSpan] = field(default_factory=list)
    corners: list[CornerZone] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.times.append(np.zeros(1))
        self.positions.append(self.at[None])
        self.velocities.append(np.zeros((1, len(self.at))))

    def add(self, leg: Leg) -> None:
        """Samples what a leg makes of the joints."""
        began = self.now
        if isinstance(leg.move, Wait):
            self._stand(leg.move.seconds)
        elif isinstance(leg.move, JointMove):
            self._straight(leg.move)
        else:
            self._along(leg, leg.move)
        self._require_limits()
        if self.spans and self.spans[-1].name == leg.move.name:
            self.spans[-1] = replace(self.spans[-1], end=self.now)
        else:
            self.spans.append(MoveSpan(leg.move.name, began, self.now))

    def motion(self) -> ProgramMotion:
        """All of them, joints that are not of the arm at rest."""
        own = [joint.name for joint in self.arm.joints]
        others = [name for name in self.program.start if name not in own]
        positions = np.concatenate(self.positions)
        rest = np.tile(np.array([self.program.start[name] for name in others]), (len(positions), 1))
        trajectory = Trajectory(
            times=np.concatenate(self.times),
            joint_names=(*own, *others),
            positions=np.hstack([positions, rest]),
            velocities=np.hstack([np.concatenate(self.velocities), np.zeros_like(rest)]),
            path_error=self.error,
            corners=tuple(self.corners),
            moves=tuple(self.spans),
        )
        return ProgramMotion(trajectory, tuple(self.notes))

    def _stand(self, seconds: float) -> None:
        self._append(np.array([seconds]), self.at[None], np.zeros((1, len(self.at))))

    def _straight(self, move: JointMove) -> None:
        """All joints in proportion; exact, since a cubic holds what a constant acceleration makes of them."""
        target = self._target(move)
        way = target - self.at
        if not way.any():
            return
        start, rate, change = self.at, *_joint_law(self.arm.joints, way, move.speed)
        for piece in trapezoid(rate, change):
            moved = piece.at(np.linspace(0.0, piece.duration, 33))[:, None] * way
            n = self._n_samples(self.arm.poses(start + moved))
            times = np.linspace(0.0, piece.duration, n + 1)[1:]
            positions = start + piece.at(times)[:, None] * way
            self._append(times, positions, piece.rates_at(times)[:, None] * way)
        self._stop_at(target)

    def _target(self, move: JointMove) -> np.ndarray:
        """(k,) where a joint move ends."""
        if move.pose is None:
            return targets_of(self.arm, move)
        near, ranges = self.at.copy(), self.arm.chain.ranges.copy()
        for name, value in move.near.items():
            near[self._column(name, "near")] = value
        for name, (low, high) in move.within.items():
            row = ranges[self._column(name, "within")]
            row[:] = max(low, row[0]), min(high, row[1])
            if row[0] > row[1]:
                told = f"joint {name!r} cannot be from {low:.4g} to {high:.4g}"
                raise BadProgram(told, where="within", valid="a range within its limits")
        found = nearest_joints(self.arm, move.pose, near, ranges)
        told = ", ".join(
            f"{joint.name} {value:.4g}" for joint, value in zip(self.arm.joints, found, strict=True)
        )
        self.notes.append(
            f"{move.name}: of the joints that reach its pose the nearest are taken: {told}"
        )
        return found

    def _along(self, leg: Leg, move: PathMove) -> None:
        """What the tool's path makes of the joints."""
        follower = self._follower(leg, move)
        for n_halved in range(MOST_HALVINGS + 1):
            samples = PathSamples.of(follower, self.at, leg.pieces, self.program.step / 2**n_halved)
            off = float(samples.deviations.max(initial=0.0)) + self._seam(samples)
            if off <= PATH_ERROR:
                break
        else:
            raise _unproven(samples, self.arm)
        self.error = max(self.error, off)
        if leg.radius:
            corner = corner_of(follower, samples, self.now, leg.radius, move.name)
            self.corners.append(corner)
            self.notes.append(_note_on(corner, move.zone))
        self._append(samples.times[1:], samples.positions[1:], samples.velocities[1:])
        self.at = samples.positions[-1]

    def _seam(self, samples: PathSamples) -> float:
        """[rad or m] How far the first cubic is off that of the samples, as it begins like what was before.

        Raises:
            BadInput: joints would change their speed at once, since moves that a zone joins hold others.
        """
        rates = np.abs(samples.velocities[0] - self.velocities[-1][-1]).max()
        if rates > SAME_SPEED:
            raise BadProgram(
                "a joint changes its speed at once where a corner zone begins or ends",
                where="hold",
                valid="the same joints held on both sides of a zone, where they are",
            )
        return float(np.abs(samples.positions[0] - self.at).max() + samples.times[1] * rates)

    def _follower(self, leg: Leg, move: PathMove) -> Follower:
        """The arm on a leg's path, joints that the move tells left out of it."""
        assert leg.stretch is not None
        n = len(self.arm.joints)
        free, held = np.ones(n, dtype=bool), np.zeros(n)
        for name, value in (move.hold or {}).items():
            column = self._column(name, "hold")
            free[column], held[column] = False, value - self.at[column]
        if free.sum() < 6:
            raise BadProgram(
                f"{int(free.sum())} joints are free to follow the tool's path",
                valid="six or more; an arm of fewer goes by joint moves",
            )
        return Follower(self.arm, leg.stretch, free, held)

    def _column(self, name: str, where: str) -> int:
        """The column of a joint.

        Raises:
            UnknownJoint: it is none of the arm.
        """
        names = [joint.name for joint in self.arm.joints]
        if name not in names:
            valid = nearest_name(name, names)
            raise UnknownJoint(f"unknown joint {name!r}", where=where, valid=valid)
        return names.index(name)

    def _n_samples(self, poses: np.ndarray) -> int:
        """How many samples a motion through poses needs where it is quickest."""
        n = len(poses) - 1
        ways = n * np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1).max()
        turned = np.swapaxes(poses[:-1, :3, :3], 1, 2) @ poses[1:, :3, :3]
        cosines = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1.0)
        turns = n * np.arccos(np.clip(cosines, -1.0, 1.0)).max()
        return max(1, int(np.ceil(ways / self.program.step)), int(np.ceil(turns / STEP_TURN)))

    def _append(self, times: np.ndarray, positions: np.ndarray, velocities: np.ndarray) -> None:
        """Adds samples that begin after now."""
        self.times.append(self.now + times)
        self.positions.append(positions)
        self.velocities.append(velocities)
        self.now += float(times[-1])
        if sum(map(len, self.times)) > MOST_SAMPLES:
            raise BadDimension(
                f"more than {MOST_SAMPLES:,} samples", where="step", valid="a larger step"
            )

    def _stop_at(self, target: np.ndarray) -> None:
        """Makes the last sample what a move's end is, without rounding."""
        self.at = target
        self.positions[-1][-1], self.velocities[-1][-1] = target, 0.0

    def _require_limits(self) -> None:
        """Nothing, if the samples added last are within the limits of the joints.

        Raises:
            BadInput: the first that is not, with the joint and where the tool is then.
        """
        ranges, last = self.arm.chain.ranges, self.positions[-1]
        beyond = np.maximum(ranges[:, 0] - last, last - ranges[:, 1]).max(axis=0)
        joint = int(np.argmax(beyond))
        if beyond[joint] > 0.0:
            row = int(
                np.argmax(
                    np.maximum(ranges[joint, 0] - last[:, joint], last[:, joint] - ranges[joint, 1])
                    > 0.0
                )
            )
            x, y, z = self.arm.poses(last[row : row + 1])[0, :3, 3]
            raise BadProgram(
                f"joint {self.arm.joints[joint].name!r} is beyond its limit at ({x:.4g}, {y:.4g}, {z:.4g}) m",
                valid=f"{ranges[joint, 0]:.4g} to {ranges[joint, 1]:.4g}",
            )


def _joint_law(joints: Sequence[Joint], way: np.ndarray, speed: float) -> tuple[float, float]:
    """[1/s] and [1/s^2] The rate of a joint move, and its change: no joint is faster than it may be."""
    limits = np.array(
        [
            one.velocity if np.isfinite(one.velocity) and one.velocity > 0.0 else USUAL_SPEED
            for one in joints
        ]
    )
    rate = float(speed * (limits[way != 0.0] / np.abs(way[way != 0.0])).min())
    return rate, rate / (speed * RUN_UP)


def _unproven(samples: PathSamples, arm: Arm) -> BadInput:
    """Where nothing is proven of the joints between samples."""
    bad = int(np.argmax(samples.deviations.max(axis=1)))
    x, y, z = arm.poses(samples.positions[bad : bad + 1])[0, :3, 3]
    return BadProgram(
        f"the motion near ({x:.4g}, {y:.4g}, {z:.4g}) m is not proven: a singularity is too near",
        valid="another start configuration, or a joint move there",
    )


def _note_on(corner: CornerZone, asked: float) -> str:
    """What a corner zone is taken to admit, whose program asks for a radius [m]."""
    most = max(off.way for off in corner.links.values())
    cut = (
        ""
        if corner.radius == asked
        else f" (cut from {asked * 1e3:.4g} mm: at most half of a line)"
    )
    size, when = f"{corner.radius * 1e3:.4g} mm{cut}", f"{corner.start:.3f} to {corner.end:.3f} s"
    return (
        f"corner zone of {size} after {corner.name}, {when}: all paths of the tool in its triangle count; "
        f"links are up to {most * 1e3:.3g} mm off the parabola"
    )
