"""The errors of a case's budget, laid over the links and bodies that are measured.

Links that are seen from another link (`simulate.layout`) have the errors of the joints between. Not for: what the
errors do to a distance (`kernels.budget`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import field

import numpy as np

from clearance.errors import BadInput
from clearance.geometry.pose import inverse
from clearance.kernels.budget.errors import Errors, Extras
from clearance.kernels.motion.kinematics import NO_PARENT
from clearance.late_dataclass import dataclass
from clearance.simulate.layout import IN_WORLD, Layout
from clearance.world.body import Obstacle
from clearance.world.budget import (
    EXACT,
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of
from clearance.world.mimics import leads_of
from clearance.world.mount import Mount
from clearance.world.pairs import BodyIndex
from clearance.world.robot import Robot

EXACT_JOINT = JointTolerance()
EXACT_ROBOT = RobotTolerance()
EXACT_OBSTACLE = ObstacleTolerance()


@dataclass(frozen=True)
class HeldFrame:
    """A frame on which something hangs.

    Attributes:
        owner: the obstacle whose place it is. origin: (3,) [m] in the frame of what hangs there.
        place: how far it may be off.
    """

    owner: str
    origin: np.ndarray
    place: PlacementTolerance


def robot_tolerance(budget: Budget, robot: Robot) -> RobotTolerance:
    """What a budget gives of a robot."""
    return budget.robots.get(robot.name, EXACT_ROBOT)


def obstacle_tolerance(budget: Budget, obstacle: Obstacle) -> ObstacleTolerance:
    """What a budget gives of an obstacle."""
    return budget.obstacles.get(obstacle.name, EXACT_OBSTACLE)


def held_frames(case: Case, budget: Budget, mount: Mount | None) -> Iterator[HeldFrame]:
    """The places of the obstacles that something rides on, nearest first, up to one with a motion of its own."""
    obstacles = {obstacle.name: obstacle for obstacle in case.obstacles}
    below = np.eye(4)
    while mount is not None and mount.on in obstacles:
        carrier = obstacles[mount.on]
        if carrier.moves is not None:
            return
        below = below @ inverse(mount.pose)
        yield HeldFrame(carrier.name, below[:3, 3], obstacle_tolerance(budget, carrier).place)
        mount = carrier.mount


def errors_of(case: Case, budget: Budget, layout: Layout) -> Errors:
    """The errors of all links and bodies of a layout."""
    own, origins = _ForestErrors(case, budget), layout.origins
    known = origins >= 0
    at = np.maximum(origins, 0)

    def of(column: np.ndarray) -> np.ndarray:
        return np.where(known, column[at], 0.0)

    of_links = [own.extras.get(link, []) for link in origins.tolist()]
    return Errors(
        of(own.joint),
        of(own.xyz),
        of(own.angle),
        of(own.delay),
        np.where(known, own.owner[at], -1),
        _extras(of_links),
        _extras(_of_bodies(case, budget, layout)),
        np.array([surface_of(case, budget, place.body) for place in layout.places]),
        _most_rows(layout, of_links),
    )


@dataclass(eq=False)
class _ForestErrors:
    """The errors of the links of a case's forest."""

    case: Case
    budget: Budget
    extras: dict[int, list[HeldFrame]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.forest = forest_of(self.case)
        n_links = len(self.forest.links.parents)
        self.joint, self.xyz, self.angle, self.delay = np.zeros((4, n_links))
        self.owner = np.full(n_links, -1)
        for i in range(len(self.case.robots)):
            self._add_robot(i)
        for i in range(len(self.case.obstacles)):
            self._add_obstacle(i)

    def _add_robot(self, i_robot: int) -> None:
        placed, start = self.case.robots[i_robot], self.forest.robot_starts[i_robot]
        robot, own = placed.robot, robot_tolerance(self.budget, placed.robot)
        links = {name: start + k for k, name in enumerate(robot.link_names)}
        for joint in robot.joints:
            self._place(links[joint.child], own.joints.get(joint.name, EXACT_JOINT).frame)
            if joint.name in leads_of(robot):
                leads = leads_of(robot)[joint.name]
                self.joint[links[joint.child]] = sum(abs(f) * _size(own, name) for name, f in leads)
                self._delay(links[joint.child], own.timing, i_robot)
        self._place(start, own.base)
        self._hold(start, placed.mount)

    def _add_obstacle(self, i_obstacle: int) -> None:
        link = self.forest.obstacle_links[i_obstacle]
        if link == WORLD:
            return
        obstacle = self.case.obstacles[i_obstacle]
        own = obstacle_tolerance(self.budget, obstacle)
        self._place(link, own.place)
        if obstacle.moves is None:
            self._hold(link, obstacle.mount)
            return
        for part in range(link - 3, link + 1):
            self._delay(part, own.timing, len(self.case.robots) + i_obstacle)
        self._hold_moving(link - 3, obstacle)

    def _hold_moving(self, first: int, obstacle: Obstacle) -> None:
        """What a body with a motion of its own rides on holds the link that its motion starts from."""
        base = int(self.forest.links.parents[first])
        if self.forest.links.parents[base] == NO_PARENT:
            self._hold(base, obstacle.mount)
            return
        held = [one for one in held_frames(self.case, self.budget, obstacle.mount)]
        if any(one.place != EXACT for one in held):
            raise BadInput(
                f"obstacle {obstacle.name!r} moves by its own table on {held[0].owner!r}, which moves too",
                where="tolerance.obstacles",
                valid=f"no place tolerance of {held[0].owner!r}; give it to {obstacle.name!r}",
            )

    def _place(self, link: int, place: PlacementTolerance) -> None:
        self.xyz[link], self.angle[link] = place.xyz, place.angle

    def _delay(self, link: int, delay: float, owner: int) -> None:
        if delay > 0.0:
            self.delay[link], self.owner[link] = delay, owner

    def _hold(self, link: int, mount: Mount | None) -> None:
        held = [one for one in held_frames(self.case, self.budget, mount) if one.place != EXACT]
        if held:
            self.extras[link] = held


def _size(own: RobotTolerance, joint: str) -> float:
    """[rad or m] What a joint may be off in all, by itself."""
    tolerance = own.joints.get(joint, EXACT_JOINT)
    return tolerance.position + tolerance.tracking


def _of_bodies(case: Case, budget: Budget, layout: Layout) -> list[list[HeldFrame]]:
    """The places of the bodies that stand in the world."""
    found: list[list[HeldFrame]] = []
    for frame, seen in zip(layout.world.frames.tolist(), layout.places, strict=True):
        if frame >= 0 or seen.reference != IN_WORLD or not seen.body.is_obstacle:
            found.append([])
            continue
        obstacle = case.obstacles[seen.body.i_body]
        place = obstacle_tolerance(budget, obstacle).place
        found.append([] if place == EXACT else [HeldFrame(obstacle.name, np.zeros(3), place)])
    return found


def surface_of(case: Case, budget: Budget, body: BodyIndex) -> float:
    """[m] How far the surface of a body may stand out."""
    if body.is_obstacle:
        return obstacle_tolerance(budget, case.obstacles[body.i_body]).surface
    robot = case.robots[body.i_robot].robot
    return robot_tolerance(budget, robot).surfaces.get(body.own_name_in(case), 0.0)


def _extras(held: Sequence[Sequence[HeldFrame]]) -> Extras:
    flat = [frame for frames in held for frame in frames]
    origins = np.array([frame.origin for frame in flat], dtype=np.float64).reshape(-1, 3)
    return Extras(
        np.concatenate([[0], np.cumsum([len(frames) for frames in held])]).astype(np.int64),
        origins,
        np.array([frame.place.xyz for frame in flat], dtype=np.float64),
        np.array([frame.place.angle for frame in flat], dtype=np.float64),
    )


def _most_rows(layout: Layout, held: Sequence[Sequence[HeldFrame]]) -> int:
    """Rows that any body can have: three a link, one for what moves together, and what is held."""
    parents = layout.world.links.parents
    rows = np.zeros(len(parents), dtype=np.int64)
    for link, parent in enumerate(parents.tolist()):  # parents come first
        own = 3 + len(held[link])
        rows[link] = own if parent == NO_PARENT else own + rows[parent]
    return int(rows.max(initial=0)) + 2
