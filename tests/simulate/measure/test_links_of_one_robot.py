"""Links of one robot that no single joint joins, without an SRDF: what can be worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.pairs import measured_pairs
from clearance.world.placed_robot import PlacedRobot, SelfClearance
from clearance.world.robot import Joint, JointKind
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, random_robot
from tests.simulate.measure.wandering import N_STEPS, case_of, poses_of

X, Z = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])


def joint(kind, parent, child, place=(0.0, 0.0, 0.0), axis=X):
    return Joint(f"{parent}_{child}", JointKind(kind), parent, child, at(*place), axis)


def run_of(joints, shapes, moves):
    """A run of a robot of boxes, at the samples 0, 1 and 2 s of joints that move evenly from 0.

    Args:
        shapes: size and centre [m] by link. moves: where each joint ends [rad or m].
    """
    links = (joints[0].parent, *(one.child for one in joints))
    bodies = tuple(
        cl.Body(name, cl.box(shapes[name][0]).transformed(at(*shapes[name][1])))
        for name in links
        if name in shapes
    )
    rows = np.linspace(0.0, 1.0, 3)[:, None] * np.array([*moves.values()])
    path = cl.Trajectory(np.arange(3.0), tuple(moves), rows)
    robot = cl.Robot("own", links, joints, bodies)
    placed = cl.PlacedRobot(robot, path, self_clearance=cl.SelfClearance())
    return cl.check(cl.Case("own", (placed,), ()))


def met(run):
    return run.verdict.status, {run.worst["link"], run.worst["obstacle"]}


def test_two_carts_on_a_bare_world_meet():
    joints = (joint("prismatic", "world", "left"), joint("prismatic", "world", "right", (1, 0, 0)))
    cube = ((0.1, 0.1, 0.1), (0, 0, 0))
    ends = {"world_left": 0.5, "world_right": -0.5}
    run = run_of(joints, {"left": cube, "right": cube}, ends)
    assert met(run) == ("contact", {"left", "right"})
    assert run.record.clearances.tolist() == pytest.approx([0.9, 0.4, 0.0])
    deepest = run.record.deepest.penetration
    assert deepest == pytest.approx(0.1)  # the cubes coincide, and have sides of 0.1 m


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
