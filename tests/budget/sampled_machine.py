"""A case whose machine is off, at any time, in numpy alone: what samples of errors leave, at best as bad as found.

Joints may follow cubics and each other, tables may loop, anything may stand on anything, parts change hands
(`HandlingMachine`).
"""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from clearance.world.case import Case


def turn(v: np.ndarray) -> np.ndarray:
    """(3, 3) of a rotation vector."""
    size = float(np.linalg.norm(v))
    if size < 1e-300:
        return np.eye(3)
    x, y, z = v / size
    k = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(size) * k + (1.0 - np.cos(size)) * k @ k


def pose_of(t: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(4, 4)."""
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = turn(v), t
    return pose


def quaternion_turn(q: np.ndarray) -> np.ndarray:
    """(3, 3) of a unit quaternion, the scalar last."""
    x, w = q[:3], q[3]
    k = np.array([[0, -x[2], x[1]], [x[2], 0, -x[0]], [-x[1], x[0], 0]])
    return np.eye(3) + 2.0 * w * k + 2.0 * k @ k


def along_table(times: np.ndarray, values: np.ndarray, rates: np.ndarray | None, time: float):
    """Values at a time; where rates are given on Hermite's cubics."""
    time = min(max(time, times[0]), times[-1])
    i = min(int(np.searchsorted(times, time, side="right")) - 1, len(times) - 2)
    h = times[i + 1] - times[i]
    s = (time - times[i]) / h
    if rates is None:
        return (1.0 - s) * values[i] + s * values[i + 1]
    a, b, s2 = values[i], values[i + 1], s * s
    s3 = s2 * s
    near, far = 2 * s3 - 3 * s2 + 1, -2 * s3 + 3 * s2
    return near * a + far * b + h * ((s3 - 2 * s2 + s) * rates[i] + (s3 - s2) * rates[i + 1])


class SampledMachine:
    """A case with errors: a mapping of (kind, owner, part) to a number, or three."""

    def __init__(self, case: Case) -> None:
        self.case = case
        self.most: dict[tuple[str, str, str], tuple[float, int]] = {}
        for placed in case.robots:
            own = case.tolerance.robots[placed.robot.name]
            self._add("clock", placed.robot.name, "", own.timing)
            self._add_place(placed.robot.name, "", own.base)
            for joint in placed.robot.joints:
                if joint.name in own.joints:
                    one = own.joints[joint.name]
                    self._add("joint", placed.robot.name, joint.name, one.position + one.tracking)
                    self._add_place(placed.robot.name, joint.name, one.frame)
        for obstacle in case.obstacles:
            own = case.tolerance.obstacles[obstacle.name]
            self._add("clock", obstacle.name, "", own.timing)
            self._add_place(obstacle.name, "", own.place)
        self.shapes = {
            f"{p.robot.name}/{b.name}": _Shape(b.shape) for p in case.robots for b in p.robot.bodies
        } | {o.name: _Shape(o.body.shape) for o in case.obstacles}

    def _add(self, kind: str, owner: str, part: str, most: float, n: int = 1) -> None:
        if most > 0.0:
            self.most[kind, owner, part] = most, n

    def _add_place(self, owner: str, part: str, place) -> None:
        self._add("xyz", owner, part, place.xyz, 3)
        self._add("angle", owner, part, place.angle, 3)

    def surfaces(self, names: Iterable[str]) -> float:
        """[m]"""
        total = 0.0
        for name in names:
            robot, _, link = name.partition("/")
            budget = self.case.tolerance
            total += budget.robots[robot].surfaces.get(link, 0.0) if link else 0.0
            total += 0.0 if link else budget.obstacles[name].surface
        return total

    def _off(self, errors, owner: str, part: str = "") -> np.ndarray:
        nothing = np.zeros(3)
        return pose_of(
            errors.get(("xyz", owner, part), nothing), errors.get(("angle", owner, part), nothing)
        )

    def poses(self, time: float, errors, parts=None) -> dict[str, np.ndarray]:
        """(4, 4) in the world, of all links and obstacles; parts that have changed hands are on what `parts` says,
        None for the world, and where (4, 4).
        """
        found: dict[str, np.ndarray] = {}
        waiting = [*self.case.robots, *self.case.obstacles]
        while waiting:
            one = waiting.pop(0)
            below = np.eye(4)
            handled = None if hasattr(one, "robot") else (parts or {}).get(one.name)
            mount = (one.mount and one.mount.on, one.mount and one.mount.pose)
            on, pose = handled if handled is not None else mount
            if on is not None:
                on = self.called(on)
                if on not in found:
                    waiting.append(one)
                    continue
                below = found[on]
            if pose is not None:
                below = below @ pose
            if handled is not None:
                found[one.name] = below
                continue
            if hasattr(one, "robot"):
                self._robot(one, below @ one.world_from_base, time, errors, found)
                continue
            below = below @ one.world_from_body
            if one.moves is not None:
                below = below @ self._on_table(one.moves, time + self._clock(errors, one.name))
            found[one.name] = below @ self._off(errors, one.name)
        return found

    def called(self, on: str) -> str:
        """The name that a link has here, of one that a case gives."""
        is_link = all(on != one.name for one in self.case.obstacles)
        return f"{self.case.robots[0].robot.name}/{on}" if is_link and "/" not in on else on

    def _clock(self, errors, owner: str) -> float:
        return float(np.sum(errors.get(("clock", owner, ""), 0.0)))

    def _on_table(self, table, time: float) -> np.ndarray:
        pose = np.eye(4)
        pose[:3, 3] = along_table(table.times, table.positions, None, time)
        times = table.times
        time = min(max(time, times[0]), times[-1])
        i = min(int(np.searchsorted(times, time, side="right")) - 1, len(times) - 2)
        a, b = quaternion_turn(table.quaternions[i]), quaternion_turn(table.quaternions[i + 1])
        between = a.T @ b
        skew = 0.5 * (between - between.T)
        axis = np.array([skew[2, 1], skew[0, 2], skew[1, 0]])
        sine = float(np.linalg.norm(axis))
        angle = np.arctan2(sine, 0.5 * (np.trace(between) - 1.0))
        share = (time - times[i]) / (times[i + 1] - times[i])
        pose[:3, :3] = a @ turn(axis / max(sine, 1e-300) * angle * share)
        return pose

    def _robot(self, placed, root, time: float, errors, found) -> None:
        name, own = placed.robot.name, placed.trajectory
        time = time + self._clock(errors, name)
        asked = dict(placed.fixed_positions)
        if own is not None:
            row = along_table(own.times, own.positions, own.velocities, time)
            asked |= zip(own.joint_names, row, strict=True)
        by_name = {joint.name: joint for joint in placed.robot.joints}

        def position(joint) -> float:
            off = float(np.sum(errors.get(("joint", name, joint.name), 0.0)))
            if joint.mimic is None:
                return asked.get(joint.name, 0.0) + off
            return (
                joint.mimic.multiplier * position(by_name[joint.mimic.joint])
                + joint.mimic.offset
                + off
            )

        found[f"{name}/{placed.robot.link_names[0]}"] = root @ self._off(errors, name)
        for joint in placed.robot.joints:
            pose = found[f"{name}/{joint.parent}"] @ joint.parent_from_joint
            pose = pose @ self._off(errors, name, joint.name)
            if str(joint.kind) == "prismatic":
                pose = pose @ pose_of(position(joint) * np.asarray(joint.axis), np.zeros(3))
            elif str(joint.kind) != "fixed":
                pose = pose @ pose_of(np.zeros(3), position(joint) * np.asarray(joint.axis))
            found[f"{name}/{joint.child}"] = pose

    def left(self, time: float, errors, pair: tuple[str, str]) -> float:
        """[m] of a pair, less surfaces; of bodies that cut each other no more than what it was before."""
        poses = self.poses(time, errors)
        a, b = (self.shapes[name].at(poses[name]) for name in pair)
        return distance(a, b) - self.surfaces(pair)

    def random(self, rng: np.random.Generator):
        """Errors, most of them at their greatest size."""
        found = {}
        for key, (most, n) in self.most.items():
            v = rng.normal(size=n)
            share = 1.0 if rng.random() < 0.7 else rng.random()
            found[key] = most * share * v / np.linalg.norm(v)
        return found

    def as_bad_as_found(self, time: float, pair, errors, rounds: int = 1) -> float:
        """[m] the least that is left when one error after another is made as bad as it can be."""
        best = self.left(time, errors, pair)
        for _ in range(rounds):
            for key, (most, n) in self.most.items():
                if n == 1:
                    tries = [np.array([most]), np.array([-most])]
                else:
                    slope = np.array(
                        [
                            self.left(time, errors | {key: errors[key] + d}, pair) - best
                            for d in 1e-3 * most * np.eye(n)
                        ]
                    )
                    size = float(np.linalg.norm(slope))
                    tries = [-slope / size * most] if size > 0.0 else []
                for one in tries:
                    value = self.left(time, errors | {key: one}, pair)
                    if value < best:
                        best, errors = value, errors | {key: one}
        return best


class HandlingMachine(SampledMachine):
    """The same of a case in which parts change hands: what grips is off, then and later, each time otherwise.

    Errors are a mapping of a moment, a number of seconds or `NOW`, to those of that moment. How far parts are off
    where they lie is of no moment: they keep it.
    """

    NOW = -1.0

    def moments(self, start: float) -> list[float]:
        """[s] at which parts have changed hands in a phase that begins at `start`."""
        edges = {t for one in self.case.carries for t in (one.window.start, one.window.end)}
        return sorted(edge for edge in edges if edge <= start)

    def parts_at(self, start: float, errors) -> dict[str, tuple[str | None, np.ndarray]]:
        """What parts are on in a phase that begins at `start`, and where, as the errors have it."""
        parts: dict[str, tuple[str | None, np.ndarray]] = {}
        names = {one.part for one in self.case.carries}
        places = {key: value for key, value in errors[self.NOW].items() if key[1] in names}
        for moment in self.moments(start):
            off = errors[moment] | places
            there = self.poses(moment, off, parts)
            for one in self.case.carries:
                if one.window.end == moment:
                    parts[one.part] = None, there[one.part]
            for one in self.case.carries:
                if one.window.start == moment:
                    grip = np.linalg.inv(there[self.called(one.by)]) @ there[one.part]
                    if one.exact_grasp:
                        grip = self._nominal(moment)[one.part][1] @ self._off(off, one.part)
                    parts[one.part] = one.by, grip
        return parts

    @functools.cache  # noqa: B019  # a machine lives as long as a test
    def _nominal(self, moment: float):
        """What parts are on after a moment, without errors."""
        plain = replace(
            self.case, carries=tuple(replace(one, exact_grasp=False) for one in self.case.carries)
        )
        exactly = {one: {} for one in [*self.moments(moment), self.NOW]}
        return HandlingMachine(plain).parts_at(moment, exactly)

    def left_in(self, start: float, time: float, errors, pair: tuple[str, str]) -> float:
        """[m] as `left`, in a phase that begins at `start`."""
        there = self.poses(time, errors[self.NOW], self.parts_at(start, errors))
        a, b = (self.shapes[name].at(there[name]) for name in pair)
        return distance(a, b) - self.surfaces(pair)

    def nearer(self, start: float, time: float, pair, errors):
        """[m] the least that is left when one error of one moment after the other is made as bad as it can be."""
        best = self.left_in(start, time, errors, pair)
        for moment, key in itertools.product(errors, self.most):
            most, n = self.most[key]
            value = errors[moment][key]
            tries = [value + d for d in 1e-3 * most * np.eye(n)] if n > 1 else [[most], [-most]]
            tried = [errors | {moment: errors[moment] | {key: np.array(one)}} for one in tries]
            left = [self.left_in(start, time, one, pair) for one in tried]
            size = float(np.linalg.norm(np.array(left) - best))
            if n > 1 and size > 0.0:
                worst = (best - np.array(left)) / size * most
                tried = [errors | {moment: errors[moment] | {key: worst}}]
                left = [self.left_in(start, time, tried[0], pair)]
            if n == 1 or size > 0.0:
                best, errors = min([(best, errors), *zip(left, tried, strict=True)], key=_least)
        return best


def _least(found) -> float:
    return found[0]


class _Shape:
    """Vertices, edges and triangles of a surface."""

    def __init__(self, shape) -> None:
        self.vertices = np.asarray(shape.vertices)
        faces = [
            shape.face_vertices[i:k].tolist() for i, k in itertools.pairwise(shape.face_starts)
        ]
        self.edges = np.array(
            sorted({tuple(sorted(e)) for f in faces for e in zip(f, f[1:] + f[:1], strict=True)})
        )
        self.triangles = np.array(
            [(f[0], f[i], f[i + 1]) for f in faces for i in range(1, len(f) - 1)]
        )

    def at(self, pose: np.ndarray):
        """Its vertices in place (n, 3), edges and triangles."""
        return self.vertices @ pose[:3, :3].T + pose[:3, 3], self.edges, self.triangles


def distance(a, b) -> float:
    """[m] of two surfaces that do not cut each other."""
    return min(_over_faces(a[0], b), _over_faces(b[0], a), _edge_to_edge(a, b))


def _over_faces(points: np.ndarray, other) -> float:
    p, q, r = (other[0][other[2][:, k]] for k in range(3))
    n = np.cross(q - p, r - p)
    n /= np.linalg.norm(n, axis=1, keepdims=True)
    height = np.abs(np.einsum("ik,ijk->ji", n, points[None] - p[:, None]))
    inside = np.ones_like(height, dtype=bool)
    for u, v in ((p, q), (q, r), (r, p)):
        inward = np.cross(n, v - u)
        inside &= np.einsum("ik,ijk->ji", inward, points[None] - u[:, None]) >= 0.0
    return float(np.min(height, where=inside, initial=np.inf))


def _edge_to_edge(a, b) -> float:
    p, u = a[0][a[1][:, 0]][:, None], (a[0][a[1][:, 1]] - a[0][a[1][:, 0]])[:, None]
    q, v = b[0][b[1][:, 0]][None], (b[0][b[1][:, 1]] - b[0][b[1][:, 0]])[None]
    least = np.inf
    w = p - q
    uu, vv, uv = (u * u).sum(-1), (v * v).sum(-1), (u * v).sum(-1)
    uw, vw = (u * w).sum(-1), (v * w).sum(-1)
    with np.errstate(divide="ignore", invalid="ignore"):
        s = np.clip(np.nan_to_num((uv * vw - vv * uw) / (uu * vv - uv * uv)), 0.0, 1.0)
    for first in (s, np.zeros_like(s), np.ones_like(s)):
        t = np.clip((uv * first + vw) / vv, 0.0, 1.0)
        again = np.clip((uv * t - uw) / uu, 0.0, 1.0)
        gap = w + again[..., None] * u - t[..., None] * v
        least = min(least, float(np.sqrt((gap * gap).sum(-1)).min()))
    return least
