"""Cases in which more moves than one robot among standing things, made in memory from real robots.

An arm that minds itself and a scene, a humanoid that minds itself, two arms over one table. Seeds are fixed; what
touches at rest is allowed, so that no run ends at a contact. Not for: measuring.
"""

from __future__ import annotations

import sysconfig
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

import clearance as cl
from clearance.formats.robot.request import load_robot
from clearance.formats.robot.srdf import load_srdf
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import Pair, measured_pairs
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.robot import Robot
from clearance.world.rules import Allowance
from clearance.world.trajectory import Trajectory
from scripts.makers.hostile_cases import at, spindle, torus
from scripts.makers.polygon_pairs import rotations

ROBOTS = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
"""Where `pip install example-robot-data` puts them."""

PANDA = ("panda_description/urdf/panda.urdf", "panda_description/srdf/panda.srdf")
TALOS = ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf")

READY = {
    "panda_joint2": -0.785, "panda_joint4": -2.356, "panda_joint6": 1.571, "panda_joint7": 0.785,
    "panda_finger_joint1": 0.02,
}  # fmt: skip
HALF_SITTING = {
    "arm_left_1_joint": 0.258, "arm_left_2_joint": 0.173, "arm_left_4_joint": -0.525,
    "arm_right_1_joint": -0.258, "arm_right_2_joint": -0.173, "arm_right_4_joint": -0.525,
    "leg_left_3_joint": -0.411, "leg_left_4_joint": 0.859, "leg_left_5_joint": -0.448,
    "leg_right_3_joint": -0.411, "leg_right_4_joint": 0.859, "leg_right_5_joint": -0.448,
}  # fmt: skip
"""[rad] or [m] about which the joints move; joints that are not named about 0."""

STEP = 0.02
"""[s]"""


def arm_among_obstacles(n_steps: int = 300) -> Case:
    """A Panda with its SRDF that swings among ten rings, spindles and boxes, of itself and of them."""
    robot, matrix = read(*PANDA)
    arm = swinging(robot, matrix, READY, 0.5, n_steps, seed=1)
    alone = settled(Case("arm", (arm,), ()))
    return settled(replace(alone, obstacles=standing_clear(alone, 10)))


def humanoid(n_steps: int = 300) -> Case:
    """Talos with its SRDF, every joint swinging about half sitting."""
    robot, matrix = read(*TALOS)
    return settled(
        Case("humanoid", (swinging(robot, matrix, HALF_SITTING, 0.25, n_steps, seed=2),), ())
    )


def two_arms(n_steps: int = 300) -> Case:
    """Two Pandas face to face over one table, each minding itself, the other and the table."""
    robot, matrix = read(*PANDA)
    turned = np.diag([-1.0, -1.0, 1.0])
    bases = {"left": at(-0.55), "right": at(0.55, turned=turned)}
    arms = tuple(
        replace(
            swinging(replace(robot, name=name), matrix, READY, 0.35, n_steps, seed),
            world_from_base=base,
        )
        for seed, (name, base) in enumerate(bases.items(), start=3)
    )
    table = Obstacle(Body("table", cl.box((1.6, 1.2, 0.05))), at(z=-0.026))
    tray = Obstacle(Body("tray", torus(0.12, 0.02, 48, 12)), at(y=0.3, z=0.04))
    standing = Allowance(("*/panda_link0", "table"))
    return settled(Case("two_arms", arms, (table, tray), allow=(standing,)))


MOVING: dict[str, Callable[..., Case]] = {
    "arm": arm_among_obstacles,
    "humanoid": humanoid,
    "two_arms": two_arms,
}


def absent_robots() -> list[str]:
    """What cannot be run, one line."""
    return [] if ROBOTS.is_dir() else ["absent: example-robot-data (pip install .[bench])"]


def read(urdf: str, srdf: str) -> tuple[Robot, CollisionMatrix]:
    """A robot and its allowed collision matrix."""
    robot = load_robot(ROBOTS / urdf, package_dirs=[ROBOTS.parents[1]])
    return robot, load_srdf(ROBOTS / srdf, robot)


def swinging(
    robot: Robot,
    matrix: CollisionMatrix,
    rest: Mapping[str, float],
    swing: float,
    n_steps: int,
    seed: int,
) -> PlacedRobot:
    """A robot whose joints swing about `rest`, each by no more than `swing` [rad or m] and within its limits."""
    random = np.random.default_rng(seed)
    joints = robot.moving_joints
    lower = np.array([max(joint.lower, -np.pi) for joint in joints])
    upper = np.array([min(joint.upper, np.pi) for joint in joints])
    middle = np.clip([rest.get(joint.name, 0.0) for joint in joints], lower, upper)
    room = np.minimum(swing, np.minimum(upper - middle, middle - lower))
    angle = np.linspace(0.0, 2.0 * np.pi, n_steps)[:, None] * random.integers(1, 4, len(joints))
    positions = middle + room * np.sin(angle + random.uniform(0.0, 2.0 * np.pi, len(joints)))
    names = tuple(joint.name for joint in joints)
    path = Trajectory(STEP * np.arange(n_steps), names, positions)
    return PlacedRobot(robot, path, self_clearance=SelfClearance(matrix))


def settled(case: Case) -> Case:
    """The case with every pair allowed that touches at some step."""
    pairs, _ = measured_pairs(case)
    touching = [pair for pair, least in zip(pairs, least_of(case, pairs), strict=True) if not least]
    rows = tuple(Allowance((pair.a.name_in(case), pair.b.name_in(case))) for pair in touching)
    return replace(case, allow=(*case.allow, *rows))


def least_of(case: Case, pairs: list[Pair]) -> np.ndarray:
    """(p,) [m] the least clearance of each pair over the motion."""
    motions = [kinematic_motion(placed) for placed in case.robots]
    found = measure(PairsInMotion(case, motions, pairs), "pairs", Resources(jobs=1))
    assert found.measure_pair_minima is not None
    return found.measure_pair_minima(None).clearance


def standing_clear(case: Case, n: int) -> tuple[Obstacle, ...]:
    """`n` obstacles about a robot that moves, none of which it touches."""
    random = np.random.default_rng(7)
    chosen: list[Obstacle] = []
    while len(chosen) < n:
        i = len(chosen)
        kind = i % 3
        shape = (torus(0.15, 0.05, 48, 12), spindle(0.08, 0.25, 24), cl.box((0.2, 0.3, 0.1)))[kind]
        away = random.uniform(0.35, 0.9) * rotations(random, 1)[0][0]
        pose = at(away[0], away[1], 0.5 + 0.7 * away[2], turned=rotations(random, 1)[0])
        obstacle = Obstacle(Body(f"o{i}", shape), pose)
        asked = replace(case, obstacles=(obstacle,))
        if least_of(asked, measured_pairs(asked)[0]).all():
            chosen.append(obstacle)
    return tuple(chosen)
