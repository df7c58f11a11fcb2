"""A tool of a robot: a pose fixed to a link, where it is and how it changes with given joints.

Poses are seen from the robot's root, so that what the robot stands on is none of it. Not for: what is to be kept
of them (`gains`), joints for a pose (`programs.inverse`).
"""
from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clearance.errors import BadInput, UnknownLink, nearest_name
from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING, TURNING, Links
from clearance.world.case import PlacedRobot
from clearance.world.kinematics import links_of_robot, moving_positions, poses_by_link


@dataclass(frozen=True, eq=False)
class Tool:
    """A link of a robot that joints of its table move.

    Attributes:
        placed: the robot. link: its place among the links.
    """

    placed: PlacedRobot
    link: int

    @property
    def name(self) -> str:
        """Of the link."""
        return self.placed.robot.link_names[self.link]

    @cached_property
    def links(self) -> Links:
        """Of the robot, its root at the origin."""
        return links_of_robot(self.placed.robot)

    @cached_property
    def movers(self) -> tuple[tuple[int, int], ...]:
        """(link, column of the table) of each joint that moves the tool and that the table names."""
        return _movers(self.placed, self.link)

    def all_poses(self, positions: np.ndarray) -> np.ndarray:
        """(n, links, 4, 4) `root_from_link` [m] with the table's joints at (n, k) [rad or m]."""
        named = self.placed.given_trajectory.joint_names
        return poses_by_link(self.links, moving_positions(self.placed, named, positions))

    def poses(self, positions: np.ndarray) -> np.ndarray:
        """(n, 4, 4) `root_from_tool` [m]."""
        return self.all_poses(positions)[:, self.link]

    def poses_and_rates(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 4, 4) `root_from_tool` [m], and (n, 6, k) how its origin moves and how it turns by each joint."""
        poses = self.all_poses(positions)
        at = poses[:, self.link, :3, 3]
        rates = np.zeros((len(poses), 6, positions.shape[1]))
        for link, column in self.movers:
            axes = self.links.factors[link] * (poses[:, link, :3, :3] @ self.links.axes[link])
            if self.links.kinds[link] == SLIDING:
                rates[:, :3, column] += axes
                continue
            rates[:, :3, column] += np.cross(axes, at - poses[:, link, :3, 3])
            rates[:, 3:, column] += axes
        return poses[:, self.link], rates


def tool_of(placed: PlacedRobot, name: str | None) -> Tool:
    """The tool by the name of its link; without one the first link that all joints of the table move.

    Raises:
        UnknownLink: with the nearest name. BadInput: no joint of the table moves it, or none is named and no link
            is moved by all of them.
    """
    names = placed.robot.link_names
    if name is not None and name not in names:
        raise UnknownLink(f"there is no link {name!r}", valid=nearest_name(name, names))
    if name is not None:
        link = names.index(name)
        if not _movers(placed, link):
            raise BadInput(
                f"no joint of the path moves link {name!r}", valid="a link that the path moves"
            )
        return Tool(placed, link)
    n_joints = len(placed.given_trajectory.joint_names)
    for link in range(len(names)):
        if len({column for _, column in _movers(placed, link)}) == n_joints:
            return Tool(placed, link)
    raise BadInput(
        f"which link of robot {placed.robot.name!r} is its tool is not said, and none is moved by all joints",
        valid=f"one of {', '.join(names[-4:])}",
    )


def _movers(placed: PlacedRobot, link: int) -> tuple[tuple[int, int], ...]:
    links = links_of_robot(placed.robot)
    moving = [joint.name for joint in placed.robot.moving_joints]
    columns = {moving.index(name): i for i, name in enumerate(placed.given_trajectory.joint_names)}
    found = []
    while link != NO_PARENT:
        column = columns.get(int(links.columns[link]))
        if links.kinds[link] in (TURNING, SLIDING) and column is not None:
            found.append((link, column))
        link = int(links.parents[link])
    return tuple(found)


def apart(poses: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(n, 6) how poses lie off others (n, 4, 4): their origins [m], and the turn about the axis that does it
    [rad].
    """
    turned = poses[:, :3, :3] @ np.swapaxes(others[:, :3, :3], 1, 2)
    twice = np.stack(
        [
            turned[:, (k + 2) % 3, (k + 1) % 3] - turned[:, (k + 1) % 3, (k + 2) % 3]
            for k in range(3)
        ],
        axis=1,
    )
    sines = 0.5 * np.linalg.norm(twice, axis=1)
    cosines = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1.0)
    angles = np.arctan2(sines, cosines)
    factors = np.divide(angles, 2.0 * sines, out=np.full(len(sines), 0.5), where=sines > 1e-12)
    return np.hstack([poses[:, :3, 3] - others[:, :3, 3], factors[:, None] * twice])
