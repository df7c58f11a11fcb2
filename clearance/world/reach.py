"""Refuses what no robot does: bodies far beyond any place it works at, joints that spin between two samples.

Both are unit mistakes or typing errors, and would end in overflow or in work without end.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from clearance.errors import BadDimension
from clearance.tolerance import REACH, TURNS
from clearance.world.body import Body, Mount
from clearance.world.case import Case
from clearance.world.cell import once_a_cell
from clearance.world.cubic import extremes_between
from clearance.world.forest import owner_of, resolved_mount
from clearance.world.mimics import followers
from clearance.world.motion import Motion
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.timing import time_text
from clearance.world.trajectory import Trajectory

ROOT_3 = 3.0**0.5
"""How much farther than along an axis a point of a cube is from its middle."""

AT_ONCE = 1024
"""Samples that are read together."""


def farthest_reach(case: Case, motions: Sequence[Motion]) -> float:
    """[m] no coordinate of any body is larger in magnitude at any moment."""
    return max(reach for _, reach in _reaches(case, tuple(motions)))


def require_within_reach(case: Case, motions: Sequence[Motion]) -> None:
    """Nothing, if every body stays within `tolerance.REACH` of the origin and no joint spins between two steps.

    Raises:
        BadDimension: the first body or joint that does not.
    """
    for motion in motions:
        require_few_turns(motion.placed.robot, motion.joint_names, motion)
    for what, reach in _reaches(case, tuple(motions)):
        if not reach <= REACH:
            raise BadDimension(
                f"it reaches {reach:g} m from the origin",
                where=what,
                valid=f"{REACH:g} m or less; lengths are in metres",
            )


@lru_cache(maxsize=16)  # needed again by each section of a phase
def _reaches(case: Case, motions: tuple[Motion, ...]) -> list[tuple[str, float]]:
    """Each body by name, and how far it gets from the origin along an axis at most [m]."""
    return list(_each_reach(case, motions))


def _each_reach(case: Case, motions: Sequence[Motion]) -> Iterator[tuple[str, float]]:
    frames = _Frames(case, motions)
    of_obstacles, of_links = _corners(case)
    for i, (obstacle, own) in enumerate(zip(case.obstacles, of_obstacles, strict=True)):
        yield f"obstacle {obstacle.name!r}", own + frames.of_obstacle(i)
    for i, motion in enumerate(motions):
        farthest = frames.of_robot(i)
        for body, own in zip(motion.placed.robot.bodies, of_links[i], strict=True):
            yield f"link {body.name!r}", own + farthest


@once_a_cell(16)
def _corners(case: Case) -> tuple[list[float], list[list[float]]]:
    """[m] how far the corners of each obstacle, and of each robot's links, get from their frame along an axis."""
    of_links = [[_reach(body) for body in placed.robot.bodies] for placed in case.robots]
    return [_reach(obstacle.body) for obstacle in case.obstacles], of_links


@once_a_cell(16)
def _origins(case: Case) -> list[float]:
    """[m] the same of each obstacle's own frame from what it stands on, where it has no table."""
    return [_farthest_along(obstacle.world_from_body) for obstacle in case.obstacles]


class _Frames:
    """How far the frames of robots and obstacles get from the origin along an axis at most [m]."""

    def __init__(self, case: Case, motions: Sequence[Motion]) -> None:
        self._case, self._motions, self._origins = case, motions, _origins(case)

    def of_robot(self, i: int) -> float:
        """For all links of a robot."""
        placed = self._case.robots[i]
        base = _farthest_along(placed.world_from_base)
        return base + _slide(self._motions[i]) + self._below(placed.mount)

    def of_obstacle(self, i: int) -> float:
        """For an obstacle, whoever has carried it."""
        obstacle = self._case.obstacles[i]
        own = self._origins[i]
        if obstacle.moves is not None:
            own += float(np.abs(obstacle.moves.positions).sum(axis=1).max())
        return own + self._below(obstacle.mount)

    def _below(self, mount: Mount | None) -> float:
        """For a body on a mount: no axis of it is longer than the sum of a shift's magnitudes."""
        if mount is None:
            return 0.0
        is_obstacle, i = owner_of(self._case, mount)
        mount = resolved_mount(self._case, mount)
        shift = float(np.abs(mount.pose[:3, 3]).sum())
        return ROOT_3 * (self.of_obstacle(i) if is_obstacle else self.of_robot(i)) + shift


def require_few_turns(robot: Robot, names: Sequence[str], moves: Motion | Trajectory) -> None:
    """Nothing, if no joint turns more than `tolerance.TURNS` times between two steps.

    Args:
        names: of the columns of `moves`.

    Raises:
        BadDimension: the first joint that does, with the times between which it does.
    """
    columns = {name: i for i, name in enumerate(names)}
    farthest = _longest_ways(moves)
    for joint, name, factor, offset in followers(robot):
        if joint.kind not in (JointKind.REVOLUTE, JointKind.CONTINUOUS):
            continue
        _require_offset(joint, offset)
        if name not in columns:
            continue
        if not abs(factor) * farthest[columns[name]] <= TURNS * 2.0 * np.pi:
            turn = abs(factor) * _ways(moves, slice(None))[:, columns[name]]
            i = int(np.argmax(turn))
            raise BadDimension(
                f"joint {joint.name!r} turns by {turn[i]:g} rad between {time_text(moves.times[i])} s and "
                f"{time_text(moves.times[i + 1])} s",
                valid=f"{TURNS:g} turns or less from sample to sample; angles are in radians",
            )


def _longest_ways(moves: Motion | Trajectory) -> np.ndarray:
    """(k,) [rad or m] the longest of each joint's `_ways`, a stretch at a time."""
    longest = np.zeros(moves.positions.shape[1])
    for start in range(0, len(moves.times), AT_ONCE):
        ways = _ways(moves, slice(start, start + AT_ONCE + 1))
        np.maximum(longest, ways.max(axis=0, initial=0.0), out=longest)
    return longest


def _ways(moves: Motion | Trajectory, samples: slice) -> np.ndarray:
    """(n - 1, k) [rad or m] how far joints go between samples, or would at their speed at one of them."""
    ways = np.abs(np.diff(moves.positions[samples], axis=0))
    if moves.velocities is not None:
        speeds, spans = np.abs(moves.velocities[samples]), np.diff(moves.times[samples])[:, None]
        ways = np.maximum(ways, np.maximum(speeds[1:], speeds[:-1]) * spans)
    return ways


def _require_offset(joint: Joint, offset: float) -> None:
    if not abs(offset) <= TURNS * 2.0 * np.pi:
        raise BadDimension(
            f"joint {joint.name!r} stands {offset:g} rad beyond the joint that it follows",
            valid=f"{TURNS:g} turns or less; angles are in radians",
        )


def length_of_robot(motion: Motion) -> float:
    """[m] No point of a robot is farther from any of its joints during a motion."""
    corners = (_reach(body) for body in motion.placed.robot.bodies)
    return _slide(motion) + ROOT_3 * max(corners, default=0.0)


def _slide(motion: Motion) -> float:
    """[m] the sum of the travel of sliding joints and of the distances between the frames of joints."""
    robot = motion.placed.robot
    distances = _between_joints(robot)
    columns = {joint.name: i for i, joint in enumerate(robot.moving_joints)}
    slides = [one for one in followers(robot) if one.joint.kind is JointKind.PRISMATIC]
    return distances + sum(
        abs(one.factor) * _farthest(motion, columns[one.master]) + abs(one.offset) for one in slides
    )


@lru_cache(maxsize=8)
def _between_joints(robot: Robot) -> float:
    """[m] the sum of the distances between the frames of joints."""
    return sum(float(np.abs(joint.parent_from_joint[:3, 3]).sum()) for joint in robot.joints)


def _farthest(motion: Motion, i_joint: int) -> float:
    """[rad or m] the greatest magnitude of a joint's position, at the steps and between."""
    column = slice(i_joint, i_joint + 1)
    reached = [motion.positions[:, column]]
    if motion.velocities is not None:
        reached += extremes_between(motion.times, reached[0], motion.velocities[:, column])
    return max(float(max(part.max(), -part.min())) for part in reached if part.size)


def _reach(body: Body) -> float:
    return float(np.abs(body.shape.bounds).max())


def _farthest_along(pose: np.ndarray) -> float:
    return float(np.abs(pose[:3, 3]).max())
