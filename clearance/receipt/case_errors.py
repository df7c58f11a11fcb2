"""The tolerances of a case as plain numbers for a proof, link by link. Not for: what they leave (`proof`).

The model is that of `clearance.budget`; how it is laid over the links is worked out here once more.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from clearance.geometry.pose import inverse
from clearance.receipt.proof.motion_data import Errors, MountFrames
from clearance.world.body import Mount, Obstacle
from clearance.world.budget import EXACT, JointTolerance, PlacementTolerance, RobotTolerance
from clearance.world.case import Case
from clearance.world.forest import WORLD, Forest, forest_of
from clearance.world.mimics import leads_of
from clearance.world.pairs import BodyIndex
from clearance.world.placed_robot import PlacedRobot

NO_AXIS = np.zeros(3)


class Row(NamedTuple):
    """What a link or body stands on, or has stood on.

    Attributes:
        which: link or body. origin: [m] of what it stands on, in its own frame. size: how far that may be off.
        axis: of a joint, about or along which; 0 of a frame.
    """

    which: int
    origin: np.ndarray
    size: PlacementTolerance
    axis: np.ndarray = NO_AXIS


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
        rows += _carriers(case, start, placed.mount)
    for obstacle, link in zip(case.obstacles, forest.obstacle_links, strict=True):
        if link != WORLD:
            places[link] = _place_of(case, obstacle.name)
            first = (
                link if obstacle.moves is None else link - 3
            )  # three slides before the ball joint
            rows += _hands(case, first, obstacle, np.eye(4))
            rows += _carriers(case, first, obstacle.mount)
    return Errors(
        joint,
        np.array([place.xyz for place in places]),
        np.array([place.angle for place in places]),
        _mount_frames(rows),
        _mount_frames(_standing(case, forest, bodies)),
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
        if one.name in leads:
            joint[links[one.child]] = _joint_of(own, leads[one.name])


def _carriers(case: Case, which: int, mount: Mount | None) -> Iterator[Row]:
    """The obstacles that something stands on, the nearest first, up to one that moves by itself.

    Each is followed by the hands that it has gone through.
    """
    named = {obstacle.name: obstacle for obstacle in case.obstacles}
    pose = np.eye(4)
    while mount is not None and mount.on in named and named[mount.on].moves is None:
        carrier = named[mount.on]
        pose = pose @ inverse(mount.pose)
        yield Row(which, pose[:3, 3], _place_of(case, carrier.name))
        yield from _hands(case, which, carrier, pose)
        mount = carrier.mount


def _hands(case: Case, which: int, part: Obstacle, pose: np.ndarray) -> Iterator[Row]:
    """What was off of all that has gripped a part, seen from what stands on it, which sees it at a pose [m]."""
    assert case.tolerance is not None
    leads = {placed.robot.name: leads_of(placed.robot) for placed in case.robots}
    for one in part.past:
        at = pose[:3, :3] @ one.origin + pose[:3, 3]
        if one.axis is None:
            yield Row(which, at, _frame_of(case, one.owner, one.joint))
            continue
        own = case.tolerance.robots.get(one.owner, RobotTolerance())
        size = _joint_of(own, leads[one.owner][one.joint])
        most = PlacementTolerance(size, 0.0) if one.slides else PlacementTolerance(0.0, size)
        yield Row(which, at, most, pose[:3, :3] @ one.axis)


def _standing(case: Case, forest: Forest, bodies: Sequence[BodyIndex]) -> Iterator[Row]:
    """The places of obstacles that no link carries, and the hands that they have gone through."""
    for i, body in enumerate(bodies):
        if body.is_obstacle and forest.obstacle_links[body.i_body] == WORLD:
            obstacle = case.obstacles[body.i_body]
            yield Row(i, np.zeros(3), _place_of(case, obstacle.name))
            yield from _hands(case, i, obstacle, np.eye(4))


def _mount_frames(rows: Iterable[Row]) -> MountFrames:
    inexact = [row for row in rows if row.size != EXACT]
    return MountFrames(
        np.array([row.which for row in inexact], dtype=np.int64),
        np.array([row.origin for row in inexact], dtype=np.float64).reshape(-1, 3),
        np.array([row.size.xyz for row in inexact]),
        np.array([row.size.angle for row in inexact]),
        np.array([row.axis for row in inexact], dtype=np.float64).reshape(-1, 3),
    )


def _place_of(case: Case, name: str) -> PlacementTolerance:
    assert case.tolerance is not None
    own = case.tolerance.obstacles.get(name)
    return EXACT if own is None else own.place


def _frame_of(case: Case, owner: str, joint: str) -> PlacementTolerance:
    """Of a joint's frame, of a robot's base, or the place of an obstacle."""
    assert case.tolerance is not None
    own = case.tolerance.robots.get(owner)
    if own is None:
        return _place_of(case, owner)
    return own.joints.get(joint, JointTolerance()).frame if joint else own.base


def _joint_of(own: RobotTolerance, leads: Iterable[tuple[str, float]]) -> float:
    """[rad or m] of a joint, itself and what it follows by their factors."""
    given = ((own.joints.get(name, JointTolerance()), abs(factor)) for name, factor in leads)
    return sum(factor * (one.position + one.tracking) for one, factor in given)
