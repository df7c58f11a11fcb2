"""Hostile pairs of bodies that both move, against rational arithmetic."""

from collections.abc import Iterator
from fractions import Fraction

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.case import PlacedRobot, SelfClearance
from clearance.world.pairs import measured_pairs
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests import oracle
from tests.examples import first_fast
from tests.made_cases import at, faces_of
from tests.oracle.kinematics import link_poses, on, placed, seen_from
from tests.simulate.measure.hostile_actors import (
    CARRIED_FROM,
    CARRIED_UNTIL,
    CUBE,
    NEEDLE,
    SLAB,
    carrying,
    chain,
    every,
    is_rigid,
)
from tests.simulate.measure.wandering import N_STEPS, wandering
from tests.strategies import rotations

NEAR_ORIGIN, FAR_OFF = (0.0, 0.0, 0.0), (700.0, -1300.0, 400.0)


def exact_poses(placed_robot: PlacedRobot, step: int) -> dict:
    """Of all links of a robot that stands in the world, at a step."""
    asked = placed_robot.given_trajectory
    values = dict(zip(asked.joint_names, asked.positions[step].tolist(), strict=True))
    return link_poses(placed_robot.robot, values, placed_robot.world_from_base)


def exact_sq(one: cl.Polyhedron, pose_one, other: cl.Polyhedron, pose_other) -> Fraction:
    """The squared distance of two solids at exact poses."""
    return oracle.solid_distance_sq(
        placed(one.vertices, pose_one),
        faces_of(one),
        placed(other.vertices, pose_other),
        faces_of(other),
    )


def exact_errors(case: cl.Case, steps: range) -> Iterator[float]:
    """[m] How far each pair is off at some steps; of a case of robots and obstacles that stand in the world."""
    pairs, _ = measured_pairs(case)
    found = every(case)
    for step in steps:
        by_robot = [exact_poses(robot, step) for robot in case.robots]

        def pose_of(body, by_robot=by_robot):
            if body.is_obstacle:
                return case.obstacles[body.i_body].world_from_body
            return by_robot[body.i_robot][body.own_name_in(case)]

        for i_pair, pair in enumerate(pairs):
            sq = exact_sq(
                pair.a.shape_in(case), pose_of(pair.a), pair.b.shape_in(case), pose_of(pair.b)
            )
            yield float(oracle.error(float(found[step, i_pair]), sq))


@pytest.mark.parametrize("origin", first_fast([NEAR_ORIGIN, FAR_OFF], 1))
@pytest.mark.parametrize("seed", first_fast(range(2), 1))
def test_two_robots_of_needles_and_slabs_are_as_far_apart_as_is_exact(seed, origin):
    """Of rounding, far from the origin, there is some 2^-52 of the coordinates in each of a few sums."""
    random = np.random.default_rng(seed)
    robots = []
    for name in ("left", "right"):
        robot = chain(name, random, 5, {1: CUBE, 3: SLAB, 5: NEEDLE})
        base = at(*(np.array(origin) + random.normal(0.0, 0.6, 3)), turned=rotations(random, 1)[0])
        path = wandering(random, robot, cubic=False)
        robots.append(PlacedRobot(robot, path, base, self_clearance=SelfClearance()))
    case = cl.Case("hostile", tuple(robots), ())
    size = 1.0 + np.abs(origin).max()
    assert max(exact_errors(case, range(0, N_STEPS, 20))) < 2e-14 * size


@pytest.mark.parametrize("gap", [1e-7, 1e-4])
def test_parallel_slabs_that_both_slide_keep_their_exact_gap(gap):
    """Everything is equally near all the time, and both bodies move far more than they are apart."""
    slab = box((0.5, 0.5, 0.01))
    robots = tuple(
        PlacedRobot(
            Robot(
                name,
                ("base", "slide", "plate"),
                (
                    Joint(
                        "x",
                        JointKind.PRISMATIC,
                        "base",
                        "slide",
                        np.eye(4),
                        np.array([1.0, 0.0, 0.0]),
                    ),
                    Joint(
                        "y",
                        JointKind.PRISMATIC,
                        "slide",
                        "plate",
                        np.eye(4),
                        np.array([0.0, 1.0, 0.0]),
                    ),
                ),
                (Body("plate", slab),),
            ),
            Trajectory(np.linspace(0.0, 1.0, 30), ("x", "y"), np.linspace((0, 0), way, 30)),
            at(z=height),
        )
        for name, way, height in (
            ("below", (0.25, 0.125), 0.0),
            ("above", (-0.125, 0.25), 0.01 + gap),
        )
    )
    run = cl.check(cl.Case("parallel", robots, ()))
    assert max(exact_errors(run.record.case, range(0, 30, 7))) < 1e-16
    assert (run.certificate.lower_bound >= gap - run.certificate.gap).all()
    assert (run.certificate.lower_bound <= run.record.clearances).all()


@pytest.mark.parametrize("seed", [0])
def test_two_bodies_with_a_long_chain_between_are_as_far_apart_as_is_exact(seed):
    """36 joints between, of which some follow others; each adds its rounding of coordinates of some metres."""
    random = np.random.default_rng(seed)
    robot = chain("snake", random, 38, {1: CUBE, 2: SLAB, 37: CUBE, 38: NEEDLE})
    base = at(1.0, 2.0, 3.0, turned=rotations(random, 1)[0])
    asked = SelfClearance()
    snake = PlacedRobot(robot, wandering(random, robot, cubic=False), base, self_clearance=asked)
    case = cl.Case("snake", (snake,), ())
    pairs, _ = measured_pairs(case)
    n_between = [
        abs(
            robot.link_names.index(p.a.own_name_in(case))
            - robot.link_names.index(p.b.own_name_in(case))
        )
        for p in pairs
    ]
    assert max(n_between) >= 36
    assert max(exact_errors(case, range(0, N_STEPS, 12))) < 2e-13


@pytest.mark.parametrize("seed", range(2))
@pytest.mark.slow
def test_a_body_and_a_part_carried_on_its_own_tree_are_as_far_apart_as_is_exact(seed):
    case = carrying(seed)
    run = cl.check(case, certify=False)
    times, clearances = run.record.timeline.times, run.record.clearances
    (arm,), (part,) = case.robots, case.obstacles
    for step in range(0, len(times), 9):
        if times[step] in (CARRIED_FROM, CARRIED_UNTIL):
            continue
        links = exact_poses_at(arm, times[step])
        held = CARRIED_FROM < times[step] < CARRIED_UNTIL
        mates = [body for body in arm.robot.bodies if body.name not in arm.exclude_links]
        least = min(
            exact_sq(body.shape, links[body.name], part.body.shape, exact_part(case, times[step]))
            for body in mates
            if not (held and is_rigid(arm.robot, body.name, "l6"))
        )
        least = min([least, *self_sq(case, links)])
        assert oracle.error(clearances[step], least) < 1e-13


def self_sq(case: cl.Case, links: dict) -> Iterator[Fraction]:
    """Of the pairs of links that are measured."""
    pairs, _ = measured_pairs(case)
    for pair in pairs:
        if not pair.b.is_obstacle:
            one, other = (body.body_in(case) for body in (pair.a, pair.b))
            yield exact_sq(one.shape, links[one.name], other.shape, links[other.name])


def exact_part(case: cl.Case, time: float):
    """Where the part is: as it was picked up, and after it is let go where it was then."""
    (arm,), (part,) = case.robots, case.obstacles
    if time <= CARRIED_FROM:
        return part.world_from_body
    grip = seen_from(exact_poses_at(arm, CARRIED_FROM)["l6"], part.world_from_body)
    return on(exact_poses_at(arm, min(time, CARRIED_UNTIL))["l6"], grip)


def exact_poses_at(arm: PlacedRobot, time: float) -> dict:
    """Of all links; between samples the joints are interpolated in rational numbers."""
    asked = arm.given_trajectory
    after = int(np.clip(np.searchsorted(asked.times, time), 1, asked.n_steps - 1))
    first, last = (Fraction(float(t)) for t in asked.times[after - 1 : after + 1])
    share = (Fraction(float(time)) - first) / (last - first)
    values = {
        name: float(Fraction(a) + share * (Fraction(b) - Fraction(a)))
        for name, a, b in zip(
            asked.joint_names,
            asked.positions[after - 1].tolist(),
            asked.positions[after].tolist(),
            strict=True,
        )
    }
    return link_poses(arm.robot, values, arm.world_from_base)
