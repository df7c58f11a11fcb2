"""All robots of a case as they move: those with programs are read when what their frames are on is read.

Not for: one robot (`robots`), and what a program may move (`driven_robots`).
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from clearance.case.allow import carries_of
from clearance.case.driven_robots import Surroundings, require_as_read
from clearance.case.places import Rider
from clearance.case.robots import InMotion, RobotReader
from clearance.errors import UnknownPlace, at
from clearance.formats.schema import case as schema
from clearance.world.body import Obstacle
from clearance.world.carry import Carry


def robots_in_motion(
    reader: RobotReader,
    entries: Sequence[schema.RobotEntry],
    given: schema.Case,
    obstacles: Sequence[Obstacle],
) -> list[InMotion]:
    """The robots as they move: those without programs first, and each program after what its frames are on.

    Raises:
        BadInput: with the field and the file; programs whose frames are on each other's robots.
    """
    has_program = [
        one.trajectory is not None and one.trajectory.program is not None for one in entries
    ]
    found = {
        i: reader.moving(one, Surroundings()) for i, one in enumerate(entries) if not has_program[i]
    }
    carries = carries_of(given.carry)
    riders = tuple(rider(one, carries) for one in obstacles)
    waiting = [i for i, has in enumerate(has_program) if has]
    driven: set[str] = set()
    while waiting:
        i = _next_read(reader, entries, waiting, _Cell(found, riders, driven))
        waiting.remove(i)
        for j, one in found.items():
            if one.placed.robot.name in found[i].driven:
                found[j] = one._replace(placed=found[i].driving(one.placed))
        driven |= found[i].driven.keys()
    cell = _Cell(found, riders, driven)
    for i, entry in enumerate(entries):
        if not has_program[i]:
            continue
        with at(f"{entry.trajectory_field}.program"):
            require_as_read(found[i].placed, cell.around(i))
    return [found[i] for i in range(len(entries))]


class _Cell(NamedTuple):
    """The robots that are read, by their place in the file, and the obstacles."""

    robots: dict[int, InMotion]
    riders: tuple[Rider, ...]
    driven: set[str]

    def around(self, i_robot: int) -> Surroundings:
        """All but one robot."""
        others = tuple(one.placed for i, one in self.robots.items() if i != i_robot)
        return Surroundings(others, self.riders, frozenset(self.driven))


def _next_read(
    reader: RobotReader, entries: Sequence[schema.RobotEntry], waiting: Sequence[int], cell: _Cell
) -> int:
    """The first robot with a program whose frames are on what is read, which is read now.

    Raises:
        UnknownPlace: there is none.
    """
    unknown: UnknownPlace | None = None
    for i in waiting:
        n_notes = len(reader.notes)
        try:
            cell.robots[i] = reader.moving(entries[i], cell.around(i))
        except UnknownPlace as fault:
            unknown = unknown or fault
            del reader.notes[n_notes:]
        else:
            return i
    assert unknown is not None
    raise unknown


def rider(obstacle: Obstacle, carries: Sequence[Carry]) -> Rider:
    """An obstacle, as places of frames know it."""
    mount = obstacle.mount
    own = sorted((one for one in carries if one.part == obstacle.name), key=_start)
    on, pose = (None, obstacle.world_from_body) if mount is None else (mount.on, mount.pose)
    return Rider(obstacle.name, on, pose, obstacle.moves, tuple(own))


def _start(carry: Carry) -> float:
    return carry.window.start
