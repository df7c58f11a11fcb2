"""How the axes of makers' robots turn, and which count from others. Not for: joints that follow them (`axes`).

Sources: ROS-Industrial: fanuc 8fee5e3 (24 robots; J3' = J3 + J2), kuka_experimental e78bbd1 (11), abb 77db19b and
abb_experimental 20b9cf8 (13), abb_driver f3068b9 (parallel bars: J3' = J3 - J2); Universal Robots, DH parameters.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from clearance.formats.program.axes import AxisMap
from clearance.formats.schema.program_file import Axis
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
        ways, places = axes.at_zero(chain, root_from_base)
        names = {number: name for name, number in axes.numbers.items()}
        found = []
        for number, turn in enumerate(self.turns.split(), 1):
            along = axes.rules[names[number]].sign * float(ways[number] @ _WAYS[turn])
            if along < -ALONG:
                found.append(f"{names[number]} turns against axis {number}")
            elif along < ALONG:
                found.append(f"{names[number]} turns about another line than axis {number}")
        arm = _across(places[3] - places[2], ways[2])
        if arm @ _WAYS[self.upper_arm] < ALONG * np.linalg.norm(arm):
            off = np.degrees(_turn_to(arm, _WAYS[self.upper_arm], ways[2]))
            found.append(f"{names[2]} is {abs(off):.3g} degrees from where axis 2 is at 0")
        return f"with the axes of {self.robots} at 0, {', '.join(found)}" if found else ""

    def rules(
        self, chain: KinematicChain, axes: AxisMap, root_from_base: np.ndarray
    ) -> dict[str, Axis]:
        """By joint, signs and offsets with which six joints are these axes; none if there are no such, or several.

        Each joint but the last is turned so that the next axis lies as at 0, or the upper arm. The flange says
        nothing: the last one has no offset.
        """
        names = {number: name for name, number in axes.numbers.items()}
        now = replace(axes, rules=dict.fromkeys(axes.rules, Axis()), third=self.third)
        for number, turn in enumerate(self.turns.split(), 1):
            ways, places = now.at_zero(chain, root_from_base)
            rule = Axis(sign=1 if ways[number] @ _WAYS[turn] > 0.0 else -1)
            if number < 6:
                after, next_turn = ways[number + 1], self.turns.split()[number]
                probe, to = after, _WAYS[next_turn] * np.sign(after @ _WAYS[next_turn] or 1.0)
                if number == 2:
                    probe, to = places[3] - places[2], _WAYS[self.upper_arm]
                probe = _across(probe, ways[number])
                if np.linalg.norm(probe) < 1.0 - ALONG:
                    return {}
                off = _turn_to(probe, to, ways[number])
                rule = rule.model_copy(update={"offset": float(off)})
            now = replace(now, rules={**now.rules, names[number]: rule})
        return {} if self.misfit(chain, now, root_from_base) else dict(now.rules)


def _across(vector: np.ndarray, way: np.ndarray) -> np.ndarray:
    """The part of a vector at right angles to a direction."""
    return np.asarray(vector - (vector @ way) * way)


def _turn_to(vector: np.ndarray, other: np.ndarray, about: np.ndarray) -> float:
    """[rad] From a vector to another one about a direction, to both of which it is at right angles."""
    return float(np.arctan2(about @ np.cross(vector, other), vector @ other))


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
