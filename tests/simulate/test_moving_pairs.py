"""Pairs of which both bodies move: links of one robot, and of two, against every pair measured by itself."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.geometry.shapes import box
from clearance.world.body import Body
from clearance.world.case import PlacedRobot, SelfClearance
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import measured_pairs
from clearance.world.trajectory import Trajectory
from tests.examples import first_fast
from tests.made_cases import at, random_robot
from tests.simulate.wandering import N_STEPS, case_of, every_distance, poses_of

NEEDS = ("steps", "pairs", "minimum", "limit")


@pytest.mark.parametrize("n_robots", [1, 2])
@pytest.mark.parametrize("seed", first_fast(range(6), 2))
def test_every_need_finds_what_single_questions_find(seed, n_robots):
    case = case_of(seed, n_robots)
    truth = every_distance(case)
    least = truth.min(axis=1)
    for need in NEEDS:
        run = cl.check(case, need=need, certify=False)
        told = run.record.clearances
        known = np.isfinite(told)
        assert np.allclose(told[known], least[known], rtol=0.0, atol=1e-9)
        if need in ("steps", "pairs"):
            assert known.all()
        assert run.worst_sample["clearance"] == pytest.approx(least.min(), abs=1e-9)
        if need == "limit" and least.min() < case.limits.warn:
            assert known[least < case.limits.warn].all()
        if not known.all():
            bounds = run.steps["lower_bound"].to_numpy()
            assert (bounds[~known] <= least[~known] + 1e-9).all()


@pytest.mark.parametrize("n_robots", [1, 2])
@pytest.mark.parametrize("seed", range(4))
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


@pytest.mark.parametrize("cubic", [False, True])
@pytest.mark.parametrize("seed", first_fast(range(4), 1))
def test_the_certificate_holds_between_the_steps(seed, cubic):
    case = case_of(seed, 2, cubic=cubic)
    run = cl.check(case)
    finer = 40
    motions = [kinematic_motion(placed) for placed in case.robots]
    pairs, _ = measured_pairs(case)
    bounds = np.asarray(run.certificate.lower_bound)
    for step in range(0, N_STEPS - 1, 5):
        for share in np.linspace(0.0, 1.0, finer):
            poses = np.concatenate([motion_poses(m, step, share) for m in motions], axis=1)
            least = min(
                cl.distance(
                    pair.a.shape_in(case), pair.b.shape_in(case),
                    pose_a=pair.a.poses_in(case, poses)[0], pose_b=pair.b.poses_in(case, poses)[0],
                ).distance
                for pair in pairs
            )  # fmt: skip
            assert bounds[step] <= least + 1e-9


def motion_poses(motion, step, share):
    """(1, n_links, 4, 4) at a share of the interval after a step."""
    from clearance.world.kinematics import link_poses

    return link_poses(motion.placed, motion.positions_after(step, float(share))[None])


def test_gluing_the_world_to_another_base_changes_no_self_clearance():
    case = case_of(3, 1)
    moved = replace(case.robots[0], world_from_base=at(30.0, -20.0, 10.0))
    alone = [replace(case, robots=(robot,), obstacles=()) for robot in (case.robots[0], moved)]
    one, other = (cl.check(each, certify=False).record.clearances for each in alone)
    assert one.tolist() == other.tolist()


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
