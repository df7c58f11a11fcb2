"""Joints in a configuration that the wrist's place tells: before or behind axis 1, and the upper arm.

An arm is meant whose axes 2 and 3 are parallel and level, and whose last three meet in the wrist. A pose says
where the wrist is; so the first flag decides on axis 1, and the second on axis 3.

Sources: KUKA, expert programming (status); ABB, RAPID reference (confdata); visose/Robots, post-processors.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.formats.program.axes import AxisMap
from clearance.world.kinematic_chain import KinematicChain

MEETS = 1e-4
"""[m] and sine: axes that are nearer meet, or are parallel."""

NO_SIDE = 1e-3
"""[m] A wrist that is nearer to axis 1 is on no side of it."""

NEAR = 0.05
"""[rad] Joints of an arm are as near to those that follow from its drawing."""


@dataclass(frozen=True, eq=False)
class Wrist:
    """The wrist of an arm, whose axes are at 0 but for the external ones.

    Attributes:
        names: of the joints that follow axes 1 and 3. at_zero: the first's position [rad].
        flange_from_wrist: (3,) [m]. axis: (2, 3) a point of axis 1 and its way, seen from the root.
        ahead, aside: (3,) unit vectors from axis 1 to the wrist, and where axis 1 turns it. beside: [m] where the
            wrist is along the latter.
        straight: [rad] the second joint where the wrist is on the line from axis 2 to 3. bends: 1 if the wrist is
            before that line where the joint is greater, else -1.
    """

    names: tuple[str, str]
    at_zero: float
    flange_from_wrist: np.ndarray
    axis: np.ndarray
    ahead: np.ndarray
    aside: np.ndarray
    beside: float
    straight: float
    bends: int

    def ranges(
        self, root_from_flange: np.ndarray, is_behind: bool, is_back: bool | None
    ) -> dict[str, list[float]]:
        """The ranges of joints for a pose of the flange [rad], whole turns off or not.

        Args:
            is_behind: the wrist is behind axis 1. is_back: behind the line from axis 2 to 3; None if nobody says.
        """
        found = {}
        place = root_from_flange[:3, :3] @ self.flange_from_wrist + root_from_flange[:3, 3]
        x, y = (float((place - self.axis[0]) @ one) for one in (self.ahead, self.aside))
        out = np.sqrt(max(x * x + y * y - self.beside**2, 0.0))
        if out > NO_SIDE:
            own = np.arctan2(self.beside, -out if is_behind else out)
            joint = float(self.at_zero + np.arctan2(y, x) - own)
            found[self.names[0]] = [joint - NEAR, joint + NEAR]
        if is_back is not None:
            ends = self.straight, self.straight + (-1 if is_back else 1) * self.bends * np.pi
            found[self.names[1]] = [float(min(ends)), float(max(ends))]
        return found


def wrist_of(chain: KinematicChain, axes: AxisMap, up: np.ndarray) -> Wrist | None:
    """The wrist of an arm; None of one that is built otherwise.

    Args:
        up: (3,) along axis 1, away from the foot, seen from the root.
    """
    by_number = axes.at_zero(chain, np.eye(4))
    ways, places = (np.array([one[number] for number in range(1, 7)]) for one in by_number)
    names = {number: name for name, number in axes.numbers.items()}
    zero = {name: rule.offset for name, rule in axes.rules.items()}
    flange = chain.frames(np.array([[zero[joint.name] for joint in chain.masters]]))[0, -1]
    level = ways[1]
    skew = max(abs(ways[0] @ level), float(np.linalg.norm(np.cross(level, ways[2]))))
    centre = _meeting(places[3:], ways[3:])
    if skew > MEETS or centre is None:
        return None
    ahead = centre - places[0]
    ahead -= (ahead @ ways[0]) * ways[0] + (ahead @ level) * level
    upper, fore = (
        one - (one @ level) * level for one in (places[2] - places[1], centre - places[2])
    )
    if min(map(np.linalg.norm, (ahead, upper, fore))) < NO_SIDE:
        return None
    ahead /= np.linalg.norm(ahead)
    aside = np.cross(ways[0], ahead)
    left = np.cross(up, ahead)
    bent = float(np.arctan2(np.cross(upper, fore) @ ways[2], upper @ fore))
    return Wrist(
        names=(names[1], names[3]),
        at_zero=zero[names[1]],
        flange_from_wrist=flange[:3, :3].T @ (centre - flange[:3, 3]),
        axis=np.array([places[0], ways[0]]),
        ahead=ahead,
        aside=aside,
        beside=float((centre - places[0]) @ aside),
        straight=zero[names[3]] - bent,
        bends=1 if left @ ways[2] > 0.0 else -1,
    )


def _meeting(places: np.ndarray, ways: np.ndarray) -> np.ndarray | None:
    """(3,) the point in which lines meet [m]; None where they do not."""
    across = np.eye(3) - ways[:, :, None] * ways[:, None, :]
    found = np.linalg.solve(across.sum(axis=0), np.einsum("nij,nj->i", across, places))
    off = np.einsum("nij,nj->ni", across, found - places)
    return np.asarray(found) if np.linalg.norm(off, axis=1).max() < MEETS else None
