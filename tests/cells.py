"""Where the bodies of random cells (`scripts/makers/cells.py`) are, by formulas of their own.

`pose_at` shares no code with the package: joints by matrices, quaternions by scipy, carried parts by following who
holds them. Not for: shapes and distances.
"""

from __future__ import annotations

import functools

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.pose_table import PoseTable
from clearance.world.timing import Timing
from clearance.world.trajectory import Trajectory
from scripts.makers.cells import END, arm, cell, pose, trajectory

__all__ = ("END", "arm", "cell", "pose", "pose_at", "trajectory")


def own_time(timing: Timing, times: np.ndarray, t: float, *, left: bool) -> float:
    """The time of a table that holds at `t` of the run; `left` is the moment before, where a loop begins again."""
    u = (t - timing.start) * timing.rate
    first, last = float(times[0]), float(times[-1])
    if u <= first or timing.after != "loop":
        return min(max(u, first), last)
    rounds, rest = divmod(u - first, last - first)
    if left and rounds and rest < 1e-9:
        return last
    return first + (rest if rest < last - first - 1e-12 or left else 0.0)


def positions_at(placed: PlacedRobot, t: float, *, left: bool) -> np.ndarray:
    """(2,) the joints of a robot at a time."""
    asked = placed.given_trajectory
    u = own_time(placed.timing, asked.times, t, left=left)
    if asked.velocities is None:
        return np.array([np.interp(u, asked.times, column) for column in asked.positions.T])
    return spline_through(asked)(u)


@functools.lru_cache(64)
def spline_through(asked: Trajectory) -> CubicHermiteSpline:
    """The positions of a table by time."""
    return CubicHermiteSpline(asked.times, asked.positions, asked.velocities)


def link_at(case: Case, name: str, t: float, *, left: bool) -> np.ndarray:
    """(4, 4) where `robot/link` is."""
    robot, link = name.split("/")
    placed = next(one for one in case.robots if one.robot.name == robot)
    found = placed.world_from_base
    if placed.mount is not None:
        found = pose_at(case, placed.mount.on, t, left=left) @ placed.mount.pose
    turn, slide = positions_at(placed, t, left=left)
    first, second = placed.robot.joints
    turned, slid = np.eye(4), np.eye(4)
    turned[:3, :3] = Rotation.from_rotvec(turn * first.axis).as_matrix()
    slid[:3, 3] = slide * second.axis
    boom = found @ first.parent_from_joint @ turned
    return {"base": found, "boom": boom, "tool": boom @ second.parent_from_joint @ slid}[link]


def table_at(table: PoseTable, t: float, *, left: bool) -> np.ndarray:
    """(4, 4) where a pose table is."""
    u = own_time(table.timing, table.times, t, left=left)
    found = np.eye(4)
    found[:3, :3] = Slerp(table.times, Rotation.from_quat(table.quaternions))(u).as_matrix()
    found[:3, 3] = [np.interp(u, table.times, column) for column in table.positions.T]
    return found


def pose_at(case: Case, name: str, t: float, *, left: bool = False) -> np.ndarray:
    """(4, 4) where a body is at a time of the run; `left` is the moment before. Not to be written to."""
    return _pose_at(case, name, t, left)


@functools.lru_cache(20_000)
def _pose_at(case: Case, name: str, t: float, left: bool) -> np.ndarray:
    found = _pose_worked_out(case, name, t, left=left)
    found.setflags(write=False)
    return found


def _pose_worked_out(case: Case, name: str, t: float, *, left: bool) -> np.ndarray:
    if "/" in name:
        return link_at(case, name, t, left=left)
    thing = next(one for one in case.obstacles if one.name == name)
    begun = [
        c
        for c in case.carries
        if c.part == name and (c.window.start < t or (c.window.start == t and not left))
    ]
    if begun:
        last = max(begun, key=lambda carry: carry.window.start)
        start, until = last.window.start, min(last.window.end, t)
        held = np.linalg.inv(pose_at(case, last.by, start)) @ pose_at(case, name, start, left=True)
        ended = last.window.end < t or (last.window.end == t and not left)
        return pose_at(case, last.by, until, left=left or ended) @ held
    if thing.moves is not None:
        return table_at(thing.moves, t, left=left)
    if thing.mount is not None:
        return pose_at(case, thing.mount.on, t, left=left) @ thing.mount.pose
    return thing.world_from_body.copy()
