"""How far links are off a nominal motion, by how far joints are. Not for: how far those are (`corner`,
`joint_corner`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from clearance.geometry.quaternions import half_skew
from clearance.kernels.motion.kinematics import SLIDING, Links
from clearance.programs.arm import Arm
from clearance.world.kinematics import links_of_robot, poses_by_link
from clearance.world.robot import JointKind, Robot
from clearance.world.tool import movers, rates_of
from clearance.world.trajectory import Deviation


class Cells(NamedTuple):
    """Joints about those of a nominal motion, in pieces of it.

    Attributes:
        middle: (n, k) in the middle of each [rad or m]. shifts: (n, k) how far that is off the nominal motion.
        within: (n, k) how far the motion goes within a piece. box: (n, k) how far joints may be off the shifted.
    """

    middle: np.ndarray
    shifts: np.ndarray
    within: np.ndarray
    box: np.ndarray


def links_off(arm: Arm, cells: Cells) -> dict[str, Deviation]:
    """How far each link that the arm moves may be off the nominal motion, in any cell."""
    robot = arm.robot
    moving = [joint.name for joint in robot.moving_joints]
    columns = [moving.index(joint.name) for joint in arm.joints]
    links, lengths = links_of_robot(robot), _path_lengths(robot)
    at, off = np.zeros((2, len(cells.box), len(moving)))
    at[:, columns], off[:, columns] = cells.middle - cells.shifts, cells.middle
    nominal, shifted = poses_by_link(links, at), poses_by_link(links, off)
    deviations: dict[str, Deviation] = {}
    for i, name in enumerate(robot.link_names):
        above = _Above.of(links, i, columns)
        if not above.driven:
            continue
        carrier = robot.link_names[above.driven[0][0]]
        if above.others == 0:
            deviations[name] = _off(links, nominal, shifted, above, lengths[name], cells)
        elif carrier in deviations and above.others == above.others_below:
            of_carrier, farther = deviations[carrier], lengths[name] - lengths[carrier]
            deviations[name] = Deviation(of_carrier.at(farther) * MORE, of_carrier.turn)
        else:
            turned, slid = above.sums(np.abs(cells.shifts) + cells.box)
            ways = lengths[name] * turned + slid
            deviations[name] = Deviation(float(ways.max()) * MORE, float(turned.max()) * MORE)
    return deviations


class _Above(NamedTuple):
    """The joints between a link and the root.

    Attributes:
        link: whose they are. driven: those that the arm drives, from the link to the root: the link below each and
            its place among the arm's.
        columns, factors, slides: (m,) of those joints: their place among the arm's, and how they follow it.
        others: how many joints are not the arm's, wherever they are. others_below: how many of them are below the
            driven.
    """

    link: int
    driven: tuple[tuple[int, int], ...]
    columns: np.ndarray
    factors: np.ndarray
    slides: np.ndarray
    others: int
    others_below: int

    @classmethod
    def of(cls, links: Links, link: int, columns: list[int]) -> _Above:
        """Those of a link, where an arm drives some columns."""
        driven = movers(links, link, columns)
        every = [one for one, _ in movers(links, link, range(int(links.columns.max()) + 1))]
        others_below = every.index(driven[0][0]) if driven else len(every)
        own, at = np.array(driven, dtype=np.int64).reshape(-1, 2).T
        others, slides = len(every) - len(driven), links.kinds[own] == SLIDING
        return cls(link, driven, at, links.factors[own], slides, others, others_below)

    def sums(self, ways: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """(n,) [rad] what those that turn, and (n,) [m] what those that slide, move by with the arm's ways (n,
        k)."""
        moved = np.abs(self.factors) * ways[:, self.columns]
        return moved[:, ~self.slides].sum(axis=1), moved[:, self.slides].sum(axis=1)

    def change(
        self, length: float, moved: np.ndarray, ways: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """(n,) [m] and [rad] by how much more joints that go by `ways` move the link once joints are `moved` (n,
        k).

        The column of a joint that turns has a way of at most `length` for the link's origin; a turn by a turns it
        by a at most, a slide by d moves it by d. That of a joint that slides has length 1 and turns likewise.

        Args:
            length: [m] of the path from the root to the link.
        """
        (turned, slid), (turns, slides) = self.sums(moved), self.sums(ways)
        return turns * (length * turned + slid) + slides * turned, turns * turned


def _off(
    links: Links,
    nominal: np.ndarray,
    shifted: np.ndarray,
    above: _Above,
    length: float,
    cells: Cells,
) -> Deviation:
    """How far a link may be off that the arm alone moves.

    At the middle of an interval the shift of a cell moves a link by what both poses differ by; within it by more
    by the change of the Jacobian with the shift, times how far the cubics go; and the box by the Jacobian there.
    """
    box, within, i = cells.box, cells.within, above.link
    by_shift = above.change(length, np.abs(cells.shifts), within)
    by_box = above.change(length, within + box, box)
    rates = rates_of(links, shifted, shifted[:, i, :3, 3], above.driven, box.shape[1])
    rest = (np.abs(rates) @ box[..., None])[..., 0]
    ways = np.linalg.norm(shifted[:, i, :3, 3] - nominal[:, i, :3, 3], axis=1)
    ways += np.linalg.norm(rest[:, :3], axis=1) + by_shift[0] + by_box[0]
    turns = _angles(nominal[:, i, :3, :3], shifted[:, i, :3, :3])
    turns += np.linalg.norm(rest[:, 3:], axis=1) + by_shift[1] + by_box[1]
    return Deviation(float(ways.max()) * MORE, float(turns.max()) * MORE)


def _path_lengths(robot: Robot) -> dict[str, float]:
    """[m] No link's frame is farther from a joint above it than this, by link; slides reach to their limits."""
    path = {robot.link_names[0]: 0.0}
    for joint in robot.joints:
        own = float(np.linalg.norm(joint.parent_from_joint[:3, 3]))
        if joint.kind is JointKind.PRISMATIC:
            own += max(abs(joint.lower), abs(joint.upper))
        path[joint.child] = path[joint.parent] + own
    return path


MORE = 1.0 + 1e-6
"""What covers rounding."""


def _angles(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(n,) [rad] between rotations (n, 3, 3)."""
    between = np.swapaxes(a, 1, 2) @ b
    cosines = 0.5 * (np.trace(between, axis1=1, axis2=2) - 1.0)
    return np.arctan2(np.linalg.norm(half_skew(between), axis=1), cosines)
