"""Which bodies move by one clock: those of a tree, of what stands on it, and of what it carries at any time."""

from __future__ import annotations

from functools import lru_cache

from clearance.errors import BadInput
from clearance.world.case import Case
from clearance.world.forest import resolved_mount
from clearance.world.mount import Mount
from clearance.world.pairs import BodyIndex

NO_CLOCK = -1
"""Of a body that stands."""


def are_tied(case: Case, one: BodyIndex, other: BodyIndex) -> bool:
    """True if two bodies are where they are at the same time: by one clock, or since one of them stands."""
    if case.clock.slack == 0.0:
        return True
    clocks = clocks_of(case)
    a, b = clocks[one.is_obstacle, _index(one)], clocks[other.is_obstacle, _index(other)]
    return NO_CLOCK in (a, b) or a == b


def _index(body: BodyIndex) -> int:
    return body.i_body if body.is_obstacle else body.i_robot


@lru_cache(maxsize=16)
def clocks_of(case: Case) -> dict[tuple[bool, int], int]:
    """The clock of each robot (False, i) and obstacle (True, i): the number of an actor, or `NO_CLOCK`.

    Raises:
        BadInput: a part that is carried by actors of different clocks, or that has a motion of its own as well.
    """
    clocks = {(False, i): i for i in range(len(case.robots))}
    for i, obstacle in enumerate(case.obstacles):
        clocks[True, i] = NO_CLOCK if obstacle.stands else len(case.robots) + i
    names = {obstacle.name: (True, i) for i, obstacle in enumerate(case.obstacles)}
    mounted = [((False, i), robot.mount) for i, robot in enumerate(case.robots)]
    mounted += [((True, i), obstacle.mount) for i, obstacle in enumerate(case.obstacles)]
    mounted += [
        (names[carry.part], Mount(carry.by)) for carry in case.carries if carry.part in names
    ]
    for thing, mount in mounted:
        if mount is not None:
            _join(clocks, thing, _owner(case, mount))
    return clocks


def _join(
    clocks: dict[tuple[bool, int], int], thing: tuple[bool, int], below: tuple[bool, int]
) -> None:
    """Puts two things on one clock."""
    old, new = clocks[thing], clocks[below]
    if NO_CLOCK in (old, new):
        clocks[thing] = clocks[below] = max(old, new)
        return
    for key, clock in clocks.items():
        if clock == old:
            clocks[key] = new


def _owner(case: Case, mount: Mount) -> tuple[bool, int]:
    """What a mount is on."""
    on = resolved_mount(case, mount).on
    for i, obstacle in enumerate(case.obstacles):
        if obstacle.name == on:
            return True, i
    names = [placed.robot.name for placed in case.robots]
    return False, names.index(on.split("/")[0]) if len(names) > 1 or "/" in on else 0


def require_clocks(case: Case) -> None:
    """Nothing, if a case's windows say when they are, whatever the clocks of its actors.

    Raises:
        BadInput: a window of a rule or an allowance where clocks are not tied, or a part that changes clocks.
    """
    if case.clock.slack == 0.0:
        return
    for field, rows in (("limits.rules", case.limits.rules), ("allow", case.allow)):
        for i, row in enumerate(rows):
            if row.window.ends:
                raise BadInput(
                    "a window of time where clocks are not tied",
                    where=f"{field}[{i}]",
                    valid="while_carried, no window, or clock: common",
                )
    owners: dict[str, tuple[bool, int]] = {}
    for i, carry in enumerate(case.carries):
        owner = owners.setdefault(carry.part, _owner(case, Mount(carry.by)))
        if owner != _owner(case, Mount(carry.by)):
            raise BadInput(
                f"part {carry.part!r} changes hands between actors whose clocks are not tied",
                where=f"carry[{i}]",
                valid="clock: common, or one actor that carries it",
            )
