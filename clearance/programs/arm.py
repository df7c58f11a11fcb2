"""The arm of a program: how the pose of a tool follows from joints, as numbers and as power series.

Poses are seen from a link of the robot, its root or one that moves too. Not for: which poses a program asks for
(`tool_path`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.errors import UnknownJoint, nearest_name
from clearance.programs.series import ORDER, matrix_product, product, turns_about
from clearance.world.kinematic_chain import KinematicChain, chain_between
from clearance.world.mimics import range_of
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, Robot
from clearance.world.tool import Tool


@dataclass(frozen=True, eq=False)
class Arm:
    """The joints of a program, and its tool.

    Attributes:
        link: the tool is fixed to. link_from_tool: (4, 4) [m].
        beside: names of joints that the program moves, and that are not between the root and the link.
        seen_from: the link that poses are seen from; the root if empty.
    """

    robot: Robot
    link: str
    link_from_tool: np.ndarray
    beside: tuple[str, ...] = ()
    seen_from: str = ""

    @cached_property
    def own(self) -> tuple[Joint, ...]:
        """The joints from the root to the tool's link that are free to move."""
        return chain_between(self.robot, self.robot.link_names[0], self.link).masters

    @cached_property
    def joints(self) -> tuple[Joint, ...]:
        """The k joints that the program moves, in the order of the columns of positions."""
        beside = (joint for joint in self.robot.moving_joints if joint.name in self.beside)
        return (*self.own, *beside)

    @cached_property
    def ranges(self) -> np.ndarray:
        """(k, 2) from where to where each of them can be [rad or m]."""
        return np.array([range_of(self.robot, joint.name) for joint in self.joints]).reshape(-1, 2)

    @cached_property
    def chain(self) -> KinematicChain:
        """From the link that poses are seen from to the tool's; columns are those of `joints`."""
        start = self.seen_from or self.robot.link_names[0]
        found = chain_between(self.robot, start, self.link)
        columns = [self.joints.index(joint) for joint in found.masters]
        joints = tuple(one._replace(column=columns[one.column]) for one in found.joints)
        return replace(found, joints=joints, masters=self.joints, ranges=self.ranges)

    @cached_property
    def follows(self) -> np.ndarray:
        """(k,) which joints move the tool as it is seen."""
        found = np.zeros(len(self.joints), dtype=bool)
        found[[one.column for one in self.chain.joints]] = True
        return found

    def column(self, name: str, where: str) -> int:
        """The column of a joint.

        Raises:
            UnknownJoint: it is none of the arm; with the field.
        """
        names = [joint.name for joint in self.joints]
        if name not in names:
            valid = nearest_name(name, names)
            raise UnknownJoint(f"unknown joint {name!r}", where=where, valid=valid)
        return names.index(name)

    @cached_property
    def end(self) -> np.ndarray:
        """(4, 4) the tool in the frame of the last joint [m]."""
        return np.asarray(self.chain.end @ self.link_from_tool)

    def longest(self, positions: np.ndarray) -> float:
        """[m] no point of the chain is farther from a joint's axis, with slides as far out as in positions (n,
        k)."""
        fixed = sum(float(np.linalg.norm(one.before[:3, 3])) for one in self.chain.joints)
        slid = sum(
            float(np.abs(one.factor * positions[:, one.column] + one.offset).max(initial=0.0))
            for one in self.chain.joints
            if not one.turns
        )
        return fixed + float(np.linalg.norm(self.end[:3, 3])) + slid

    @cached_property
    def tool(self) -> Tool:
        """The tool by the joints of the arm."""
        names = tuple(joint.name for joint in self.joints)
        links = self.robot.link_names
        link, reference = links.index(self.link), links.index(self.seen_from or links[0])
        return Tool(PlacedRobot(self.robot), link, names, self.link_from_tool, reference)

    def poses(self, positions: np.ndarray) -> np.ndarray:
        """(n, 4, 4) the tool [m] at positions (n, k) [rad or m]."""
        return self.tool.poses(positions)

    def place(self, pose: np.ndarray) -> str:
        """Where a pose (4, 4) of the tool is, in words."""
        x, y, z = pose[:3, 3]
        seen = f", seen from {self.seen_from!r}" if self.seen_from else ""
        return f"({x:.4g}, {y:.4g}, {z:.4g}) m{seen}"

    def second_rates(self, positions: np.ndarray, seen_from: np.ndarray) -> np.ndarray:
        """(n, 6, k, k) how each column of the Jacobian changes by each joint: turns seen from the tool.

        Args:
            seen_from: (n, 3, 3) axes of the tool's path, which are all but the tool's.

        Of joints i and j of the chain, with i before j: d(z_j x (p - o_j)) / dq_i = z_i x (z_j x (p - o_j)), and
            the same
        with i and j exchanged; seen from the tool z_i changes by q_j as z_i x z_j, and z_j by q_i not at all.
        """
        frames = self.chain.frames(positions)
        at = (frames[:, -1] @ self.link_from_tool)[:, :3, 3]
        n, k = len(positions), len(self.joints)
        found = np.zeros((n, 6, k, k))
        axes = [
            one.factor * (frames[:, i, :3, :3] @ one.axis)
            for i, one in enumerate(self.chain.joints)
        ]
        for j, later in enumerate(self.chain.joints):
            way = np.cross(axes[j], at - frames[:, j, :3, 3]) if later.turns else axes[j]
            for i, earlier in enumerate(self.chain.joints[: j + 1]):
                if not earlier.turns:
                    continue
                moved = np.cross(axes[i], way)
                found[:, :3, later.column, earlier.column] += moved
                if i == j:
                    continue
                found[:, :3, earlier.column, later.column] += moved
                if later.turns:
                    turned = np.cross(axes[i], axes[j])
                    found[:, 3:, earlier.column, later.column] += (turned[:, None] @ seen_from)[
                        :, 0
                    ]
        return found

    def sums(self, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(...) [rad] what all joints that turn, and (...) [m] what all that slide, move by together, with ways
        (..., k)."""
        turned, slid = np.zeros((2, *ways.shape[:-1]))
        for one in self.chain.joints:
            moved = turned if one.turns else slid
            moved += abs(one.factor) * ways[..., one.column]
        return turned, slid

    def series(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The series of the tool's rotation (ORDER + 1, n, 3, 3) and origin (ORDER + 1, n, 3) [m].

        Args:
            positions: (ORDER + 1, n, k) series of the joints.
        """
        n = positions.shape[1]
        turn, origin = np.zeros((ORDER + 1, n, 3, 3)), np.zeros((ORDER + 1, n, 3))
        turn[0] = np.eye(3)
        for joint in self.chain.joints:
            origin += turn @ joint.before[:3, 3]
            turn = turn @ joint.before[:3, :3]
            at = joint.factor * positions[:, :, joint.column]
            at[0] += joint.offset
            if joint.turns:
                turn = matrix_product(turn, turns_about(joint.axis, at))
            else:
                origin += product(turn @ joint.axis, at[:, :, None])
        origin += turn @ self.end[:3, 3]
        return turn @ self.end[:3, :3], origin
