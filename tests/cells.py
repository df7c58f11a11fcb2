"""Random cells in which everything moves, and where their bodies are, by formulas of their own.

`pose_at` shares no code with the package: joints by matrices, quaternions by scipy, carried parts by following who
holds them. Not for: shapes and distances.
"""

from __future__ import annotations

import functools

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.spatial.transform import Rotation, Slerp

import clearance as cl
from clearance.world.body import Body, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case, Limits, PlacedRobot
from clearance.world.mount import Mount
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.timing import Timing, Window
from clearance.world.trajectory import Trajectory

END = 6.0
"""[s] The first robot's table ends here, so that the run does too."""


def pose(rng: np.random.Generator, far: float = 1.0) -> np.ndarray:
    """A random pose within `far` [m] of the origin along each axis."""
    made = np.eye(4)
    made[:3, :3] = Rotation.random(random_state=int(rng.integers(2**31))).as_matrix()
    made[:3, 3] = rng.uniform(-far, far, 3)
    return made


def arm(name: str, rng: np.random.Generator) -> Robot:
    """A base, a link that turns on it, and one that slides on that."""
    joints = (
        Joint(
            "turn", JointKind.REVOLUTE, "base", "boom", pose(rng, 0.3), np.array([0.0, 0.0, 1.0])
        ),
        Joint(
            "slide", JointKind.PRISMATIC, "boom", "tool", pose(rng, 0.3), np.array([1.0, 0.0, 0.0])
        ),
    )
    bodies = tuple(Body(link, cl.box(rng.uniform(0.05, 0.2, 3))) for link in ("boom", "tool"))
    return Robot(name, ("base", "boom", "tool"), joints, bodies)


def table_times(rng: np.random.Generator, end: float) -> np.ndarray:
    """Some times from 0 to `end`, both among them."""
    return np.unique(np.concatenate([[0.0, end], rng.uniform(0.0, end, int(rng.integers(1, 5)))]))


def timing(rng: np.random.Generator, *, may_end: bool = True) -> Timing:
    """A random start and rate; what ends may loop."""
    after = rng.choice(["hold", "loop"]) if may_end else "hold"
    return Timing(float(rng.uniform(0.0, 1.0)), float(rng.choice([1.0, 0.5, 2.0])), str(after))


def trajectory(rng: np.random.Generator, end: float) -> Trajectory:
    """Random positions, of every second one with velocities."""
    times = table_times(rng, end)
    positions = rng.uniform(-1.0, 1.0, (len(times), 2))
    rates = rng.uniform(-1.0, 1.0, (len(times), 2)) if rng.random() < 0.5 else None
    return Trajectory(times, ("turn", "slide"), positions, rates)


def pose_table(rng: np.random.Generator, end: float) -> PoseTable:
    """Random poses."""
    times = table_times(rng, end)
    turned = Rotation.random(len(times), random_state=int(rng.integers(2**31))).as_quat()
    return PoseTable(times, rng.uniform(-1.5, 1.5, (len(times), 3)), turned, timing(rng))


def cell(seed: int, *, apart: float = 0.0) -> Case:
    """Two robots, the second on a third that is a table; a door that moves, a crate that rides, parts in hands.

    Args:
        apart: [m] further away stand the bases.
    """
    rng = np.random.default_rng(seed)
    bases = [pose(rng) for _ in range(2)]
    bases[1][0, 3] += apart
    robots = (
        PlacedRobot(arm("left", rng), trajectory(rng, END), bases[0]),
        PlacedRobot(
            arm("right", rng), trajectory(rng, 3.0), mount=Mount("track/tool", pose(rng, 0.5)),
            timing=timing(rng),
        ),
        PlacedRobot(arm("track", rng), trajectory(rng, 2.0), bases[1], timing=timing(rng)),
    )  # fmt: skip
    small = [cl.box(rng.uniform(0.05, 0.3, 3)) for _ in range(5)]
    obstacles = (
        Obstacle(Body("post", small[0]), pose(rng, 2.0)),
        Obstacle(Body("door", small[1]), moves=pose_table(rng, 2.0)),
        Obstacle(Body("crate", small[2]), mount=Mount("door", pose(rng, 0.3))),
        Obstacle(Body("part", small[3]), pose(rng, 2.0)),
        Obstacle(Body("lid", small[4]), mount=Mount("part", pose(rng, 0.2))),
    )
    t = np.sort(rng.uniform(0.0, END, 4)).tolist()
    carries = (
        Carry("part", "left/tool", Window(t[0], t[1])),
        Carry("part", "right/tool", Window(t[1], t[2])),
        Carry("part", "door", Window(t[3])),
    )
    return Case("cell", robots, obstacles, Limits(0.01, 0.05), carries=carries)


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
