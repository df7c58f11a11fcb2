"""The tolerances of a case as plain numbers for a proof, link by link. Not for: what they leave (`proof`).

The model is that of `clearance.budget`; how it is laid over the links is worked out here once more.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from clearance.geometry.pose import inverse
from clearance.receipt.proof.motion_data import Errors, MountFrames
from clearance.world.budget import EXACT, Budget, JointTolerance, PlacementTolerance, RobotTolerance
from clearance.world.case import Case, PlacedRobot
from clearance.world.forest import WORLD, Forest, forest_of
from clearance.world.mimics import leads_of
from clearance.world.mount import Mount
from clearance.world.pairs import BodyIndex

Row = tuple[int, np.ndarray, PlacementTolerance]
"""A link or body; where in its frame what it stands on has its origin [m]; how far that may be off."""


def is_covered(case: Case) -> bool:
    """True if a case has tolerances, and all of them can be proven again: clocks that may be off cannot."""
    budget = case.tolerance
    if budget is None:
        return False
    late = [one.timing for one in budget.robots.values()]
    return not any([*late, *(one.timing for one in budget.obstacles.values())])


def errors_of(case: Case, bodies: Sequence[BodyIndex]) -> Errors:
    """How far the links of a case in which nothing changes hands may be off, and its bodies that stand."""
    budget = case.tolerance
    assert budget is not None
    forest = forest_of(case)
    n_links = len(forest.links.parents)
    joint, places = np.zeros(n_links), [EXACT] * n_links
    rows: list[Row] = []
    for placed, start in zip(case.robots, forest.robot_starts, strict=True):
        own = budget.robots.get(placed.robot.name, RobotTolerance())
        _lay_robot(placed, start, own, joint, places)
        rows += [(start, at, place) for at, place in _carriers(case, budget, placed.mount)]
    for obstacle, link in zip(case.obstacles, forest.obstacle_links, strict=True):
        if link != WORLD:
            places[link] = _place_of(budget, obstacle.name)
            first = (
                link if obstacle.moves is None else link - 3
            )  # three slides before the ball joint
            rows += [(first, at, place) for at, place in _carriers(case, budget, obstacle.mount)]
    return Errors(
        joint,
        np.array([place.xyz for place in places]),
        np.array([place.angle for place in places]),
        _held(rows),
        _held(_standing(case, budget, forest, bodies)),
    )


def surfaces_of(case: Case, bodies: Sequence[BodyIndex]) -> np.ndarray:
    """(bodies,) [m] how far the surface of each may stand out."""
    budget = case.tolerance
    assert budget is not None
    found = []
    for body in bodies:
        name = body.own_name_in(case)
        if body.is_obstacle:
            found.append(budget.obstacles[name].surface if name in budget.obstacles else 0.0)
        else:
            own = budget.robots.get(case.robots[body.i_robot].robot.name)
            found.append(0.0 if own is None else own.surfaces.get(name, 0.0))
    return np.array(found)


def _lay_robot(
    placed: PlacedRobot,
    start: int,
    own: RobotTolerance,
    joint: np.ndarray,
    places: list[PlacementTolerance],
) -> None:
    robot = placed.robot
    links = {name: start + i for i, name in enumerate(robot.link_names)}
    leads = leads_of(robot)
    places[start] = own.base
    for one in robot.joints:
        places[links[one.child]] = own.joints.get(one.name, JointTolerance()).frame
        for name, factor in leads.get(one.name, ()):
            lead = own.joints.get(name, JointTolerance())
            joint[links[one.child]] += abs(factor) * (lead.position + lead.tracking)


def _place_of(budget: Budget, name: str) -> PlacementTolerance:
    return budget.obstacles[name].place if name in budget.obstacles else EXACT


def _carriers(
    case: Case, budget: Budget, mount: Mount | None
) -> Iterator[tuple[np.ndarray, PlacementTolerance]]:
    """The obstacles that something stands on, the nearest first, up to one that moves by itself: where each has
    its origin [m], seen from what stands there, and how far it may be off.
    """
    named = {obstacle.name: obstacle for obstacle in case.obstacles}
    pose = np.eye(4)
    while mount is not None and mount.on in named and named[mount.on].moves is None:
        carrier = named[mount.on]
        pose = pose @ inverse(mount.pose)
        yield pose[:3, 3], _place_of(budget, carrier.name)
        mount = carrier.mount


def _standing(
    case: Case, budget: Budget, forest: Forest, bodies: Sequence[BodyIndex]
) -> Iterator[Row]:
    """The places of obstacles that no link carries."""
    for i, body in enumerate(bodies):
        if body.is_obstacle and forest.obstacle_links[body.i_body] == WORLD:
            yield i, np.zeros(3), _place_of(budget, case.obstacles[body.i_body].name)


def _held(rows: Sequence[Row] | Iterator[Row]) -> MountFrames:
    kept = [row for row in rows if row[2] != EXACT]
    return MountFrames(
        np.array([which for which, _, _ in kept], dtype=np.int64),
        np.array([at for _, at, _ in kept], dtype=np.float64).reshape(-1, 3),
        np.array([place.xyz for _, _, place in kept]),
        np.array([place.angle for _, _, place in kept]),
    )
