"""Robots of needles and slabs, and one that carries a part past its own links: what tests of actors begin with."""

from dataclasses import replace

import numpy as np

import clearance as cl
from clearance.geometry.shapes import box
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.body import Body
from clearance.world.carry import Carry
from clearance.world.case import PlacedRobot, SelfClearance
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs
from clearance.world.robot import JointKind, Robot
from clearance.world.timing import Window
from tests.made_cases import at, dented, random_robot
from tests.simulate.measure.wandering import wandering
from tests.strategies import rotations

NEEDLE, SLAB, CUBE = (1.0, 1e-4, 1e-4), (0.6, 0.6, 1e-3), (0.2, 0.2, 0.2)


def chain(name: str, random: np.random.Generator, n_joints: int, shapes: dict[int, tuple]) -> Robot:
    """Joints of any kind behind one another, and boxes on some of the links, turned as they come."""
    robot = random_robot(random, n_joints, sizes=(0.0, 0.3), mimics=0.1)
    bodies = tuple(
        Body(robot.link_names[link], box(size).transformed(at(turned=rotations(random, 1)[0])))
        for link, size in shapes.items()
    )
    return replace(robot, name=name, bodies=bodies)


def every(case: cl.Case) -> np.ndarray:
    """(steps, pairs) [m] as the sweep finds them."""
    pairs, _ = measured_pairs(case)
    motions = [kinematic_motion(robot) for robot in case.robots]
    return measure(PairsInMotion(case, motions, pairs), "pairs", Resources(jobs=1)).every


CARRIED_FROM, CARRIED_UNTIL = 0.71, 2.23


def carrying(seed: int) -> cl.Case:
    """A robot that takes up a part with its last link, carries it past its other links, and lets it go."""
    random = np.random.default_rng(seed)
    robot = chain("arm", random, 6, {0: CUBE, 1: SLAB, 2: CUBE, 4: NEEDLE, 6: CUBE})
    arm = PlacedRobot(
        robot,
        wandering(random, robot, cubic=False),
        at(0.3, -0.2, 0.5, turned=rotations(random, 1)[0]),
        exclude_links=tuple(robot.link_names[k] for k in (1, 2)),
        self_clearance=SelfClearance(),
    )
    shape = dented(random, 1, depth=0.3, radius=0.15)
    part = cl.Obstacle(
        Body("part", shape), at(*random.normal(0.0, 0.5, 3), turned=rotations(random, 1)[0])
    )
    carry = Carry("part", "l6", Window(CARRIED_FROM, CARRIED_UNTIL))
    return cl.Case("carrying", (arm,), (part,), carries=(carry,))


def is_rigid(robot: Robot, one: str, other: str) -> bool:
    """True if only fixed joints are between two links of a chain."""
    low, high = sorted(robot.link_names.index(name) for name in (one, other))
    return all(joint.kind is JointKind.FIXED for joint in robot.joints[low:high])
