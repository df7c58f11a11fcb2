"""How joints go in a joint move: straight, all in proportion, no faster than they may. Not for: lines of a tool
(`tool_path`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain, product

import numpy as np

from clearance.errors import BadProgram
from clearance.programs.arm import Arm
from clearance.programs.inverse import ANOTHER, nearest_joints, range_of
from clearance.programs.moves import SHARE_OF_WAY, JointMove, Program
from clearance.programs.time_law import Limits
from clearance.world.kinematic_chain import chain_between
from clearance.world.robot import Joint, Robot

RUN_UP = 0.25
"""[s] In which a joint, or a tool that turns on the spot, reaches its greatest speed, where nothing else is
known."""

USUAL_SPEED = 1.0
"""[rad/s] or [m/s]: the greatest speed of a joint of which no file says it."""


@dataclass(frozen=True, eq=False)
class JointWay:
    """A joint move, or a part of one.

    Attributes:
        start, target: (k,) where the joints are before and after the whole move [rad or m].
        first, last: the shares of it between which the part is.
    """

    start: np.ndarray
    target: np.ndarray
    first: float = 0.0
    last: float = 1.0

    @classmethod
    def of(cls, arm: Arm, move: JointMove, start: np.ndarray) -> JointWay:
        """A move from where the joints are; to a pose by the joints for it that are nearest to what it says.

        Raises:
            BadProgram: no joints within their ranges. UnknownJoint: none of the arm.
        """
        if move.pose is None:
            return cls(start, targets_of(arm, move, start))
        near = start.copy()
        for name, value in move.near.items():
            near[arm.column(name, "near")] = value
        stays = ~arm.follows
        stays[len(arm.own) :] = True
        found, faults = [], []
        for ranges in _ranges_of(arm, move):
            ranges[stays] = np.clip(near, *ranges.T)[stays, None]
            try:
                found.append(nearest_joints(arm, move.pose, near, ranges))
            except BadProgram as fault:
                faults.append(fault)
        if not found:
            raise faults[0]
        return cls(start, min(found, key=lambda one: np.abs(one - near).max()))

    @property
    def whole(self) -> np.ndarray:
        """(k,) how far the joints go in the whole move."""
        return np.asarray(self.target - self.start)

    @property
    def share(self) -> float:
        """How much of the move it is."""
        return self.last - self.first

    def part(self, first: float, last: float) -> JointWay:
        """From one share of the whole move to another."""
        return replace(self, first=first, last=last)

    def joints(self, shares: np.ndarray) -> np.ndarray:
        """(n, k) at shares (n,) of this part."""
        found = self.start + (self.first + self.share * shares)[:, None] * self.whole
        if self.last == 1.0:
            found[shares == 1.0] = self.target
        return np.asarray(found)

    def share_within(self, arm: Arm, distance: float, at_end: bool) -> float:
        """The share from one end to where the tool's point is last so far from there [m]; `SHARE_OF_WAY` at most.

        Exactness: no less than that, and by less than a hundred-thousandth of the move more, if the point does
            not come back within 1/512 of the move.
        """
        low, high = 0.0, SHARE_OF_WAY
        for _ in range(2):
            shares = np.linspace(low, high, 257)
            points = arm.poses(self.joints(1.0 - shares if at_end else shares))[:, :3, 3]
            corner = arm.poses(self.joints(np.array([1.0 if at_end else 0.0])))[0, :3, 3]
            near = np.flatnonzero(np.linalg.norm(points - corner, axis=1) <= distance)
            last = near[-1] if len(near) else 0
            if last == len(shares) - 1:
                break
            low, high = shares[last], shares[last + 1]
        return float(high)


def _ranges_of(arm: Arm, move: JointMove) -> Iterator[np.ndarray]:
    """(k, 2) where joints for the pose of a move may be, for each choice of the ranges that it gives.

    Raises:
        BadProgram: none of those of a joint reaches into its limits.
    """
    choices: dict[int, list[tuple[float, float]]] = {}
    for name, given in move.within.items():
        column = arm.column(name, "within")
        joint, (least, most) = arm.joints[column], arm.ranges[column].tolist()
        asked = np.reshape(given, (-1, 2)).tolist()
        inside = [(max(low, least), min(high, most)) for low, high in asked]
        choices[column] = [(low, high) for low, high in inside if low <= high]
        if not choices[column]:
            outside = (
                f"{range_of(joint, *asked[0])}, beyond its limits: {range_of(joint, least, most)}"
            )
            raise BadProgram(f"the configuration of the target asks for {outside}", valid=ANOTHER)
    for chosen in product(*choices.values()):
        ranges = arm.ranges.copy()
        for column, row in zip(choices, chosen, strict=True):
            ranges[column] = row
        yield ranges


def targets_of(arm: Arm, move: JointMove, start: np.ndarray) -> np.ndarray:
    """(k,) the joints that a move names; those beside the arm that it does not name stay where they are (k,).

    Raises:
        BadInput: not each joint of the arm, or another.
    """
    found, given = start.copy(), move.joints or {}
    for name, value in given.items():
        found[arm.column(name, "joints")] = value
    missing = [joint.name for joint in arm.own if joint.name not in given]
    if missing:
        fault = f"no target of {', '.join(missing)}"
        raise BadProgram(fault, where="joints", valid="one for each joint of the arm")
    return found


def unknown_speeds(robot: Robot, program: Program) -> list[str]:
    """The joints that joint moves take at a share of their greatest speed, which no file says."""
    moves = [one for one in program.moves if isinstance(one, JointMove)]
    by_share = [one for one in moves if one.time is None and one.leading is None]
    arm = chain_between(robot, robot.link_names[0], program.link).masters
    names = {joint.name for joint in arm if by_share} | {
        *chain.from_iterable(one.joints or () for one in by_share)
    }
    known = {joint.name for joint in robot.joints if 0.0 < joint.velocity < np.inf}
    return [joint.name for joint in robot.joints if joint.name in names - known]


NO_WAY = 1e-12
"""[rad] or [m] A shorter way takes no time that matters."""


def fastest(joints: Sequence[Joint]) -> np.ndarray:
    """(k,) [rad/s] or [m/s] the greatest speeds of joints."""
    known = [one.velocity if np.isfinite(one.velocity) else 0.0 for one in joints]
    return np.array([one if one > 0.0 else USUAL_SPEED for one in known])


def joint_law(joints: Sequence[Joint], way: np.ndarray, speed: float) -> Limits:
    """[1/s] and [1/s^2] The rate of a joint move, and its change: no joint is faster than it may be."""
    ways = np.maximum(np.abs(way), NO_WAY)
    rate = float(speed * (fastest(joints) / ways).min())
    return Limits(rate, rate / (speed * RUN_UP))


def limits_of_joint_move(joints: Sequence[Joint], way: np.ndarray, move: JointMove) -> Limits:
    """[1/s] and [1/s^2] The rate of a joint move that goes so far (k,), and its change."""
    found = joint_law(joints, way, move.speed)
    if move.leading is not None:
        farthest = max(float(np.abs(way).max()), NO_WAY)
        found = Limits(move.leading.speed / farthest, move.leading.change / farthest)
    return found if move.time is None else found.lasting(1.0, move.time)
