"""A tool of a robot: a pose fixed to a link, where it is and how it changes with given joints.

Poses are seen from a link of the robot, its root if none is named, so that what the robot stands on is none of it.
Not for: what is to be kept of them (`gains`), joints for a pose (`programs.inverse`).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clearance.errors import BadInput, UnknownLink, nearest_name
from clearance.geometry.quaternions import half_skew
from clearance.kernels.motion.kinematics import NO_PARENT, SLIDING, TURNING, Links
from clearance.world.kinematics import links_of_robot, moving_positions, poses_by_link
from clearance.world.placed_robot import PlacedRobot


@dataclass(frozen=True, eq=False)
class Tool:
    """A pose on a link, and the joints that may move it.

    Attributes:
        placed: the robot; joints that are not named are where it has them fixed. link: its place among the links.
        joint_names: (k,) of the columns of positions. link_from_tool: (4, 4) [m].
        reference: the place among the links of the one that poses are seen from; 0 is the root.
    """

    placed: PlacedRobot
    link: int
    joint_names: tuple[str, ...]
    link_from_tool: np.ndarray = field(default_factory=lambda: np.eye(4))
    reference: int = 0

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
        """(link, column of positions) of each joint that moves the tool and is named."""
        return self._movers_of(self.link)

    def all_poses(self, positions: np.ndarray) -> np.ndarray:
        """(n, links, 4, 4) `root_from_link` [m] with the named joints at (n, k) [rad or m]."""
        return poses_by_link(self.links, moving_positions(self.placed, self.joint_names, positions))

    def poses(self, positions: np.ndarray) -> np.ndarray:
        """(n, 4, 4) `reference_from_tool` [m]."""
        return self._seen(self.all_poses(positions))

    def poses_and_rates(self, positions: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n, 4, 4) `reference_from_tool` [m], and (n, 6, k) how its origin moves and how it turns by each
        joint."""
        poses, n_columns = self.all_poses(positions), positions.shape[1]
        at = (poses[:, self.link] @ self.link_from_tool)[:, :3, 3]
        if not self.reference:
            return self._seen(poses), rates_of(self.links, poses, at, self.movers, n_columns)
        own, others = (set(self._movers_of(link)) for link in (self.link, self.reference))
        ahead, back = (
            rates_of(self.links, poses, at, sorted(one), n_columns)
            for one in (own - others, others - own)
        )
        seen = np.swapaxes(poses[:, self.reference, :3, :3], 1, 2)[:, None]
        rates = seen @ (ahead - back).reshape(-1, 2, 3, n_columns)
        return self._seen(poses), rates.reshape(-1, 6, n_columns)

    def _movers_of(self, link: int) -> tuple[tuple[int, int], ...]:
        moving = [joint.name for joint in self.placed.robot.moving_joints]
        return movers(self.links, link, [moving.index(name) for name in self.joint_names])

    def _seen(self, poses: np.ndarray) -> np.ndarray:
        """(n, 4, 4) `reference_from_tool` [m], by the poses of all links (n, links, 4, 4)."""
        tool = poses[:, self.link] @ self.link_from_tool
        if self.reference:
            tool = np.linalg.inv(poses[:, self.reference]) @ tool
        return np.asarray(tool)


def movers(links: Links, link: int, columns: Sequence[int]) -> tuple[tuple[int, int], ...]:
    """(link, place among the columns) of each joint of some columns (k,) that moves a link, from it to the
    root."""
    found = []
    while link != NO_PARENT:
        if links.kinds[link] in (TURNING, SLIDING) and links.columns[link] in columns:
            found.append((link, columns.index(links.columns[link])))
        link = int(links.parents[link])
    return tuple(found)


def rates_of(
    links: Links,
    poses: np.ndarray,
    at: np.ndarray,
    moved_by: Sequence[tuple[int, int]],
    n_columns: int,
) -> np.ndarray:
    """(n, 6, n_columns) how points at (n, 3) [m] of a link move, and how it turns, by each column of positions.

    Args:
        poses: (n, links, 4, 4). moved_by: the `movers` of the link.
    """
    found = np.zeros((len(poses), 6, n_columns))
    for link, column in moved_by:
        axes = links.factors[link] * (poses[:, link, :3, :3] @ links.axes[link])
        if links.kinds[link] == SLIDING:
            found[:, :3, column] += axes
            continue
        found[:, :3, column] += np.cross(axes, at - poses[:, link, :3, 3])
        found[:, 3:, column] += axes
    return found


def tool_of(placed: PlacedRobot, name: str | None) -> Tool:
    """The tool by the name of its link; without one the first link that all joints of the table move.

    Raises:
        UnknownLink: with the nearest name. BadInput: no joint of the table moves it, or none is named and no link
            is moved by all of them.
    """
    names = placed.robot.link_names
    if name is not None and name not in names:
        raise UnknownLink(f"there is no link {name!r}", valid=nearest_name(name, names))
    given = placed.given_trajectory.joint_names
    if name is not None:
        found = Tool(placed, names.index(name), given)
        if not found.movers:
            raise BadInput(
                f"no joint of the path moves link {name!r}", valid="a link that the path moves"
            )
        return found
    for link in range(len(names)):
        found = Tool(placed, link, given)
        if len({column for _, column in found.movers}) == len(given):
            return found
    raise BadInput(
        f"no link of robot {placed.robot.name!r} is named as its tool, and none is moved by all joints",
        valid=f"one of {', '.join(names[-4:])}",
    )


def pose_errors(poses: np.ndarray, others: np.ndarray) -> np.ndarray:
    """(n, 6) how poses lie off others (n, 4, 4): their origins [m], and the turn about the axis that does it
    [rad].
    """
    turned = poses[:, :3, :3] @ np.swapaxes(others[:, :3, :3], 1, 2)
    skew = half_skew(turned)
    sines = np.linalg.norm(skew, axis=1)
    cosines = 0.5 * (np.trace(turned, axis1=1, axis2=2) - 1.0)
    angles = np.arctan2(sines, cosines)
    factors = np.divide(angles, sines, out=np.ones(len(sines)), where=sines > 1e-12)
    return np.hstack([poses[:, :3, 3] - others[:, :3, 3], factors[:, None] * skew])
