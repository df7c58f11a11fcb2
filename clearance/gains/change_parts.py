"""What a change moves, part by part, for who reads of it: joints, axes, a delay. Not for: `sentences`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from clearance.gains.result import Gain
from clearance.run import Run
from clearance.world.case import index_of_robot
from clearance.world.placed_robot import PlacedRobot

SHOWN = {
    "rad": (math.degrees(1.0), "deg"),
    "m": (1e3, "mm"),
    "s": (1.0, "s"),
    "share": (100.0, "%"),
}
"""What an amount of a unit is multiplied by to be shown, and the unit that it then has."""

STILL = 1e-9
"""[rad], [m] or [s]: what moves no farther is not told as moved."""


@dataclass(frozen=True)
class ChangePart:
    """A part of a change.

    Attributes:
        name: a joint, "x", "y", "z", "turn about z", "start" or "duration". amount: the greatest one, with its
            sign [rad], [m] or [s].
        unit: "rad", "m", "s" or "share". time: when that is; start, end: from when until when it is moved [s of
            the run]; None for what is so throughout.
    """

    name: str
    amount: float
    unit: str
    time: float | None = None
    start: float | None = None
    end: float | None = None


def change_parts(gain: Gain) -> list[ChangePart]:
    """All joints that move, in their table's order; the components of a shift, and its turn; the delay."""
    if gain.request.kind == "waypoints":
        changes = gain.change if isinstance(gain.change, tuple) else (gain.change,)
        each = zip(changed_robots(gain), changes, strict=True)
        return [
            part for placed, change in each for part in _joints(placed, change, len(changes) > 1)
        ]
    assert not isinstance(gain.change, tuple)
    change = gain.change.tolist()
    if gain.request.slow_down:
        return [ChangePart("duration", change[0], "share")]
    if gain.request.kind == "timing":
        return [ChangePart("start", change[0], "s")]
    parts = [ChangePart(axis, amount, "m") for axis, amount in zip("xyz", change, strict=False)]
    turn = gain.request.turn
    return (
        parts if turn is None else [*parts, ChangePart(f"turn about {turn.axis}", change[3], "rad")]
    )


def joint_parts(gain: Gain) -> list[ChangePart]:
    """The joints of a robot whose base is moved and whose tool path is kept."""
    i_robot = index_of_robot(gain.case.robots, gain.who)
    before, after = (
        one.record.case.robots[i_robot].given_trajectory.positions
        for one in (gain.before, gain.after)
    )
    return _joints(gain.case.robots[i_robot], after - before)


def changed_robots(gain: Gain) -> list[PlacedRobot]:
    """The robots of the changed case that are changed."""
    robots = gain.case.robots
    return [robots[index_of_robot(robots, name)] for name in gain.request.robot or (gain.who,)]


def _joints(placed: PlacedRobot, change: np.ndarray, named: bool = False) -> list[ChangePart]:
    kinds = {joint.name: joint.kind for joint in placed.robot.moving_joints}
    times = placed.timing.run_times(placed.given_trajectory.times)
    found = []
    for name, offsets in zip(placed.given_trajectory.joint_names, change.T, strict=True):
        rows = np.flatnonzero(np.abs(offsets) > STILL)
        if len(rows):
            most = int(np.argmax(np.abs(offsets)))
            unit = "m" if kinds[name] == "prismatic" else "rad"
            ends = (
                float(times[max(rows[0] - 1, 0)]),
                float(times[min(rows[-1] + 1, len(times) - 1)]),
            )
            shown = f"{placed.robot.name}/{name}" if named else name
            found.append(ChangePart(shown, float(offsets[most]), unit, float(times[most]), *ends))
    return found


def size_in_unit(gain: Gain) -> tuple[float, float, str]:
    """Size and lower bound, and their unit: metres where all joints of a path slide."""
    if gain.request.kind == "waypoints" and not turning(gain):
        from clearance.gains.offsets import SLIDE

        return gain.size / SLIDE, gain.lower_bound / SLIDE, "m"
    return gain.size, gain.lower_bound, gain.unit


def turning(gain: Gain) -> bool:
    """True if a joint of a path that is changed turns."""
    return any(kind != "prismatic" for kind in _kinds(gain))


def sliding(gain: Gain) -> bool:
    """True if a joint of a path that is changed slides."""
    return "prismatic" in _kinds(gain)


def _kinds(gain: Gain) -> set[str]:
    found = set[str]()
    for placed in changed_robots(gain):
        kinds = {joint.name: joint.kind for joint in placed.robot.moving_joints}
        found |= {str(kinds[name]) for name in placed.given_trajectory.joint_names}
    return found


def proven_bound(run: Run) -> float | None:
    """[m] What no clearance of a run is below at any moment; None where nothing is proven."""
    certificate = run.certificate
    return None if certificate is None else float(certificate.lower_bound.min())


def proven_after(gain: Gain) -> float | None:
    """The same of the changed case, which is proven once more against its limits and the margin."""
    found, limits = proven_bound(gain.after), gain.case.limits
    if found is None or not gain.clearances_kept or limits.rules:
        return found
    return max(found, limits.fail + gain.request.margin)
