"""All robots of a case as they move: those with programs are read when what their frames are on is read.

Not for: one robot (`robots`), and what a program may move (`driven_robots`).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence

from clearance.case.allow import carries_of
from clearance.case.driven_robots import Surroundings, require_as_read
from clearance.case.robots import InMotion, RobotReader
from clearance.errors import UnknownPlace, at
from clearance.formats.schema import case as schema
from clearance.world.body import Obstacle


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
    carries, driven = carries_of(given.carry, [one.name for one in obstacles]), set[str]()

    def around(i_robot: int) -> Surroundings:
        """All but one robot, of what is read."""
        others = tuple(one.placed for i, one in found.items() if i != i_robot)
        return Surroundings(others, tuple(obstacles), carries, frozenset(driven))

    waiting = [i for i, has in enumerate(has_program) if has]
    while waiting:
        i, made = _next_read(reader, entries, waiting, around)
        waiting.remove(i)
        for j, one in found.items():
            if one.placed.robot.name in made.driven:
                found[j] = one._replace(placed=made.driving(one.placed))
        found[i] = made
        driven |= made.driven.keys()
    for i, entry in enumerate(entries):
        if not has_program[i]:
            continue
        with at(f"{entry.trajectory_field}.program"):
            require_as_read(found[i].placed, around(i))
    return [found[i] for i in range(len(entries))]


def _next_read(
    reader: RobotReader,
    entries: Sequence[schema.RobotEntry],
    waiting: Sequence[int],
    around: Callable[[int], Surroundings],
) -> tuple[int, InMotion]:
    """The first robot with a program whose frames are on what is read, and how it moves.

    Raises:
        UnknownPlace: there is none.
    """
    unknown: UnknownPlace | None = None
    for i in waiting:
        n_notes = len(reader.notes)
        try:
            return i, reader.moving(entries[i], around(i))
        except UnknownPlace as fault:
            unknown = unknown or fault
            del reader.notes[n_notes:]
    assert unknown is not None
    raise unknown
