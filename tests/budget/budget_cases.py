"""Small cases with tolerances, and what is proven of them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

import clearance as cl
from clearance.budget.proven import PairsWithErrors, proven_between, proven_of_steps
from clearance.run.answers import measurement_plan
from clearance.run.question import Question
from clearance.simulate.measure.measure import measure
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.budget import (
    Budget,
    JointTolerance,
    ObstacleTolerance,
    PlacementTolerance,
    RobotTolerance,
)
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind, Mimic, Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, torus
from tests.strategies import rotations

Z = np.array([0.0, 0.0, 1.0])
Y = np.array([0.0, 1.0, 0.0])
X = np.array([1.0, 0.0, 0.0])


def bar(length: float, width: float = 0.04):
    """A box from the origin along x."""
    return cl.box([length, width, width]).transformed(at(0.5 * length))


def arm_robot(name: str = "arm") -> Robot:
    """Two turning links of 0.4 m and 0.3 m, and a slide with a gripper whose second finger follows the first."""
    joints = (
        Joint("shoulder", JointKind.REVOLUTE, "base", "upper", at(0.0, 0.0, 0.1), Z),
        Joint("elbow", JointKind.REVOLUTE, "upper", "fore", at(0.4), Y),
        Joint("wrist", JointKind.PRISMATIC, "fore", "hand", at(0.3), X),
        Joint("left", JointKind.PRISMATIC, "hand", "left_finger", at(0.06, 0.04), Y),
        Joint(
            "right", JointKind.PRISMATIC, "hand", "right_finger", at(0.06, -0.04), Y,
            mimic=Mimic("left", -1.0),
        ),
    )  # fmt: skip
    bodies = (
        Body("upper", bar(0.38)),
        Body("fore", bar(0.28)),
        Body("hand", bar(0.05, 0.1)),
        Body("left_finger", bar(0.08, 0.015)),
        Body("right_finger", bar(0.08, 0.015)),
    )
    links = ("base", "upper", "fore", "hand", "left_finger", "right_finger")
    return Robot(name, links, joints, bodies)


def random_budget(
    case: Case, rng: np.random.Generator, size: float = 1.0, timing: bool = False
) -> Budget:
    """Each tolerance up to some millimetres and milliradians; some are 0."""

    def up_to(most: float) -> float:
        return float(size * most * rng.random() * (rng.random() < 0.8))

    def place() -> PlacementTolerance:
        return PlacementTolerance(up_to(0.003), up_to(0.003))

    robots = {
        placed.robot.name: RobotTolerance(
            {
                j.name: JointTolerance(up_to(0.003), up_to(0.003), place())
                for j in placed.robot.joints
            },
            place(),
            {body.name: up_to(0.001) for body in placed.robot.bodies},
            up_to(0.03) if timing else 0.0,
        )
        for placed in case.robots
    }
    obstacles = {
        one.name: ObstacleTolerance(
            place(), up_to(0.001), up_to(0.03) if timing and one.moves is not None else 0.0
        )
        for one in case.obstacles
    }
    return Budget(robots, obstacles)


def swinging(
    robot: Robot, rng: np.random.Generator, n_steps: int, base=None, mount=None, **others
) -> PlacedRobot:
    """A robot that swings about random positions, by little from step to step."""
    names = tuple(joint.name for joint in robot.moving_joints)
    widths = np.array([0.02 if j.name == "left" else 0.5 for j in robot.moving_joints])
    phase = rng.uniform(0.0, 6.0, len(names))
    t = 0.1 * np.arange(n_steps)
    positions = widths * np.sin(phase + 0.5 * t[:, None])
    placed = (
        {"world_from_base": at() if base is None else base} if mount is None else {"mount": mount}
    )
    return PlacedRobot(robot, Trajectory(t, names, positions), **placed, **others)


def random_case(seed: int, n_steps: int = 5) -> Case:
    """Of four kinds by turns: boxes; concave rings; two robots; parts carried and on carts."""
    rng = np.random.default_rng(seed)
    kind = seed % 4
    obstacles = []
    for i in range(3):
        shape = torus(0.12, 0.04, 8, 4) if kind == 1 else cl.box(rng.uniform(0.05, 0.3, 3))
        away = rng.normal(size=3)
        away *= rng.uniform(0.6, 1.1) / np.linalg.norm(away)
        obstacles.append(Obstacle(Body(f"o{i}", shape), at(*away, turned=rotations(rng, 1)[0])))
    robots = [swinging(arm_robot(), rng, n_steps, self_clearance=SelfClearance())]
    if kind == 2:
        robots.append(
            swinging(
                arm_robot("other"), rng, n_steps, at(0.9, 0.3, 0.2, turned=rotations(rng, 1)[0])
            )
        )
    if kind == 3:
        turned = rotations(rng, 3)
        obstacles += [
            Obstacle(Body("part", bar(0.1)), mount=Mount("hand", at(0.1, turned=turned[0]))),
            Obstacle(
                Body("label", cl.box([0.03, 0.03, 0.03])), mount=Mount("part", at(0.12, 0.05))
            ),
            Obstacle(Body("cup", cl.box([0.03, 0.03, 0.06])), mount=Mount("o0", at(0.0, 0.0, 0.3))),
            Obstacle(Body("cart", cl.box([0.2, 0.1, 0.1])), moves=cart_table(rng, n_steps)),
        ]
    case = Case("random", tuple(robots), tuple(obstacles))
    return replace(case, tolerance=random_budget(case, rng))


def cart_table(
    rng: np.random.Generator, n_steps: int, turn: float = 0.1, speed: float = 0.05
) -> PoseTable:
    """A cart that drives any way, and turns by `turn` [rad/s] about z."""
    times = 0.1 * np.arange(n_steps)
    positions = np.array([0.3, -0.7, 0.0]) + speed * times[:, None] * rng.normal(size=3)
    half = 0.5 * turn * times
    quaternions = np.column_stack([0.0 * half, 0.0 * half, np.sin(half), np.cos(half)])
    return PoseTable(times, positions, quaternions)


def sections_of(case: Case):
    """The sections of a case."""
    return measurement_plan(Question(case)).sections.sections


def proven_sections(case: Case, gap: float | None = None):
    """(section, what was measured, its pairs with errors, rows of steps, rows between) of each section."""
    for section in sections_of(case):
        found = measure(section.in_motion)
        pairs = PairsWithErrors(section.in_motion, case.tolerance)
        steps = proven_of_steps(pairs, found)
        between = None if gap is None else proven_between(pairs, steps, gap)
        yield section, found, pairs, steps, between


def pair_names(case: Case, section) -> list[tuple[str, str]]:
    """Of each pair the names of both bodies, a link's with its robot's before it."""

    def name(body) -> str:
        own = body.own_name_in(case)
        return own if body.is_obstacle else f"{case.robots[body.i_robot].robot.name}/{own}"

    return [(name(pair.a), name(pair.b)) for pair in section.pairs]
