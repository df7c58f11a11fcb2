"""A machine that is off, many samples at once: where errors put its bodies, and how far apart they are there.

Poses are worked out in numpy, (3, 3, n) and (3, n); distances are the package's own exact ones, the bodies placed
anew each time. Joints and obstacles are taken where the motion has them at a step. Not for: what is proven
(`budget`), nor clocks.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from typing import Any

import numpy as np

from clearance.kernels.search.pair_query import POSES_ARE_RIGID, nearest_at_poses
from clearance.kernels.search.scratch import new_scratch
from clearance.query.one_pair import OnePair, answer_rows
from clearance.world.body import Obstacle
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.forest import joined_positions, positions_between
from clearance.world.motion import Motion
from clearance.world.pairs import BodyIndex, Pair
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind

Key = tuple[str, str, str]
"""An error: what is off ("position", "tracking", "xyz" or "angle"), of which robot or obstacle, which joint."""

Errors = Mapping[Key, np.ndarray]
"""(1, n) or (3, n) each."""


@dataclass(frozen=True)
class Size:
    """How far an error can be: a number, or a vector of that length."""

    most: float
    n: int


@dataclass(frozen=True, eq=False)
class Cause:
    """One error on the way to a frame: it turns about `origin` or slides along `axes`, (3, n) or (3, 3, n)."""

    key: Key
    factor: float
    axes: np.ndarray
    origin: np.ndarray | None


@dataclass(frozen=True, eq=False)
class Frame:
    """Frames of all samples in the world: `turn` (3, 3, n), `at` (3, n) [m], and what moves them."""

    turn: np.ndarray
    at: np.ndarray
    below: Frame | None = None
    causes: list[Cause] = field(default_factory=list)

    def all_causes(self) -> Iterator[Cause]:
        """Those of the frame and of all below it."""
        frame: Frame | None = self
        while frame is not None:
            yield from frame.causes
            frame = frame.below

    def fixed(self, pose: np.ndarray) -> Frame:
        """A frame with a pose on this one."""
        return Frame(_times(self.turn, pose[:3, :3]), self.place(pose[:3, 3]), self)

    def place(self, point: np.ndarray) -> np.ndarray:
        """(3, n) where a point of it is."""
        return np.tensordot(self.turn, point, (1, 0)) + self.at


def typical(case: Case) -> Budget:
    """Repeatability and calibration of a typical cell."""
    frame = PlacementTolerance(0.0002, 0.0001)
    robots = {
        placed.robot.name: RobotTolerance(
            {joint.name: JointTolerance(0.0005, 0.0, frame) for joint in placed.robot.joints},
            PlacementTolerance(0.002, 0.001),
            dict.fromkeys(placed.robot.link_names, 0.0005),
        )
        for placed in case.robots
    }
    place = ObstacleTolerance(PlacementTolerance(0.001), 0.0005)
    return Budget(robots, {obstacle.name: place for obstacle in case.obstacles})


def scaled(value: Any, by: Callable[[float], float]) -> Any:
    """A budget, or a part of one, each of whose tolerances is another."""
    if isinstance(value, bool) or (
        not isinstance(value, float | Mapping) and not is_dataclass(value)
    ):
        return value
    if isinstance(value, float):
        return by(value)
    if isinstance(value, Mapping):
        return {key: scaled(one, by) for key, one in value.items()}
    return replace(value, **{f.name: scaled(getattr(value, f.name), by) for f in fields(value)})


def sizes_of(case: Case) -> dict[Key, Size]:
    """All errors of a case's budget that are not 0, but for surfaces and clocks."""
    budget = case.tolerance
    assert budget is not None
    found: dict[Key, Size] = {}
    for name, own in budget.robots.items():
        for joint, one in own.joints.items():
            found["position", name, joint] = Size(one.position, 1)
            found["tracking", name, joint] = Size(one.tracking, 1)
            found |= _place_sizes(name, joint, one.frame)
        found |= _place_sizes(name, "", own.base)
    for name, other in budget.obstacles.items():
        found |= _place_sizes(name, "", other.place)
    return {key: size for key, size in found.items() if size.most > 0.0}


def _place_sizes(owner: str, part: str, place: PlacementTolerance) -> dict[Key, Size]:
    return {("xyz", owner, part): Size(place.xyz, 3), ("angle", owner, part): Size(place.angle, 3)}


def surfaces_of(budget: Budget, case: Case, pair: Pair) -> float:
    """[m] how far the surfaces of both bodies of a pair may stand out."""
    total = 0.0
    for body in pair:
        name = body.own_name_in(case)
        if body.is_obstacle:
            total += budget.obstacles[name].surface if name in budget.obstacles else 0.0
        else:
            own = budget.robots.get(case.robots[body.i_robot].robot.name)
            total += own.surfaces.get(name, 0.0) if own else 0.0
    return total


class Machine:
    """The robots and obstacles of a case at a moment of its motion, with errors.

    Args:
        share: how much of the interval after the step has passed, 0 to 1.
    """

    def __init__(
        self, case: Case, motions: Iterable[Motion], step: int, share: float = 0.0
    ) -> None:
        self.case = case
        if share > 0.0:
            self.row = positions_between(case, tuple(motions), step, share)
        else:
            self.row = joined_positions(case, tuple(motions), np.array([step]))[0]
        self.columns = _columns(case)

    def frames(self, errors: Errors, n: int) -> dict[str, Frame]:
        """All links, "robot/link", and obstacles."""
        world = Frame(np.repeat(np.eye(3)[:, :, None], n, axis=2), np.zeros((3, n)))
        found: dict[str, Frame] = {}
        waiting: list[PlacedRobot | Obstacle] = [*self.case.robots, *self.case.obstacles]
        while waiting:
            one = waiting.pop(0)
            below = world
            if one.mount is not None:
                on = self._known(one.mount.on)
                if on not in found:
                    waiting.append(one)
                    continue
                below = found[on].fixed(one.mount.pose)
            if isinstance(one, Obstacle):
                found[one.name] = self._obstacle(one, below, errors)
            else:
                self._robot(one, below, errors, found)
        return found

    def _known(self, on: str) -> str:
        names = {obstacle.name for obstacle in self.case.obstacles}
        return on if "/" in on or on in names else f"{self.case.robots[0].robot.name}/{on}"

    def _obstacle(self, one: Obstacle, below: Frame, errors: Errors) -> Frame:
        frame = below.fixed(one.world_from_body)
        if one.moves is not None:
            first = self.columns[one.name]
            frame = frame.fixed(_pose_of_seven(self.row[first : first + 7]))
        return _off(frame, errors, one.name, "")

    def _robot(
        self, one: PlacedRobot, below: Frame, errors: Errors, found: dict[str, Frame]
    ) -> None:
        robot, first = one.robot, self.columns[one.robot.name]
        joints = {joint.name: joint for joint in robot.joints}
        asked = {joint.name: self.row[first + k] for k, joint in enumerate(robot.moving_joints)}
        root = _off(below.fixed(one.world_from_base), errors, robot.name, "")
        found[f"{robot.name}/{robot.link_names[0]}"] = root
        for joint in robot.joints:
            frame = found[f"{robot.name}/{joint.parent}"].fixed(joint.parent_from_joint)
            frame = _off(frame, errors, robot.name, joint.name)
            found[f"{robot.name}/{joint.child}"] = _moved(
                frame, joint, joints, asked, errors, robot.name
            )


def _columns(case: Case) -> dict[str, int]:
    """The first column of each robot and obstacle that moves."""
    found, at = {}, 0
    for placed in case.robots:
        found[placed.robot.name] = at
        at += len(placed.robot.moving_joints)
    for obstacle in case.obstacles:
        if obstacle.moves is not None:
            found[obstacle.name] = at
            at += 7
    return found


def _leads(joint: Joint, joints: Mapping[str, Joint]) -> Iterator[tuple[str, float]]:
    factor = 1.0
    yield joint.name, factor
    while joint.mimic is not None:
        factor *= joint.mimic.multiplier
        joint = joints[joint.mimic.joint]
        yield joint.name, factor


def _position(joint: Joint, joints: Mapping[str, Joint], asked: Mapping[str, float]) -> float:
    if joint.mimic is None:
        return asked.get(joint.name, 0.0)
    below = _position(joints[joint.mimic.joint], joints, asked)
    return joint.mimic.multiplier * below + joint.mimic.offset


def _moved(
    frame: Frame,
    joint: Joint,
    joints: Mapping[str, Joint],
    asked: Mapping[str, float],
    errors: Errors,
    robot: str,
) -> Frame:
    """The frame after its joint."""
    if joint.kind is JointKind.FIXED:
        return Frame(frame.turn, frame.at, frame)
    axis = np.asarray(joint.axis, dtype=np.float64)
    value = np.full(frame.at.shape[1], _position(joint, joints, asked))
    way = np.tensordot(frame.turn, axis, (1, 0))
    origin = None if joint.kind is JointKind.PRISMATIC else frame.at
    causes = []
    for name, factor in _leads(joint, joints):
        for kind in ("position", "tracking"):
            if (kind, robot, name) in errors:
                value = value + factor * errors[kind, robot, name][0]
                causes.append(Cause((kind, robot, name), factor, way, origin))
    if origin is None:
        return Frame(frame.turn, frame.at + value * way, frame, causes)
    return Frame(_times(frame.turn, turned(axis[:, None] * value)), frame.at, frame, causes)


def _off(frame: Frame, errors: Errors, owner: str, part: str) -> Frame:
    """The frame where its own errors put it."""
    offset, angle = errors.get(("xyz", owner, part)), errors.get(("angle", owner, part))
    causes, turn, at = [], frame.turn, frame.at
    if offset is not None:
        causes.append(Cause(("xyz", owner, part), 1.0, frame.turn, None))
        at = at + (frame.turn * offset[None]).sum(axis=1)
    if angle is not None:
        causes.append(Cause(("angle", owner, part), 1.0, frame.turn, at))
        turn = _times(turn, turned(angle))
    return Frame(turn, at, frame, causes) if causes else frame


def turned(vector: np.ndarray) -> np.ndarray:
    """(3, 3, n) of rotation vectors (3, n), by Rodrigues."""
    angle = np.sqrt((vector * vector).sum(axis=0))
    x, y, z = vector / np.where(angle > 0.0, angle, 1.0)
    s, v = np.sin(angle), 2.0 * np.sin(0.5 * angle) ** 2
    return np.stack(
        [
            np.stack([1 - v * (y * y + z * z), v * x * y - s * z, v * x * z + s * y]),
            np.stack([v * x * y + s * z, 1 - v * (x * x + z * z), v * y * z - s * x]),
            np.stack([v * x * z - s * y, v * y * z + s * x, 1 - v * (x * x + y * y)]),
        ]
    )


def _times(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(3, 3, n) products; b may be one for all."""
    if b.ndim == 2:
        b = b[:, :, None]
    return a[:, 0, None] * b[None, 0] + a[:, 1, None] * b[None, 1] + a[:, 2, None] * b[None, 2]


def _pose_of_seven(row: np.ndarray) -> np.ndarray:
    """(4, 4) of a position and a quaternion."""
    pose = np.eye(4)
    x, y, z, w = row[3:] / np.linalg.norm(row[3:])
    pose[:3, 3] = row[:3]
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return pose


def body_name(case: Case, body: BodyIndex) -> str:
    """The name of a body, a link's with its robot's before it."""
    own = body.own_name_in(case)
    return own if body.is_obstacle else f"{case.robots[body.i_robot].robot.name}/{own}"


class Apart:
    """How far apart pairs of a case are, wherever they are put; arrays of a pair are made once."""

    def __init__(self) -> None:
        self._scratch = new_scratch()
        self._pairs: dict[tuple[int, int], tuple[OnePair, object, object]] = {}

    def of(self, case: Case, pair: Pair, frames: Mapping[str, Frame]):
        """(n,) [m] distances of a pair and (n, 2, 3) its nearest points."""
        a, b = (frames[body_name(case, body)] for body in pair)
        n = a.at.shape[1]
        rows = answer_rows(n)
        arrays = self._pair(case, pair).arrays
        nearest_at_poses(arrays, _rows_of(a), _rows_of(b), POSES_ARE_RIGID, *rows)
        return rows[0][:, 0], rows[1]

    def _pair(self, case: Case, pair: Pair) -> OnePair:
        shapes = [body.shape_in(case) for body in pair]
        key = id(shapes[0]), id(shapes[1])
        if key not in self._pairs:
            self._pairs[key] = OnePair(*shapes, self._scratch, goes_on=True), *shapes
        return self._pairs[key][0]


def _rows_of(frame: Frame) -> np.ndarray:
    poses = np.tile(np.eye(4), (frame.at.shape[1], 1, 1))
    poses[:, :3, :3], poses[:, :3, 3] = np.moveaxis(frame.turn, 2, 0), frame.at.T
    return poses


def slopes(a: Frame, b: Frame, points: np.ndarray) -> dict[Key, np.ndarray]:
    """(1, n) or (3, n) each: how the distance of the nearest points (n, 2, 3) changes with each error."""
    x, y = points[:, 0].T, points[:, 1].T
    apart = y - x
    length = np.sqrt((apart * apart).sum(axis=0))
    u = apart / np.where(length > 0.0, length, 1.0)
    found: dict[Key, np.ndarray] = {}
    for frame, point, sign in ((a, x, -1.0), (b, y, 1.0)):
        for cause in frame.all_causes():
            # u . (v x (p - o)) = v . ((p - o) x u)
            along = u if cause.origin is None else np.cross(point - cause.origin, u, axis=0)
            axes = cause.axes if cause.axes.ndim == 3 else cause.axes[:, None]
            slope = sign * cause.factor * (axes * along[:, None]).sum(axis=0)
            found[cause.key] = found.get(cause.key, 0.0) + slope
    return found


def random_errors(sizes: Mapping[Key, Size], n: int, rng: np.random.Generator) -> dict:
    """Errors at random, half of them as large as they can be."""
    found = {}
    for key, size in sizes.items():
        v = rng.normal(size=(size.n, n))
        share = np.where(rng.random(n) < 0.5, 1.0, rng.random(n))
        found[key] = v / np.sqrt((v * v).sum(axis=0)) * size.most * share
    return found
