"""Where the bodies of a case are when its robots and obstacles are off, and how far apart they are: plain numpy.

It shares no code with the package: the case and its budget are read as the data that they are. Distances are those
of all pairs of triangles. For cases in which nothing changes hands, joints move linearly, and obstacles by tables
stand on nothing that moves.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

Error = tuple[str, str, str]
"""What is off: "joint", "frame", "base", "place" or "clock", of which robot or obstacle, which joint."""


@dataclass(frozen=True)
class Size:
    """How far an error can be: a number, or a vector of three, of at most that length."""

    most: float
    n: int


def sizes(case) -> dict[tuple[Error, str], Size]:
    """All errors of a case's budget that are not 0; a frame has "xyz" and "angle"."""
    found: dict[tuple[Error, str], Size] = {}
    for placed in case.robots:
        robot, own = placed.robot, case.tolerance.robots.get(placed.robot.name)
        if own is None:
            continue
        for joint in robot.joints:
            tolerance = own.joints.get(joint.name)
            if tolerance is None:
                continue
            most = tolerance.position + tolerance.tracking
            found[("joint", robot.name, joint.name), "q"] = Size(most, 1)
            _add_frame(found, ("frame", robot.name, joint.name), tolerance.frame)
        _add_frame(found, ("base", robot.name, ""), own.base)
        found[("clock", robot.name, ""), "t"] = Size(own.timing, 1)
    for name, own in case.tolerance.obstacles.items():
        _add_frame(found, ("place", name, ""), own.place)
        found[("clock", name, ""), "t"] = Size(own.timing, 1)
    return {key: size for key, size in found.items() if size.most > 0.0}


def _add_frame(found, error: Error, place) -> None:
    found[error, "xyz"] = Size(place.xyz, 3)
    found[error, "angle"] = Size(place.angle, 3)


@dataclass(eq=False)
class Perturbed:
    """A case at a time, whose errors are given."""

    case: object
    pairs: list[tuple[str, str]]

    def __post_init__(self) -> None:
        self.triangles = {}
        for placed in self.case.robots:
            for body in placed.robot.bodies:
                self.triangles[f"{placed.robot.name}/{body.name}"] = _triangles(body.shape)
        for obstacle in self.case.obstacles:
            self.triangles[obstacle.name] = _triangles(obstacle.body.shape)

    def surface(self, name: str) -> float:
        """[m] how far the surface of a body may stand out."""
        robot, _, link = name.partition("/")
        budget = self.case.tolerance
        if link:
            own = budget.robots.get(robot)
            return own.surfaces.get(link, 0.0) if own else 0.0
        return budget.obstacles[name].surface if name in budget.obstacles else 0.0

    def left(self, time: float, errors: Mapping) -> float:
        """[m] the least distance of all pairs at a time, less their surfaces."""
        return min(self.each(time, errors).values())

    def each(self, time: float, errors: Mapping) -> dict[tuple[str, str], float]:
        """[m] the same of each pair."""
        poses = self.poses(time, errors)
        found = {}
        for a, b in self.pairs:
            gap = triangle_distance(
                _moved(self.triangles[a], poses[a]), _moved(self.triangles[b], poses[b])
            )
            found[a, b] = gap - self.surface(a) - self.surface(b)
        return found

    def poses(self, time: float, errors: Mapping) -> dict[str, np.ndarray]:
        """(4, 4) `world_from_body` by name, a link's with its robot's before it."""
        poses: dict[str, np.ndarray] = {}
        waiting = [*self.case.robots, *self.case.obstacles]
        while waiting:
            thing = waiting.pop(0)
            mount = thing.mount
            if mount is not None and self._name(mount.on) not in poses:
                waiting.append(thing)
                continue
            below = np.eye(4) if mount is None else poses[self._name(mount.on)] @ mount.pose
            if hasattr(thing, "robot"):
                self._place_robot(thing, below, time, errors, poses)
            else:
                own = below @ thing.world_from_body
                if thing.moves is not None:
                    own = own @ _on_table(thing.moves, time + _number(errors, "clock", thing.name))
                poses[thing.name] = own @ _frame_error(errors, "place", thing.name)
        return poses

    def _name(self, on: str) -> str:
        if "/" in on or any(o.name == on for o in self.case.obstacles):
            return on
        return f"{self.case.robots[0].robot.name}/{on}"

    def _place_robot(self, placed, below, time, errors, poses) -> None:
        robot = placed.robot
        time = time + _number(errors, "clock", robot.name)
        root = below @ placed.world_from_base @ _frame_error(errors, "base", robot.name)
        poses[f"{robot.name}/{robot.link_names[0]}"] = root
        asked: dict[str, float] = {}
        joints = {joint.name: joint for joint in robot.joints}

        def asked_of(joint) -> float:
            if joint.mimic is not None:
                return joint.mimic.multiplier * real(joints[joint.mimic.joint]) + joint.mimic.offset
            trajectory = placed.trajectory
            if trajectory is not None and joint.name in trajectory.joint_names:
                column = trajectory.joint_names.index(joint.name)
                return float(np.interp(time, trajectory.times, trajectory.positions[:, column]))
            return placed.fixed_positions.get(joint.name, 0.0)

        def real(joint) -> float:
            if joint.name not in asked:
                asked[joint.name] = asked_of(joint) + _number(
                    errors, "joint", robot.name, joint.name
                )
            return asked[joint.name]

        for joint in robot.joints:
            parent = poses[f"{robot.name}/{joint.parent}"]
            frame = joint.parent_from_joint @ _frame_error(errors, "frame", robot.name, joint.name)
            motion = np.eye(4)
            if str(joint.kind) in ("revolute", "continuous"):
                motion[:3, :3] = rotation(real(joint) * np.asarray(joint.axis))
            elif str(joint.kind) == "prismatic":
                motion[:3, 3] = real(joint) * np.asarray(joint.axis)
            poses[f"{robot.name}/{joint.child}"] = parent @ frame @ motion


def _number(errors: Mapping, *error: str) -> float:
    value = errors.get((_key(*error), "t" if error[0] == "clock" else "q"))
    return 0.0 if value is None else float(value[0])


def _key(kind: str, owner: str, part: str = "") -> Error:
    return kind, owner, part


def _frame_error(errors: Mapping, *error: str) -> np.ndarray:
    pose = np.eye(4)
    pose[:3, 3] = errors.get((_key(*error), "xyz"), np.zeros(3))
    pose[:3, :3] = rotation(errors.get((_key(*error), "angle"), np.zeros(3)))
    return pose


def rotation(vector: np.ndarray) -> np.ndarray:
    """(3, 3) of a rotation vector, by Rodrigues."""
    angle = float(np.linalg.norm(vector))
    if angle == 0.0:
        return np.eye(3)
    x, y, z = np.asarray(vector) / angle
    k = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.eye(3) + np.sin(angle) * k + 2.0 * np.sin(0.5 * angle) ** 2 * (k @ k)


def _on_table(table, time: float) -> np.ndarray:
    """The pose of a table at a time: straight, and turning about one axis."""
    i = int(np.clip(np.searchsorted(table.times, time, side="right") - 1, 0, len(table.times) - 2))
    share = np.clip((time - table.times[i]) / (table.times[i + 1] - table.times[i]), 0.0, 1.0)
    pose = np.eye(4)
    pose[:3, 3] = (1.0 - share) * table.positions[i] + share * table.positions[i + 1]
    p, q = table.quaternions[i], table.quaternions[i + 1]
    q = -q if p @ q < 0.0 else q
    angle = np.arccos(min(1.0, float(p @ q)))
    if angle > 1e-12:
        p = (np.sin((1.0 - share) * angle) * p + np.sin(share * angle) * q) / np.sin(angle)
    x, y, z, w = p / np.linalg.norm(p)
    pose[:3, :3] = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return pose


def _triangles(shape) -> np.ndarray:
    """(n, 3, 3) the fans of all faces [m]."""
    corners = [
        [face[0], face[i], face[i + 1]]
        for face in (
            shape.face_vertices[start:end]
            for start, end in itertools.pairwise(shape.face_starts.tolist())
        )
        for i in range(1, len(face) - 1)
    ]
    return np.asarray(shape.vertices)[np.array(corners)]


def _moved(triangles: np.ndarray, pose: np.ndarray) -> np.ndarray:
    return triangles @ pose[:3, :3].T + pose[:3, 3]


def triangle_distance(p: np.ndarray, q: np.ndarray) -> float:
    """[m] the least distance of (n, 3, 3) and (m, 3, 3) triangles; 0 where an edge pierces one."""
    p, q = np.repeat(p, len(q), axis=0), np.tile(q, (len(p), 1, 1))
    least = np.inf
    for i in range(3):
        least = min(least, _points(p[:, i], q), _points(q[:, i], p))
        for k in range(3):
            least = min(least, _edges(p[:, i], p[:, (i + 1) % 3], q[:, k], q[:, (k + 1) % 3]))
    if any(_pierces(p[:, i], p[:, (i + 1) % 3], q) for i in range(3)):
        return 0.0
    if any(_pierces(q[:, i], q[:, (i + 1) % 3], p) for i in range(3)):
        return 0.0
    return least


def _dot(a, b):
    return np.einsum("ij,ij->i", a, b)


def _points(x, triangles) -> float:
    """The least distance of points over their triangles; beside them edges are nearer."""
    a, b, c = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(b - a, c - a)
    length = np.sqrt(_dot(normal, normal))
    inside = length > 0.0
    for u, v in ((a, b), (b, c), (c, a)):
        inside &= _dot(np.cross(normal, v - u), x - u) >= 0.0
    height = np.abs(_dot(normal, x - a)) / np.where(length > 0.0, length, 1.0)
    return float(np.min(height, where=inside, initial=np.inf))


def _edges(a, b, c, d) -> float:
    """The least distance of segments a b and c d."""
    u, v, w = b - a, d - c, a - c
    uu, uv, vv, uw, vw = _dot(u, u), _dot(u, v), _dot(v, v), _dot(u, w), _dot(v, w)
    det = uu * vv - uv * uv
    parallel = det <= 1e-14 * uu * vv
    s = np.clip((uv * vw - vv * uw) / np.where(parallel, 1.0, det), 0.0, 1.0)
    s = np.where(parallel, 0.0, s)
    t = np.clip((uv * s + vw) / np.where(vv > 0.0, vv, 1.0), 0.0, 1.0)
    s = np.clip((uv * t - uw) / np.where(uu > 0.0, uu, 1.0), 0.0, 1.0)
    way = w + s[:, None] * u - t[:, None] * v
    least = float(np.sqrt(_dot(way, way).min()))
    return min(
        least,
        *(_point_segment(x, *e) for x, e in ((a, (c, d)), (b, (c, d)), (c, (a, b)), (d, (a, b)))),
    )


def _point_segment(x, a, b) -> float:
    u = b - a
    s = np.clip(_dot(x - a, u) / np.maximum(_dot(u, u), 1e-300), 0.0, 1.0)
    way = x - a - s[:, None] * u
    return float(np.sqrt(_dot(way, way).min()))


def _pierces(a, b, triangles) -> bool:
    """True if a segment passes through its triangle."""
    x, y, z = triangles[:, 0], triangles[:, 1], triangles[:, 2]
    normal = np.cross(y - x, z - x)
    p, q = _dot(normal, a - x), _dot(normal, b - x)
    across = p * q < 0.0
    s = p / np.where(across, p - q, 1.0)
    at = a + s[:, None] * (b - a)
    for u, v in ((x, y), (y, z), (z, x)):
        across &= _dot(np.cross(normal, v - u), at - u) >= 0.0
    return bool(across.any())


def random_errors(found: Mapping, rng: np.random.Generator) -> dict:
    """Errors at random, half of them as large as they can be."""
    return {key: _random(size, rng) for key, size in found.items()}


def _random(size: Size, rng: np.random.Generator) -> np.ndarray:
    vector = rng.normal(size=size.n)
    share = 1.0 if rng.random() < 0.5 else rng.random()
    return vector / np.linalg.norm(vector) * size.most * share


def ascended(
    left: Callable[[Mapping], float], found: Mapping, errors: dict, rounds: int = 2
) -> tuple[float, dict]:
    """The least that is left when one error after the other is made as bad as it can be, and what these are."""
    best = left(errors)
    for _ in range(rounds):
        for key, size in found.items():
            for candidate in _worst_of(left, key, size, errors, best):
                tried = {**errors, key: candidate}
                value = left(tried)
                if value < best:
                    best, errors = value, tried
    return best, errors


def _worst_of(left, key, size: Size, errors: dict, best: float) -> Iterator[np.ndarray]:
    """Values of one error to try: both ends, or against its slope."""
    if size.n == 1:
        yield np.array([size.most])
        yield np.array([-size.most])
        return
    step = 1e-2 * size.most
    slope = np.array(
        [left({**errors, key: errors[key] + step * np.eye(3)[i]}) - best for i in range(3)]
    )
    length = np.linalg.norm(slope)
    if length > 0.0:
        yield -slope / length * size.most
