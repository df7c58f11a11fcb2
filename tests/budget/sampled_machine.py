"""A case whose machine is off, at any time, by formulas of its own: what samples of errors leave.

Joints may follow cubics and each other, tables may loop, anything may stand on anything, parts change hands
(`HandlingMachine`).
"""

from __future__ import annotations

import functools
import itertools
import math
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

import clearance as cl
from clearance.world.case import Case
from tests.cells import positions_at, table_at


def pose_of(t: np.ndarray, v: np.ndarray) -> np.ndarray:
    """(4, 4) of a shift and a rotation vector, by Rodrigues' formula."""
    x, y, z = v
    pose = np.array([[1.0, 0, 0, t[0]], [0, 1.0, 0, t[1]], [0, 0, 1.0, t[2]], [0, 0, 0, 1.0]])
    angle = math.sqrt(x * x + y * y + z * z)
    if angle > 0.0:
        across = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]]) / angle
        twice = 2.0 * math.sin(0.5 * angle) ** 2
        pose[:3, :3] += math.sin(angle) * across + twice * (across @ across)
    return pose


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
            f"{p.robot.name}/{b.name}": b.shape for p in case.robots for b in p.robot.bodies
        } | {o.name: o.body.shape for o in case.obstacles}

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
                late = time + self._clock(errors, one.name)
                below = below @ table_at(one.moves, late, left=False)
            found[one.name] = below @ self._off(errors, one.name)
        return found

    def called(self, on: str) -> str:
        """The name that a link has here, of one that a case gives."""
        is_link = all(on != one.name for one in self.case.obstacles)
        return f"{self.case.robots[0].robot.name}/{on}" if is_link and "/" not in on else on

    def _clock(self, errors, owner: str) -> float:
        return float(np.sum(errors.get(("clock", owner, ""), 0.0)))

    def _robot(self, placed, root, time: float, errors, found) -> None:
        name, own = placed.robot.name, placed.trajectory
        time = time + self._clock(errors, name)
        asked = dict(placed.fixed_positions)
        if own is not None:
            row = positions_at(placed, time, left=False)
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

    def left(self, time: float, errors, pair: tuple[str, str], parts=None) -> float:
        """[m] of a pair, less surfaces."""
        poses = self.poses(time, errors, parts)
        one, other = pair
        near = cl.distance(
            self.shapes[one], self.shapes[other], pose_a=poses[one], pose_b=poses[other]
        )
        return near.distance - self.surfaces(pair)

    def apart(self, time: float, pair: tuple[str, str], points: np.ndarray):
        """How far apart [m] at errors are points that two bodies carry, given where they are without."""
        poses = self.poses(time, {})
        own = [np.linalg.inv(poses[n]) @ [*x, 1.0] for n, x in zip(pair, points, strict=True)]

        def at(errors) -> float:
            moved = self.poses(time, errors)
            p, q = (moved[n] @ x for n, x in zip(pair, own, strict=True))
            return float(np.linalg.norm(q - p))

        return at

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
        return self.left(time, errors[self.NOW], pair, self.parts_at(start, errors))

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
