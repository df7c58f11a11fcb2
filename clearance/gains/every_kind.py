"""Every kind of change to one case, tried one after another, and a table of what each comes to.

Not for: one kind (`answer`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager
from dataclasses import dataclass
from typing import Any

from clearance.errors import BadInput, UnknownObstacle, UnknownRobot
from clearance.gains.answer import gain
from clearance.gains.request import kinds_of
from clearance.gains.result import Gain
from clearance.gains.sentences import bound_text, not_passed_text, size_text
from clearance.run import Question, answer
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot

SUB_FOLDERS = ("waypoints", "base", "timing", "obstacle")
"""Where each kind goes; in this order they are tried."""


@dataclass(frozen=True, eq=False)
class Trial:
    """A kind of change that was tried.

    Attributes:
        name: of the kind, with its robot where several are tried.
        gain: what it comes to; None where it does not apply. why: why not.
    """

    name: str
    gain: Gain | None
    why: str = ""

    @property
    def kept(self) -> bool:
        """True if every rule is proven to hold with it, and the changed case is passed."""
        return self.gain is not None and self.gain.kept


Robots = tuple[str, ...]
"""Which robot, or which together; none for the only one."""


def trials_of(case: Case, robot: Robots) -> list[tuple[str, Robots]]:
    """Kinds, in order, and the robot that each is to change: all that it may be of, where none is named."""
    found: list[tuple[str, Robots]] = []
    for kind in SUB_FOLDERS:
        if kind == "obstacle" or robot or len(case.robots) == 1:
            found.append((kind, robot))
            continue
        found += [(kind, (placed.robot.name,)) for placed in case.robots if _is_of(kind, placed)]
    return found


def name_of(kind: str, robot: Robots, case: Case) -> str:
    """Of a kind, with its robot where there are several; a path below the folder of all."""
    if kind == "obstacle" or len(robot) != 1 or len(case.robots) == 1:
        return kind
    return f"{kind}/{robot[0]}"


def every_kind(
    case: Case, options: Mapping[str, Any], progress: Callable[[str], AbstractContextManager[None]]
) -> Iterator[Trial]:
    """What each kind comes to, of each robot and of the obstacle of the worst pair, where none is named.

    Args:
        options: as `gain` takes them. progress: around each search, with its kind.

    Raises:
        UnknownRobot, UnknownObstacle: with the nearest name.
    """
    for kind, robot in trials_of(case, options.get("robot", ())):
        own = {key: one for key, one in options.items() if kind in kinds_of(key)}
        if robot and kind != "obstacle":
            own["robot"] = robot
        if not own.get("keep_tool") and own.get("tool_path") != "kept":
            own.pop("tool", None)
        name = name_of(kind, robot, case)
        if kind == "obstacle" and own.get("obstacle") is None:
            nearest = _obstacle_of_worst(case)
            if nearest is None:
                yield Trial(name, None, "the worst pair has no obstacle that stands free")
                continue
            own["obstacle"] = nearest
        try:
            with progress(name):
                found = gain(case, kind, **own)
        except (UnknownObstacle, UnknownRobot):
            raise
        except BadInput as error:
            yield Trial(name, None, str(error))
            continue
        yield Trial(name, found)


def _is_of(kind: str, placed: PlacedRobot) -> bool:
    """True if a change of a kind can be of a robot."""
    return placed.mount is None if kind == "base" else placed.trajectory is not None


def table_lines(tried: Sequence[Trial]) -> list[str]:
    """A line for each kind."""
    rows = [("kind", "kept", "change", "what")]
    for one in tried:
        if one.gain is None:
            rows.append((one.name, "-", "-", f"does not apply: {one.why}"))
            continue
        if one.kept and one.gain.size == 0.0:
            cells = ("yes", "none", f"{one.gain.who}; nothing had to be changed")
        elif one.kept:
            warned = "".join(f"; warning: {line}" for line in one.gain.unjudged)
            cells = ("yes", size_text(one.gain), f"{one.gain.who}; {bound_text(one.gain)}{warned}")
        elif one.gain.clearances_kept:
            change = size_text(one.gain) if one.gain.size > 0.0 else "none"
            cells = ("no", change, f"{one.gain.who}; {not_passed_text(one.gain)}")
        else:
            cells = ("no", "-", f"{one.gain.who}; {one.gain.blocked}")
        rows.append((one.name, *cells))
    widths = [max(len(row[i]) for row in rows) for i in range(3)]
    return ["  ".join([*(row[i].ljust(widths[i]) for i in range(3)), row[3]]) for row in rows]


def _obstacle_of_worst(case: Case) -> str | None:
    """The obstacle of the most critical pair at the steps; None where it is of two links."""
    worst = answer(Question(case, certify=False, contact="none")).verdict.worst
    names = [one.name for one in case.obstacles]
    return next((name for name in (worst.obstacle, worst.link) if name in names), None)
