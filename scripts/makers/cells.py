"""Random cells in which everything moves: robots on robots, a door, a crate that rides, parts in hands."""

from __future__ import annotations

import numpy as np
from scipy.spatial.transform import Rotation

import clearance as cl
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case, Limits
from clearance.world.placed_robot import PlacedRobot
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
