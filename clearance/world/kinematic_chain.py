"""The joints between two links of one robot, as one chain from the first to the second."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from clearance.world.mimics import followers, range_of
from clearance.world.robot import Joint, JointKind, Robot


class ChainJoint(NamedTuple):
    """One moving joint of a chain.

    Attributes:
        before: (4, 4) its frame in that of the joint before it, or of the first link [m].
        axis: (3,) unit vector; turned round where the chain goes from a child to its parent.
        turns: it turns; else it slides.
        column: the place of its master among the chain's.
        factor, offset: its position is factor times the master's plus offset.
    """

    before: np.ndarray
    axis: np.ndarray
    turns: bool
    column: int
    factor: float
    offset: float


@dataclass(frozen=True, eq=False)
class KinematicChain:
    """The frames and joints between two links of a robot.

    Attributes:
        joints: in order from the first link to the second.
        end: (4, 4) the second link in the frame of the last joint [m].
        masters: the joints that are free to move; others follow them.
        ranges: (k, 2) from where to where each of these can be [rad or m], all that follow it within their limits.
    """

    joints: tuple[ChainJoint, ...]
    end: np.ndarray
    masters: tuple[Joint, ...]
    ranges: np.ndarray

    @property
    def longest_slides(self) -> float:
        """[m] how far the masters that slide between finite limits can be from their zero, added up."""
        slides = [joint.kind is JointKind.PRISMATIC for joint in self.masters]
        ranges = self.ranges[np.array(slides, dtype=bool)]
        return float(np.abs(ranges[np.isfinite(ranges).all(axis=1)]).sum())

    def frames(self, positions: np.ndarray) -> np.ndarray:
        """(n, joints + 1, 4, 4) poses in the frame of the first link [m]: of each joint, then of the second link.

        Args:
            positions: (n, k) of `masters` [rad or m].
        """
        frames = np.empty((len(positions), len(self.joints) + 1, 4, 4))
        at = np.tile(np.eye(4), (len(positions), 1, 1))
        for i, joint in enumerate(self.joints):
            frames[:, i] = at @ joint.before
            moved = joint.factor * positions[:, joint.column] + joint.offset
            at = frames[:, i] @ _motion(joint, moved)
        frames[:, -1] = at @ self.end
        return frames


def chain_between(robot: Robot, link_a: str, link_b: str) -> KinematicChain:
    """The chain from one link to another of the same robot."""
    above = {joint.child: joint for joint in robot.joints}
    up, down = _ways_to_root(above, link_a), _ways_to_root(above, link_b)
    while up and down and up[-1] is down[-1]:
        up.pop(), down.pop()
    master_of = {one.joint.name: one for one in followers(robot)}
    by_name = {joint.name: joint for joint in robot.joints}
    masters: list[str] = []
    joints: list[ChainJoint] = []
    before = np.eye(4)
    for joint, goes_up in [*((j, True) for j in up), *((j, False) for j in reversed(down))]:
        if not goes_up:
            before = before @ joint.parent_from_joint
        if joint.kind is not JointKind.FIXED:
            follower = master_of[joint.name]
            if follower.master not in masters:
                masters.append(follower.master)
            joints.append(
                ChainJoint(
                    before, -joint.axis if goes_up else joint.axis,
                    joint.kind is not JointKind.PRISMATIC, masters.index(follower.master),
                    follower.factor, follower.offset,
                )
            )  # fmt: skip
            before = np.eye(4)
        if goes_up:
            before = before @ np.linalg.inv(joint.parent_from_joint)
    ranges = np.array([range_of(robot, name) for name in masters]).reshape(-1, 2)
    return KinematicChain(tuple(joints), before, tuple(by_name[name] for name in masters), ranges)


def _ways_to_root(above: dict[str, Joint], link: str) -> list[Joint]:
    """The joints from a link up to the root."""
    found = []
    while link in above:
        found.append(above[link])
        link = above[link].parent
    return found


def _motion(joint: ChainJoint, moved: np.ndarray) -> np.ndarray:
    """(n, 4, 4) the motions of a joint at n positions [rad or m]."""
    poses = np.tile(np.eye(4), (len(moved), 1, 1))
    if not joint.turns:
        poses[:, :3, 3] = moved[:, None] * joint.axis
        return poses
    x, y, z = joint.axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    sin, versine = np.sin(moved)[:, None, None], 2.0 * np.sin(0.5 * moved)[:, None, None] ** 2
    poses[:, :3, :3] += sin * cross + versine * (cross @ cross)
    return poses
