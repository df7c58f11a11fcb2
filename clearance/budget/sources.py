"""How each error of a budget moves the nearest points of a pair, to first order, for the estimate.

Every joint, frame, place, surface and clock is a source of its own. Joints that follow another have their leader's
error, times their factor, so its effects on both bodies add up with their signs. Not for: proofs.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import NamedTuple

import numpy as np

from clearance.budget.errors_of import (
    EXACT_JOINT,
    EXACT_ROBOT,
    NOW,
    errors_below,
    surface_of,
)
from clearance.kernels.motion.kinematics import NO_PARENT
from clearance.simulate.answers.point_motion import carrying_links
from clearance.world.body import Obstacle
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.carrier_error import CarrierError
from clearance.world.case import Case
from clearance.world.forest import WORLD, carried_by, forest_of
from clearance.world.mimics import leads_of
from clearance.world.pairs import BodyIndex, Pair
from clearance.world.robot import JointKind

POSITION, TRACKING, FRAME, BASE, PLACE, SURFACE, TIMING = (
    "position", "tracking", "frame", "base", "place", "surface", "timing",
)  # fmt: skip


class SourceKey(NamedTuple):
    """One error of a budget.

    Attributes:
        owner: the robot or obstacle. kind: as in `ErrorSource`. part: the joint or link, or empty.
        moment: as `CarrierError` calls it.
    """

    owner: str
    kind: str
    part: str
    moment: str = NOW


class Slope(NamedTuple):
    """How a distance changes with one error.

    Attributes:
        key: of the error. place: which of its numbers, as in `sizes_of`. size: that number in the budget.
        along: (n, 3), the gradient by a vector, or (n, 1) by a number.
    """

    key: SourceKey
    place: int
    size: float
    along: np.ndarray


@dataclass(frozen=True, eq=False)
class Witness:
    """The nearest points of one pair at some moments.

    Attributes:
        points: (n, 2, 3) [m] in the world. poses: (n, links, 4, 4) `world_from_link` of the case's forest [m].
        rates: for each owner of a clock with an error, (n, links, 4, 4) [1/s] the rates of the poses by it.
    """

    pair: Pair
    points: np.ndarray
    poses: np.ndarray
    rates: Mapping[str, np.ndarray] = field(default_factory=dict)


def sizes_of(budget: Budget, key: SourceKey) -> tuple[float, ...]:
    """The numbers of one error in a budget: an offset [m] and an angle [rad] for frames, else one number."""
    if key.owner in budget.obstacles:
        obstacle = budget.obstacles[key.owner]
        if key.kind == PLACE:
            return obstacle.place.xyz, obstacle.place.angle
        return (obstacle.surface if key.kind == SURFACE else obstacle.timing,)
    robot = budget.robots.get(key.owner, EXACT_ROBOT)
    joint = robot.joints.get(key.part, EXACT_JOINT)
    numbers = {
        FRAME: (joint.frame.xyz, joint.frame.angle),
        BASE: (robot.base.xyz, robot.base.angle),
        POSITION: (joint.position,),
        TRACKING: (joint.tracking,),
        SURFACE: (robot.surfaces.get(key.part, 0.0),),
        TIMING: (robot.timing,),
        PLACE: (0.0, 0.0),
    }
    return numbers[key.kind]


def units_of(case: Case, key: SourceKey) -> tuple[str, ...]:
    """The unit of each of these numbers."""
    if key.kind in (FRAME, BASE, PLACE):
        return "m", "rad"
    if key.kind in (POSITION, TRACKING):
        robot = next(one.robot for one in case.robots if one.robot.name == key.owner)
        kind = next(joint.kind for joint in robot.joints if joint.name == key.part)
        return ("m" if kind is JointKind.PRISMATIC else "rad",)
    return ("s" if key.kind == TIMING else "m",)


def with_sizes(budget: Budget, key: SourceKey, sizes: tuple[float, ...]) -> Budget:
    """The budget with other numbers for one error."""
    if key.owner in budget.robots:
        own = _robot_with(budget.robots[key.owner], key, sizes)
        return replace(budget, robots={**budget.robots, key.owner: own})
    obstacle = _obstacle_with(budget.obstacles[key.owner], key, sizes)
    return replace(budget, obstacles={**budget.obstacles, key.owner: obstacle})


def _robot_with(own: RobotTolerance, key: SourceKey, sizes: tuple[float, ...]) -> RobotTolerance:
    if key.kind == BASE:
        return replace(own, base=PlacementTolerance(*sizes))
    if key.kind == SURFACE:
        return replace(own, surfaces={**own.surfaces, key.part: sizes[0]})
    if key.kind == TIMING:
        return replace(own, timing=sizes[0])
    joint = own.joints.get(key.part, EXACT_JOINT)
    return replace(own, joints={**own.joints, key.part: _joint_with(joint, key, sizes)})


def _joint_with(joint: JointTolerance, key: SourceKey, sizes: tuple[float, ...]) -> JointTolerance:
    if key.kind == FRAME:
        return replace(joint, frame=PlacementTolerance(*sizes))
    if key.kind == POSITION:
        return replace(joint, position=sizes[0])
    return replace(joint, tracking=sizes[0])


def _obstacle_with(
    own: ObstacleTolerance, key: SourceKey, sizes: tuple[float, ...]
) -> ObstacleTolerance:
    if key.kind == PLACE:
        return replace(own, place=PlacementTolerance(*sizes))
    return replace(own, surface=sizes[0]) if key.kind == SURFACE else replace(own, timing=sizes[0])


def slopes(case: Case, budget: Budget, witness: Witness) -> list[Slope]:
    """How the distance of a pair changes with each error of a budget that is not 0, in the order of the chains."""
    between = witness.points[:, 1] - witness.points[:, 0]
    with np.errstate(invalid="ignore", divide="ignore"):
        u = between / np.linalg.norm(between, axis=1)[:, None]
    common = carrying_links(case, witness.pair.a) & carrying_links(
        case, witness.pair.b
    )  # both move alike
    found: dict[tuple[SourceKey, int], np.ndarray] = {}
    for side, body, x in ((-1.0, witness.pair.a, 0), (1.0, witness.pair.b, 1)):
        seen = _Side(body, side * u, witness.points[:, x], witness)
        for key, place, along in _of_body(case, budget, seen, common):
            before = found.get((key, place))
            found[key, place] = along if before is None else before + along
    sizes = {key: sizes_of(budget, key) for key, _ in found}
    return [
        Slope(key, place, sizes[key][place], along)
        for (key, place), along in found.items()
        if sizes[key][place] > 0.0
    ]


class _Side(NamedTuple):
    """One body of a pair: its point x (n, 3) [m] comes nearer against u (n, 3)."""

    body: BodyIndex
    u: np.ndarray
    x: np.ndarray
    witness: Witness


Effects = Iterator[tuple[SourceKey, int, np.ndarray]]
"""Errors, which of their numbers, and the gradient by it."""


def _of_body(case: Case, budget: Budget, side: _Side, common: set[int]) -> Effects:
    """The slopes of one body's errors."""
    body = side.body
    if body.is_obstacle:
        owner, part = case.obstacles[body.i_body].name, ""
    else:
        owner, part = case.robots[body.i_robot].robot.name, body.own_name_in(case)
    if surface_of(case, budget, body) > 0.0:
        yield SourceKey(owner, SURFACE, part), 0, np.full((len(side.x), 1), -1.0)
    frame, names = body.frame_in(case), _LinkNames(case)
    if frame == WORLD:
        obstacle = case.obstacles[body.i_body]
        pose = np.broadcast_to(obstacle.world_from_body, (len(side.x), 4, 4))
        yield from _of_frame(SourceKey(owner, PLACE, ""), side, pose[:, :3, 3])
        yield from names.of_errors(obstacle.past, pose, side)
        return
    yield from _of_clocks(frame, side)
    for link in carried_by(forest_of(case), frame):
        if link in common:
            return
        yield from names.of_link(link, side)


def _of_clocks(frame: int, side: _Side) -> Effects:
    """The motion of a body by errors of clocks; both bodies of a pair add up where they share a clock."""
    pose = side.witness.poses[:, frame]
    x = np.einsum("nji,nj->ni", pose[:, :3, :3], side.x - pose[:, :3, 3])
    for owner, rates in side.witness.rates.items():
        rate = rates[:, frame]
        v = np.einsum("nij,nj->ni", rate[:, :3, :3], x) + rate[:, :3, 3]
        if v.any():
            yield SourceKey(owner, TIMING, ""), 0, np.einsum("ni,ni->n", side.u, v)[:, None]


def _of_frame(key: SourceKey, side: _Side, origin: np.ndarray) -> Effects:
    yield key, 0, side.u
    yield key, 1, np.cross(side.x - origin, side.u)


class _LinkNames:
    """The joint, root or obstacle of each link of a case's forest."""

    def __init__(self, case: Case) -> None:
        self.case, self.forest = case, forest_of(case)
        self.leads = {one.robot.name: leads_of(one.robot) for one in case.robots}
        self.joints, self.roots = {}, {}
        for i, placed in enumerate(case.robots):
            start = self.forest.robot_starts[i]
            links = {name: start + k for k, name in enumerate(placed.robot.link_names)}
            self.roots[start] = placed
            for joint in placed.robot.joints:
                self.joints[links[joint.child]] = placed.robot, joint
        links_of = enumerate(self.forest.obstacle_links)
        self.obstacles = {link: case.obstacles[i] for i, link in links_of if link != WORLD}

    def of_link(self, link: int, side: _Side) -> Effects:
        """The slopes of the joint above a link and of all its carriers."""
        origin, at = self._joined(link, side), side.witness.poses[:, link]
        below: list[CarrierError] = []
        if link in self.joints:
            robot, joint = self.joints[link]
            if joint.kind is not JointKind.FIXED:
                slides = joint.kind is JointKind.PRISMATIC
                own = CarrierError(robot.name, joint.name, np.zeros(3), joint.axis, slides)
                yield from self._of_joint(own, at, side)
            yield from _of_frame(SourceKey(robot.name, FRAME, joint.name), side, origin)
        elif link in self.roots:
            placed = self.roots[link]
            yield from _of_frame(SourceKey(placed.robot.name, BASE, ""), side, origin)
            below += errors_below(self.case, placed.mount)
        elif link in self.obstacles:
            obstacle = self.obstacles[link]
            yield from _of_frame(SourceKey(obstacle.name, PLACE, ""), side, origin)
            if obstacle.moves is None:
                below += [*obstacle.past, *errors_below(self.case, obstacle.mount)]
        for obstacle in self._moving_from(link):
            below += errors_below(self.case, obstacle.mount)
        yield from self.of_errors(below, at, side)

    def _joined(self, link: int, side: _Side) -> np.ndarray:
        """(n, 3) the origin of the frame of a link's joint [m]."""
        links = self.forest.links
        origin, parent = links.parent_from_joint[link][:3, 3], int(links.parents[link])
        if parent == NO_PARENT:
            return np.broadcast_to(origin, side.x.shape)
        pose = side.witness.poses[:, parent]
        return pose[:, :3, 3] + pose[:, :3, :3] @ origin

    def _moving_from(self, link: int) -> Iterator[Obstacle]:
        """Obstacles whose own motion starts from a root."""
        parents = self.forest.links.parents
        if int(parents[link]) == NO_PARENT and link not in self.roots:
            for last, obstacle in self.obstacles.items():
                if obstacle.moves is not None and int(parents[last - 3]) == link:
                    yield obstacle

    def of_errors(self, errors: Iterable[CarrierError], at: np.ndarray, side: _Side) -> Effects:
        """The slopes of errors in the frame of a link or body at poses (n, 4, 4) [m]."""
        for one in errors:
            if one.axis is not None:
                yield from self._of_joint(one, at, side)
                continue
            kind = PLACE if one.owner not in self.leads else FRAME if one.joint else BASE
            origin = at[:, :3, 3] + at[:, :3, :3] @ one.origin
            own = SourceKey(one.owner, kind, one.joint, one.moment)
            for key, place, along in _of_frame(own, side, origin):
                yield key, place, one.sign * along

    def _of_joint(self, one: CarrierError, at: np.ndarray, side: _Side) -> Effects:
        direction = at[:, :3, :3] @ one.axis
        if not one.slides:
            direction = np.cross(direction, side.x - at[:, :3, 3] - at[:, :3, :3] @ one.origin)
        slope = one.sign * np.einsum("ni,ni->n", side.u, direction)[:, None]
        for name, factor in self.leads[one.owner][one.joint]:
            for kind in (POSITION, TRACKING):
                yield SourceKey(one.owner, kind, name, one.moment), 0, factor * slope
