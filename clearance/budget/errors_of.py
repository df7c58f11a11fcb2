"""The errors of a case's budget, laid over the links and bodies that are measured.

Links that are seen from another link (`simulate.measure.layout`) have the errors of the joints between; a part
that has changed hands has those of its carriers at these moments too.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field

import numpy as np

from clearance.errors import BadTolerance
from clearance.geometry.pose import inverse
from clearance.kernels.budget.errors import Errors, Extras
from clearance.kernels.motion.kinematics import NO_PARENT
from clearance.simulate.measure.layout import IN_WORLD, Layout, SeenBody
from clearance.world.body import Mount, Obstacle
from clearance.world.budget import (
    EXACT,
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.carrier_error import CarrierError
from clearance.world.case import Case
from clearance.world.forest import WORLD, forest_of
from clearance.world.mimics import leads_of
from clearance.world.pairs import BodyIndex
from clearance.world.robot import Robot

EXACT_JOINT = JointTolerance()
EXACT_ROBOT = RobotTolerance()
EXACT_OBSTACLE = ObstacleTolerance()

NOW = ""
"""The present moment, as `CarrierError` calls it."""


SizedError = tuple[CarrierError, PlacementTolerance]
"""An error of a carrier, and its size: a joint turns by the angle, or slides by xyz."""

BudgetAt = Callable[[str], Budget]
"""The budget of a moment, as `CarrierError` calls it."""


def robot_tolerance(budget: Budget, robot: Robot) -> RobotTolerance:
    """The tolerances of a robot in a budget."""
    return budget.robots.get(robot.name, EXACT_ROBOT)


def obstacle_tolerance(budget: Budget, obstacle: Obstacle) -> ObstacleTolerance:
    """The tolerances of an obstacle in a budget."""
    return budget.obstacles.get(obstacle.name, EXACT_OBSTACLE)


def errors_below(case: Case, mount: Mount | None) -> Iterator[CarrierError]:
    """The errors of the obstacles below a mount, nearest first, up to one with a motion of its own.

    These are errors of their places now, and of their earlier carriers.
    """
    obstacles = {obstacle.name: obstacle for obstacle in case.obstacles}
    below = np.eye(4)
    while mount is not None and mount.on in obstacles:
        carrier = obstacles[mount.on]
        if carrier.moves is not None:
            return
        below = below @ inverse(mount.pose)
        yield CarrierError(carrier.name, "", below[:3, 3])
        yield from (one.seen_from(below) for one in carrier.past)
        mount = carrier.mount


def size_of(case: Case, budget: Budget, one: CarrierError) -> PlacementTolerance:
    """The size of an error in a budget."""
    robot = next((each.robot for each in case.robots if each.robot.name == one.owner), None)
    if robot is None:
        return budget.obstacles.get(one.owner, EXACT_OBSTACLE).place
    own = robot_tolerance(budget, robot)
    if one.axis is None:
        return own.joints.get(one.joint, EXACT_JOINT).frame if one.joint else own.base
    size = sum(abs(factor) * _size(own, name) for name, factor in leads_of(robot)[one.joint])
    return PlacementTolerance(size, 0.0) if one.slides else PlacementTolerance(0.0, size)


def errors_of(case: Case, budget_at: BudgetAt, layout: Layout) -> Errors:
    """The errors of all links and bodies of a layout."""
    own, origins = _ForestErrors(case, budget_at), layout.origins
    known = origins >= 0
    at = np.maximum(origins, 0)

    def of(column: np.ndarray) -> np.ndarray:
        return np.where(known, column[at], 0.0)

    of_links = [own.extras.get(link, []) for link in origins.tolist()]
    of_bodies = [
        own.of_standing(*body) for body in zip(layout.world.frames, layout.places, strict=True)
    ]
    return Errors(
        of(own.joint),
        of(own.xyz),
        of(own.angle),
        of(own.delay),
        np.where(known, own.owner[at], -1),
        _extras(of_links),
        _extras(of_bodies),
        np.array([surface_of(case, own.budget, place.body) for place in layout.places]),
        _most_rows(layout, of_links, of_bodies),
    )


@dataclass(eq=False)
class _ForestErrors:
    """The errors of the links of a case's forest."""

    case: Case
    budget_at: BudgetAt
    extras: dict[int, list[SizedError]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self.forest, self.budget = forest_of(self.case), self.budget_at(NOW)
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
        self._add_errors(start, errors_below(self.case, placed.mount))

    def _add_obstacle(self, i_obstacle: int) -> None:
        link = self.forest.obstacle_links[i_obstacle]
        if link == WORLD:
            return
        obstacle = self.case.obstacles[i_obstacle]
        own = obstacle_tolerance(self.budget, obstacle)
        self._place(link, own.place)
        if obstacle.moves is None:
            self._add_errors(link, [*obstacle.past, *errors_below(self.case, obstacle.mount)])
            return
        for part in range(link - 3, link + 1):
            self._delay(part, own.timing, len(self.case.robots) + i_obstacle)
        self._add_errors_below_moving(link - 3, obstacle)

    def _add_errors_below_moving(self, first: int, obstacle: Obstacle) -> None:
        """Adds the errors of carriers of a body with a motion of its own to the link where that starts."""
        base = int(self.forest.links.parents[first])
        if self.forest.links.parents[base] == NO_PARENT:
            self._add_errors(base, errors_below(self.case, obstacle.mount))
            return
        for one, _ in self._sized(errors_below(self.case, obstacle.mount)):
            on = obstacle.mount.on if obstacle.mount is not None else one.owner
            raise BadTolerance(
                f"obstacle {obstacle.name!r} moves by its own table on {on!r}, which moves too",
                where="tolerance.obstacles",
                valid=f"no place tolerance of {one.owner!r}; give it to {obstacle.name!r}",
            )

    def _place(self, link: int, place: PlacementTolerance) -> None:
        self.xyz[link], self.angle[link] = place.xyz, place.angle

    def _delay(self, link: int, delay: float, owner: int) -> None:
        if delay > 0.0:
            self.delay[link], self.owner[link] = delay, owner

    def _add_errors(self, link: int, errors: Iterable[CarrierError]) -> None:
        if sized := self._sized(errors):
            self.extras[link] = sized

    def _sized(self, errors: Iterable[CarrierError]) -> list[SizedError]:
        """The errors that are not 0, with their sizes."""
        sizes = ((one, size_of(self.case, self.budget_at(one.moment), one)) for one in errors)
        return [(one, size) for one, size in sizes if size != EXACT]

    def of_standing(self, frame: int, seen: SeenBody) -> list[SizedError]:
        """The errors of a body that stands in the world; none for others."""
        if frame >= 0 or seen.reference != IN_WORLD or not seen.body.is_obstacle:
            return []
        obstacle = self.case.obstacles[seen.body.i_body]
        return self._sized([CarrierError(obstacle.name, "", np.zeros(3)), *obstacle.past])


def _size(own: RobotTolerance, joint: str) -> float:
    """[rad or m] The total error of a joint by itself."""
    tolerance = own.joints.get(joint, EXACT_JOINT)
    return tolerance.position + tolerance.tracking


def surface_of(case: Case, budget: Budget, body: BodyIndex) -> float:
    """[m] The greatest excess of the surface of a body."""
    if body.is_obstacle:
        return obstacle_tolerance(budget, case.obstacles[body.i_body]).surface
    robot = case.robots[body.i_robot].robot
    return robot_tolerance(budget, robot).surfaces.get(body.own_name_in(case), 0.0)


def _extras(sized: Sequence[Sequence[SizedError]]) -> Extras:
    flat = [one for errors in sized for one in errors]
    origins = np.array([one.origin for one, _ in flat], dtype=np.float64).reshape(-1, 3)
    axes = [np.zeros(3) if one.axis is None else one.axis for one, _ in flat]
    return Extras(
        np.concatenate([[0], np.cumsum([len(errors) for errors in sized])]).astype(np.int64),
        origins,
        np.array([size.xyz for _, size in flat], dtype=np.float64),
        np.array([size.angle for _, size in flat], dtype=np.float64),
        np.array(axes, dtype=np.float64).reshape(-1, 3),
    )


def _most_rows(
    layout: Layout,
    of_links: Sequence[Sequence[SizedError]],
    of_bodies: Sequence[Sequence[SizedError]],
) -> int:
    """The most rows of any body: three a link, one for motion together, and further errors."""
    parents = layout.world.links.parents
    rows = np.zeros(len(parents), dtype=np.int64)
    for link, parent in enumerate(parents.tolist()):  # parents come first
        own = 3 + len(of_links[link])
        rows[link] = own if parent == NO_PARENT else own + rows[parent]
    return max(int(rows.max(initial=0)), *map(len, of_bodies)) + 2
