"""Which bodies move by one clock: those of a tree, of what stands on it, of what it carries at any time, and of
robots that its program moves too.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from clearance.errors import Contradiction
from clearance.world.body import Mount
from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.forest import owner_of
from clearance.world.pairs import OBSTACLE, BodyIndex

NO_CLOCK = -1
"""Of a body that stands."""

_Thing = tuple[bool, int]
"""A robot (False, i) or an obstacle (True, i)."""


def clock_pair(case: Case, one: BodyIndex, other: BodyIndex) -> tuple[int, int] | None:
    """The clocks of two bodies where nothing ties them; None where both move by one, or one of them stands."""
    if case.clock.slack == 0.0:
        return None
    clocks = clocks_of(case)
    a, b = clocks[one.thing], clocks[other.thing]
    return None if NO_CLOCK in (a, b) or a == b else (a, b)


def actors_of_clock(case: Case, body: BodyIndex) -> frozenset[BodyIndex]:
    """The robots (body 0 of each) and the obstacles that move by the clock of a body."""
    clocks = clocks_of(case)
    own = clocks[body.thing]
    return frozenset(
        BodyIndex(OBSTACLE, i) if is_obstacle else BodyIndex(i, 0)
        for (is_obstacle, i), clock in clocks.items()
        if clock == own
    )


@once_a_cell(16)
def clocks_of(case: Case) -> dict[_Thing, int]:
    """The clock of each robot (False, i) and obstacle (True, i): the number of an actor, or `NO_CLOCK`.

    A standing body has none, even if a moving one stands on it.
    """
    below = list(_below(case))
    moving = _moving(case, below)
    clocks = {thing: i for i, thing in enumerate(_things(case))}
    for thing, carrier in (*below, *_driven(case)):
        if carrier in moving:
            old, new = clocks[thing], clocks[carrier]
            clocks |= {one: new for one, clock in clocks.items() if clock == old}
    return {thing: clock if thing in moving else NO_CLOCK for thing, clock in clocks.items()}


def _things(case: Case) -> list[_Thing]:
    robots = [(False, i) for i in range(len(case.robots))]
    return robots + [(True, i) for i in range(len(case.obstacles))]


def _below(case: Case) -> Iterator[tuple[_Thing, _Thing]]:
    """The things that are ever on another, each with that other."""
    names = {obstacle.name: (True, i) for i, obstacle in enumerate(case.obstacles)}
    mounted = [((False, i), robot.mount) for i, robot in enumerate(case.robots)]
    mounted += [((True, i), obstacle.mount) for i, obstacle in enumerate(case.obstacles)]
    carried = [carry for carry in case.carries if carry.part in names]
    mounted += [(names[carry.part], Mount(carry.by)) for carry in carried]
    for thing, mount in mounted:
        if mount is not None:
            yield thing, owner_of(case, mount)


def _driven(case: Case) -> Iterator[tuple[_Thing, _Thing]]:
    """The robots that the program of another one moves, each with that one: one controller has one clock."""
    numbers = {placed.robot.name: i for i, placed in enumerate(case.robots)}
    for i, placed in enumerate(case.robots):
        for name in placed.trajectory.drives if placed.trajectory is not None else ():
            yield (False, numbers[name]), (False, i)


def _moving(case: Case, below: Sequence[tuple[_Thing, _Thing]]) -> set[_Thing]:
    """Robots, what has a motion of its own, and all that is on them at some time."""
    moving = {(False, i) for i in range(len(case.robots))}
    moving |= {(True, i) for i, obstacle in enumerate(case.obstacles) if obstacle.moves}
    for _ in below:
        moving |= {thing for thing, carrier in below if carrier in moving}
    return moving


def require_clocks(case: Case) -> None:
    """Nothing, if a case's windows say when they are, whatever the clocks of its actors.

    Raises:
        BadInput: a window of a rule or an allowance where clocks are not tied, a part that changes clocks, or a
            program whose tool goes with what has another clock.
    """
    if case.clock.slack == 0.0:
        return
    for placed in case.robots:
        if placed.trajectory is not None and placed.trajectory.rides:
            raise Contradiction(
                f"the tool of robot {placed.robot.name!r} goes with {placed.trajectory.rides[0]!r}, and their "
                "clocks are not tied",
                where="clock",
                valid="clock: common, or frames on what stands",
            )
    for field, rows in (("limits.rules", case.limits.rules), ("allow", case.allow)):
        for i, row in enumerate(rows):
            if row.window.ends:
                raise Contradiction(
                    "a window of time where clocks are not tied",
                    where=f"{field}[{i}]",
                    valid="while_carried, no window, or clock: common",
                )
    owners: dict[str, tuple[bool, int]] = {}
    for i, carry in enumerate(case.carries):
        owner = owners.setdefault(carry.part, owner_of(case, Mount(carry.by)))
        if owner != owner_of(case, Mount(carry.by)):
            raise Contradiction(
                f"part {carry.part!r} changes hands between actors whose clocks are not tied",
                where=f"carry[{i}]",
                valid="clock: common, or one actor that carries it",
            )
