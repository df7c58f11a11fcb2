"""Pairs of bodies that both move, links of one robot too: against rational arithmetic, and by hand."""

from collections.abc import Iterator
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.body import Body
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests import oracle
from tests.examples import first_fast
from tests.made_cases import at, faces_of, random_robot
from tests.oracle.kinematics import link_poses, placed
from tests.simulate.measure.wandering import N_STEPS, case_of, poses_of, wandering
from tests.strategies import rotations

NEAR_ORIGIN, FAR_OFF = (0.0, 0.0, 0.0), (700.0, -1300.0, 400.0)
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


@pytest.mark.slow
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


def test_two_carts_on_a_bare_world_meet():
    """The left from 0 to 0.5 m, the right from 1 m to there; the cubes coincide then, and have sides of 0.1 m."""
    kind, names = JointKind.PRISMATIC, ("left", "right")
    joints = tuple(
        Joint(f"to {one}", kind, "world", one, at(x))
        for one, x in zip(names, (0.0, 1.0), strict=True)
    )
    robot = Robot(
        "own", ("world", *names), joints, tuple(Body(one, box((0.1, 0.1, 0.1))) for one in names)
    )
    rows = np.linspace([0.0, 0.0], [0.5, -0.5], 3)
    path = Trajectory(np.arange(3.0), ("to left", "to right"), rows)
    run = cl.check(cl.Case("own", (PlacedRobot(robot, path, self_clearance=SelfClearance()),), ()))
    assert run.status == "contact" and {run.worst["link"], run.worst["obstacle"]} == {*names}
    assert run.record.clearances.tolist() == pytest.approx([0.9, 0.4, 0.0])
    assert run.record.deepest.penetration == pytest.approx(0.1)


@pytest.mark.parametrize("n_robots", [1, 2])
@pytest.mark.parametrize("seed", range(2))
def test_witness_points_are_in_the_world_and_as_far_apart(seed, n_robots):
    case = case_of(seed, n_robots)
    run = cl.check(case, certify=False)
    pairs, _ = measured_pairs(case)
    poses = poses_of(case)
    steps = run.steps.to_pydict()
    names = {(p.a.name_in(case), p.b.name_in(case)): p for p in pairs}
    for k in range(0, N_STEPS, 7):
        pair = names[steps["body_a"][k], steps["body_b"][k]]
        for side, body in (("a", pair.a), ("b", pair.b)):
            point = np.array([steps[f"{side}_{axis}"][k] for axis in "xyz"])
            speck = box((1e-9, 1e-9, 1e-9)).transformed(at(*point))
            near = cl.distance(speck, body.shape_in(case), pose_b=body.poses_in(case, poses)[k])
            assert near.distance <= 1e-8


def test_a_wrist_that_flies_through_the_cell_has_moved_nowhere_against_its_tool():
    """Where only joints above both move, the distance stays to the last bit and no pair is asked again."""
    random = np.random.default_rng(5)
    bodies = tuple(Body(f"l{i}", box((0.1, 0.2, 0.1))) for i in range(1, 7))
    robot = replace(random_robot(random, 6), bodies=bodies)
    first = robot.moving_joints[0]
    below = robot.link_names[robot.link_names.index(first.child) :]
    names = tuple(joint.name for joint in robot.moving_joints)
    positions = np.zeros((N_STEPS, len(names)))
    positions[:, 0] = np.linspace(0.0, 3.0, N_STEPS)
    placed = PlacedRobot(
        robot,
        Trajectory(np.linspace(0.0, 3.0, N_STEPS), names, positions),
        exclude_links=tuple(name for name in robot.link_names if name not in below),
        self_clearance=SelfClearance(),
    )
    run = cl.check(cl.Case("flying", (placed,), ()))
    n_pairs = len(measured_pairs(run.record.case)[0])
    assert len(set(run.record.clearances.tolist())) == 1
    assert (run.certificate.lower_bound >= run.record.clearances - 1e-5).all()
    assert run.record.tally["queries"] <= n_pairs
