"""The scenes in which everything moves, and a robot of two arms that minds itself, held against FCL at every step.

FCL is asked about the same pairs, in each phase about those that are measured then.
"""

from __future__ import annotations

import sysconfig
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.formats.robot.srdf import load_srdf
from clearance.formats.robot.urdf.robot import load_urdf
from clearance.world.case import PlacedRobot, SelfClearance
from clearance.world.trajectory import Trajectory

SCENES = Path(__file__).parents[2] / "scenes"
ROBOTS = Path(sysconfig.get_path("purelib")) / "cmeel.prefix/share/example-robot-data/robots"
PARTS_AND_STATUSES = {  # bodies that the nearest pairs must come to, and the statuses that occur
    "dual_arm_handover": ({"fixture", "tray", "workpiece"}, {"clear"}),
    "turntable_cell": ({"tower_1", "tower_2", "fixture", "lamp"}, {"clear", "near"}),
    "door_and_arm": ({"door", "part_1", "part_2", "part_3"}, {"clear", "near"}),
}


@pytest.mark.parametrize("name", PARTS_AND_STATUSES)
def test_fcl_agrees_with_a_scene_at_every_step(name):
    run = cl.check(cl.load_case(SCENES / name / "case.yaml"), cross_check=True)
    assert run.steps.num_rows >= 200
    assert run.cross_check.agrees and run.cross_check.n_steps == run.steps.num_rows
    assert run.cross_check.greatest_difference <= 1e-9
    assert run.cross_check.worst_witness_error <= 1e-9
    parts, statuses = PARTS_AND_STATUSES[name]
    assert set(run.steps["status"].to_pylist()) == statuses and run.passed
    measured = {body for pair in run.pair_minima for body in (pair.link, pair.obstacle)}
    assert parts <= measured


TWO_ARMS = {
    "pr2": ("pr2_description/urdf/pr2.urdf", "pr2_description/srdf/pr2.srdf"),
    "talos": ("talos_data/robots/talos_reduced.urdf", "talos_data/srdf/talos.srdf"),
}
"""Two arms on a base, and a humanoid."""

N_STEPS = 12


@pytest.mark.skipif(not ROBOTS.is_dir(), reason="example-robot-data is not installed")
@pytest.mark.parametrize("name", TWO_ARMS)
def test_fcl_agrees_with_a_robot_of_two_arms_that_minds_itself(name):
    urdf, srdf = (ROBOTS / path for path in TWO_ARMS[name])
    robot = load_urdf(urdf, package_dirs=[ROBOTS.parents[1]])
    joints = robot.moving_joints
    rng = np.random.default_rng(5)
    lower, upper = (
        np.clip([getattr(joint, end) for joint in joints], -0.3, 0.3) for end in ("lower", "upper")
    )
    positions = rng.uniform(lower, upper, (N_STEPS, len(joints)))
    names = tuple(joint.name for joint in joints)
    asked = Trajectory(np.arange(float(N_STEPS)), names, positions)
    placed = PlacedRobot(
        robot, asked, self_clearance=SelfClearance(load_srdf(srdf, robot), trust_never=True)
    )
    run = cl.check(cl.Case(name, (placed,), ()), certify=False, cross_check=True)
    assert len(run.pair_minima) > 100
    assert run.record.clearances.max() > 0.0
    assert run.cross_check.agrees and run.cross_check.n_steps == N_STEPS
