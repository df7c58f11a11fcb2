"""Parts in a phase: in somebody's hands, or where they were let go. Not for: when that is (`timeline`)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from clearance.geometry.pose import inverse
from clearance.world.body import Obstacle
from clearance.world.carrier_error import GRASP, RELEASE, CarrierError, followed_by
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of, link_poses_at
from clearance.world.grips import Grip
from clearance.world.mount import Mount
from clearance.world.phase import Phase


def with_parts(phase: Phase, before: Sequence[Phase]) -> Phase:
    """The phase with its parts where they are: in somebody's hands, or where they were let go."""
    case, last = phase.case, before[-1] if before else None
    if last is not None:
        case = _laid_down_as_they_were(phase, last, frozenset(p for b in before for p in b.carried))
    for carry in _carriers_first(phase.carried):
        if last is None or last.carried.get(carry.part) is not carry:
            case = _picked_up(replace(phase, case=case), carry, last)
    return phase if case is phase.case else replace(phase, case=case)


def _laid_down_as_they_were(phase: Phase, last: Phase, parts: frozenset[str]) -> Case:
    """The case with parts that have been carried where the phase before has them, in the same hands or in none."""
    if not parts:
        return phase.case
    found = []
    for here, then in zip(phase.case.obstacles, last.case.obstacles, strict=True):
        carry = last.carried.get(here.name)
        if carry is not None and carry is not phase.carried.get(here.name):
            at_end = _pose_of(last, here.name, last.n_steps - 1)
            past = _let_go(last, then, at_end)
            found.append(Obstacle(here.body, at_end, padding=here.padding, past=past))
        else:
            found.append(then if here.name in parts else here)
    return replace(phase.case, obstacles=tuple(found))


def _carriers_first(carried: Mapping[str, Carry]) -> list[Carry]:
    """The parts in hand, each after what carries it."""
    order: dict[str, Carry] = {}

    def add(carry: Carry, above: tuple[str, ...]) -> None:
        if carry.by in carried and carry.by not in above:
            add(carried[carry.by], (*above, carry.part))
        order.setdefault(carry.part, carry)

    for carry in carried.values():
        add(carry, (carry.part,))
    return list(order.values())


def _picked_up(phase: Phase, carry: Carry, last: Phase | None) -> Case:
    """The case with a part on what carries it, at the pose that it has there when it is picked up."""
    carrying = phase if last is None else last
    step = 0 if last is None else last.n_steps - 1
    world_from_part = _pose_of(carrying, carry.part, step)
    world_from_by = _pose_of(phase, carry.by, 0)
    mount = Mount(carry.by, inverse(world_from_by) @ world_from_part)
    then, now = (Grip(*at, world_from_part, GRASP) for at in ((carrying, step), (phase, 0)))
    obstacles = tuple(
        Obstacle(o.body, mount=mount, padding=o.padding, past=_gripped(o, carry, then, now))
        if o.name == carry.part
        else o
        for o in phase.case.obstacles
    )
    return replace(phase.case, obstacles=obstacles)


def _gripped(part: Obstacle, carry: Carry, then: Grip, now: Grip) -> tuple[CarrierError, ...]:
    """The errors of the past that a part has once it is picked up, those of what it lay on until then too."""
    if now.phase.case.tolerance is None or carry.exact_grasp:
        return ()
    under = () if part.mount is None else then.errors_on(part.mount.on)
    return followed_by(followed_by(part.past, under), now.against(carry.by))


def _let_go(last: Phase, part: Obstacle, world_from_part: np.ndarray) -> tuple[CarrierError, ...]:
    """The same once it is let go, at the end of the phase in which it was carried."""
    if last.case.tolerance is None or part.mount is None:
        return ()
    grip = Grip(last, last.n_steps - 1, world_from_part, RELEASE)
    return followed_by(part.past, grip.errors_on(part.mount.on))


def _pose_of(phase: Phase, name: str, step: int) -> np.ndarray:
    """(4, 4) `world_from_…` [m] of an obstacle or a link at one of a phase's own steps."""
    link = forest_of(phase.case).link_called(phase.case, name)
    if link == WORLD:
        return next(o.world_from_body for o in phase.case.obstacles if o.name == name)
    return link_poses_at(phase.case, phase.motions, slice(step, step + 1))[0, link]
