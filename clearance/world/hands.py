"""Parts in a phase: in somebody's hands, or where they were let go, and the errors of grasps and releases."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.geometry.pose import inverse
from clearance.world.body import Mount, Obstacle
from clearance.world.carrier_error import GRASP, RELEASE, CarrierError, followed_by
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of, link_poses_at, links_by_name
from clearance.world.phase import Phase
from clearance.world.robot import Joint, JointKind


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


@dataclass(frozen=True, eq=False)
class Grip:
    """A step of a phase at which a part is gripped or released.

    Attributes:
        world_from_part: (4, 4) [m] where that is. deed: as of `CarrierError`.
    """

    phase: Phase
    step: int
    world_from_part: np.ndarray
    deed: str

    def errors_on(self, name: str) -> Iterator[CarrierError]:
        """The errors of a link or obstacle and of all its carriers, from there to the base."""
        case = self.phase.case
        carrier = next((one for one in case.obstacles if one.name == name), None)
        if carrier is None:
            yield from self._of_robot(*links_by_name(case)[name])
            return
        link = forest_of(case).link_called(case, name)
        at = self._seen(carrier.world_from_body if link == WORLD else self._poses[link])
        yield self._frame(name, "", at)
        yield from (one.seen_from(at) for one in carrier.past)
        if carrier.mount is not None:
            yield from self.errors_on(carrier.mount.on)

    def against(self, name: str) -> list[CarrierError]:
        """The same errors of the gripper, inverse: from the base to there."""
        return [replace(one, inverse=not one.inverse) for one in reversed([*self.errors_on(name)])]

    def _of_robot(self, i_robot: int, i_link: int) -> Iterator[CarrierError]:
        placed, start = (
            self.phase.case.robots[i_robot],
            forest_of(self.phase.case).robot_starts[i_robot],
        )
        robot = placed.robot
        above = {joint.child: joint for joint in robot.joints}
        seen = {name: self._seen(self._poses[start + i]) for i, name in enumerate(robot.link_names)}
        link = robot.link_names[i_link]
        while link in above:
            joint = above[link]
            if joint.kind is not JointKind.FIXED:
                yield self._joint(robot.name, joint, seen[link])
            yield self._frame(robot.name, joint.name, seen[joint.parent] @ joint.parent_from_joint)
            link = joint.parent
        yield self._frame(robot.name, "", seen[link])
        if placed.mount is not None:
            yield from self.errors_on(placed.mount.on)

    def _joint(self, robot: str, joint: Joint, at: np.ndarray) -> CarrierError:
        """The point of its axis is the one that is nearest to the part's origin."""
        axis = at[:3, :3] @ joint.axis
        origin = at[:3, 3] - (axis @ at[:3, 3]) * axis
        slides = joint.kind is JointKind.PRISMATIC
        return CarrierError(robot, joint.name, origin, axis, slides, self.deed, self._time)

    def _frame(self, owner: str, joint: str, at: np.ndarray) -> CarrierError:
        return CarrierError(owner, joint, at[:3, 3], deed=self.deed, time=self._time)

    def _seen(self, world_from_other: np.ndarray) -> np.ndarray:
        return inverse(self.world_from_part) @ world_from_other

    @property
    def _time(self) -> float:
        return float(self.phase.times[self.step])

    @cached_property
    def _poses(self) -> np.ndarray:
        """(links, 4, 4) [m] of the case's forest."""
        here = slice(self.step, self.step + 1)
        return link_poses_at(self.phase.case, self.phase.motions, here)[0]
