"""The errors of a carrier at the moment of a grasp or release, seen from the part.

Not for: which carrier has which part (`hands`), nor how large errors are (`budget`).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from clearance.geometry.pose import inverse
from clearance.world.carrier_error import CarrierError
from clearance.world.forest import WORLD, forest_of, link_poses_at, links_by_name
from clearance.world.phase import Phase
from clearance.world.robot import Joint, JointKind


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
