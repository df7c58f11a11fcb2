"""Times of a case that belong to a robot's motion, where that is moved in time: those of parts that it carries.

Not for: windows of rules and of allowed pairs, which stay and are named (`windows_that_stay`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

from clearance.errors import BadChange
from clearance.world.body import Mount
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.forest import owner_of
from clearance.world.pairs import BodyIndex, names_of
from clearance.world.rules import PairPattern, matches
from clearance.world.timing import Window


def carries_moved(
    case: Case, i_robot: int, begins: float, later: Callable[[float], float]
) -> tuple[Carry, ...]:
    """The carries of a case, those of one robot moved in time.

    Args:
        begins: [s] when the robot's path begins, before it is moved: what it holds until then it holds already.
        later: the time of the run [s] at which the robot is where it was at another.
    """

    def moved(time: float) -> float:
        return later(time) if time > begins else time

    def carry_moved(carry: Carry) -> Carry:
        if not _is_by(case, carry, i_robot):
            return carry
        window = Window(moved(carry.window.start), moved(carry.window.end))
        return replace(carry, window=window)

    return tuple(map(carry_moved, case.carries))


def require_own_parts(case: Case, i_robot: int) -> None:
    """Nothing, if no part that a robot carries is carried by anything else.

    Raises:
        BadChange: a part changes hands, at times that are not the robot's alone.
    """
    own = {carry.part for carry in case.carries if _is_by(case, carry, i_robot)}
    for carry in case.carries:
        if carry.part in own and not _is_by(case, carry, i_robot):
            name = case.robots[i_robot].robot.name
            raise BadChange(
                f"part {carry.part!r} changes hands between robot {name!r} and {carry.by!r}, "
                "at times that a change of one robot's time would break",
                valid="kind waypoints, obstacle or base",
            )


def windows_that_stay(case: Case, i_robot: int) -> Iterator[str]:
    """Rules and allowed pairs, in words, that hold for a time and are of one robot."""
    robot = case.robots[i_robot].robot
    bodies = (BodyIndex(i_robot, k) for k in range(len(robot.bodies)))
    names = [name for body in bodies for name in names_of(case, body)]
    rows: list[tuple[str, PairPattern]] = [
        (f"rule {rule.name!r}", rule) for rule in case.limits.rules
    ]
    rows += [(f"allow[{i}]", row) for i, row in enumerate(case.allow)]
    for label, row in rows:
        of_robot = any(matches(name, one) for name in names for one in row.between)
        if row.window.ends and of_robot:
            yield f"{label} ({row.window})"


def _is_by(case: Case, carry: Carry, i_robot: int) -> bool:
    return owner_of(case, Mount(carry.by)) == (False, i_robot)
