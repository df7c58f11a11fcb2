"""How the axes of makers' robots turn, and which count from others. Not for: joints that follow them (`axes`).

Sources: ROS-Industrial: fanuc 8fee5e3 (24 robots; J3' = J3 + J2), kuka_experimental e78bbd1 (11), abb 77db19b and
abb_experimental 20b9cf8 (13), abb_driver f3068b9 (parallel bars: J3' = J3 - J2); Universal Robots, DH parameters.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from clearance.formats.program.axes import AxisMap
from clearance.world.kinematic_chain import KinematicChain

ALONG = 0.99
"""The cosine from which directions are the same: calibrated robots are off by less."""

_WAYS = {
    f"{sign}{letter}": factor * np.eye(3)[i]
    for sign, factor in (("+", 1.0), ("-", -1.0))
    for i, letter in enumerate("xyz")
}


@dataclass(frozen=True)
class Convention:
    """How six axes turn.

    Attributes:
        robots: of whom, in words. turns: about what each turns when all are at 0, seen from the base.
        upper_arm: the way from axis 2 to axis 3 then. third: the multiple of axis 2 by which the joint of axis 3
            turns beside its own. doubt: how other robots of the maker may differ; empty where none does.
    """

    robots: str
    turns: str
    upper_arm: str
    third: float = 0.0
    doubt: str = ""

    def misfit(self, chain: KinematicChain, axes: AxisMap, root_from_base: np.ndarray) -> str:
        """Which joints of six are not where these axes are at 0, or turn otherwise; empty if none does."""
        ways, places = _at_zero(chain, axes, root_from_base)
        names = {number: name for name, number in axes.numbers.items()}
        found = []
        for number, turn in enumerate(self.turns.split(), 1):
            along = float(ways[number] @ _WAYS[turn])
            if along < -ALONG:
                found.append(f"{names[number]} turns against axis {number}")
            elif along < ALONG:
                found.append(f"{names[number]} turns about another line than axis {number}")
        arm = places[3] - places[2]
        arm -= (arm @ ways[2]) * ways[2]
        if arm @ _WAYS[self.upper_arm] < ALONG * np.linalg.norm(arm):
            found.append(f"{names[2]} is not where axis 2 is at 0")
        return f"with the axes of {self.robots} at 0, {', '.join(found)}" if found else ""


def _at_zero(
    chain: KinematicChain, axes: AxisMap, root_from_base: np.ndarray
) -> tuple[dict[int, np.ndarray], dict[int, np.ndarray]]:
    """By its number, about what each axis turns and where it is when all are at 0, seen from the base."""
    rules = [axes.rules[joint.name] for joint in chain.masters]
    frames = chain.frames(np.array([[rule.offset for rule in rules]]))[0]
    ways, places = {}, {}
    for joint, frame in reversed([*zip(chain.joints, frames[:-1], strict=True)]):
        number = axes.numbers.get(chain.masters[joint.column].name)
        if number is not None:
            turn = np.sign(joint.factor) * rules[joint.column].sign * joint.axis
            ways[number] = root_from_base[:3, :3].T @ frame[:3, :3] @ turn
            places[number] = root_from_base[:3, :3].T @ frame[:3, 3]
    return ways, places


_ABB = ("ABB robots", "+z +y +y +x +y +x", "+z")

CONVENTIONS = {
    "abb": Convention(
        *_ABB,
        doubt="axis 3 is taken to count from the upper arm, as on robots without parallel bars; in the program, "
        "axes_as: abb says so, or abb_parallel",
    ),
    "abb_parallel": Convention(*_ABB, third=-1.0),
    "fanuc": Convention(
        *("FANUC robots", "+z +y -y -x -y -x", "+z"),
        third=1.0,
        doubt="J3 is taken to count from the horizontal (joint: J3 + J2), as on most FANUC robots; "
        "axes_as: fanuc in the program says so",
    ),
    "kuka": Convention("KUKA robots", "-z +y +y -x +y -x", "+x"),
    "ur": Convention("Universal Robots", "+z -y -y -y -z -y", "-x"),
}
"""By the name of a preset."""
