"""Random robots with boxes on their links that wander about one another, and every distance by one question each.

For tests of pairs of which both bodies move.
"""

from dataclasses import replace

import numpy as np

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.forest import link_poses_at
from clearance.world.motion import kinematic_motion
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.robot import Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, random_robot
from tests.strategies import rotations

N_STEPS = 60


def solid_robot(random: np.random.Generator, name: str, n_joints: int) -> Robot:
    """A random robot with a box on most of its links."""
    robot = random_robot(random, n_joints, sizes=(0.2, 0.5), mimics=0.2)
    bodies = tuple(
        Body(
            link,
            box(tuple(random.uniform(0.05, 0.3, 3))).transformed(at(*random.normal(0, 0.1, 3))),
        )
        for link in robot.link_names
        if random.random() < 0.8
    )
    return replace(robot, name=name, bodies=bodies)


def wandering(random: np.random.Generator, robot: Robot, *, cubic: bool) -> Trajectory:
    """Joints that go to and fro; some stand for a while."""
    names = tuple(joint.name for joint in robot.moving_joints)
    times = np.linspace(0.0, 3.0, N_STEPS)
    rate = random.uniform(0.0, 2.0, len(names)) * (random.random(len(names)) < 0.8)
    phase = random.uniform(0.0, 6.0, len(names))
    angle = times[:, None] * rate + phase
    velocities = rate * np.cos(angle) if cubic else None
    return Trajectory(times, names, np.sin(angle), velocities)


def case_of(seed: int, n_robots: int, *, cubic: bool = False) -> cl.Case:
    """Robots that stand about one another, and a box."""
    random = np.random.default_rng(seed)
    robots = []
    for i in range(n_robots):
        robot = solid_robot(random, f"r{i}", int(random.integers(3, 7)))
        base = at(*random.normal(0.0, 0.7, 3), turned=rotations(random, 1)[0])
        path = wandering(random, robot, cubic=cubic and i == 0)
        robots.append(PlacedRobot(robot, path, base, self_clearance=SelfClearance()))
    block = cl.Obstacle(Body("block", box((0.4, 0.4, 0.4))), at(1.5, 0.0, 0.5))
    return cl.Case("moving", tuple(robots), (block,), limits=cl.Limits(0.05, 0.2))


def poses_of(case: cl.Case) -> np.ndarray:
    """(steps, links, 4, 4) [m] of the case's forest."""
    motions = [kinematic_motion(placed) for placed in case.robots]
    return link_poses_at(case, motions, slice(None))
