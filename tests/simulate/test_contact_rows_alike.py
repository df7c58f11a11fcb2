"""A row in contact is the same wherever a sweep starts: the point that it names too."""

from __future__ import annotations

from pathlib import Path

import numpy as np

import clearance as cl
from clearance.simulate.kinematic import kinematic_motion
from clearance.simulate.measure import measure
from clearance.world.motion import Motion
from clearance.world.pairs import measured_pairs

ROOT = Path(__file__).parents[2]


def measured(case, motion, steps, need="steps"):
    """What is found of some steps of a motion that is nothing else."""
    part = Motion(motion.placed, motion.times[steps], motion.positions[steps], np.zeros(len(steps)))
    return measure(case, (part,), measured_pairs(case)[0], need, jobs=1)


def test_a_row_in_contact_does_not_depend_on_where_the_sweep_starts():
    case = cl.load_case(ROOT / "scenes" / "panda_shelf" / "case.yaml")
    motion = kinematic_motion(case.robots[0])
    whole = measured(case, motion, np.arange(motion.n_steps))
    touching = np.flatnonzero(whole.clearance == 0.0)
    assert len(touching) == 22
    for start in (0, 1, 10, 21):
        part = measured(case, motion, touching[start:])
        assert (part.clearance == 0.0).all()
        assert np.array_equal(part.pair, whole.pair[touching[start:]])
        assert np.array_equal(part.points, whole.points[touching[start:]])


def test_the_point_of_a_contact_is_that_of_a_single_question():
    case = cl.load_case(ROOT / "scenes" / "panda_shelf" / "case.yaml")
    motion = kinematic_motion(case.robots[0])
    found, pairs = measured(case, motion, np.arange(motion.n_steps)), measured_pairs(case)[0]
    robot = case.robots[0].robot
    for step in np.flatnonzero(found.clearance == 0.0):
        pair = pairs[found.pair[step]]
        body, obstacle = robot.bodies[pair.i_body], case.obstacles[pair.i_obstacle]
        pose = motion.poses(step, step + 1)[0, robot.link_names.index(body.name)]
        alone = cl.distance(body.shape, obstacle.body.shape, pose_a=pose, pose_b=obstacle.world_from_body)
        assert alone.contact
        assert np.allclose(found.points[step], [alone.point_a, alone.point_b], rtol=0.0, atol=1e-12)


def test_of_several_pairs_in_contact_the_least_is_named():
    case = cl.load_case(ROOT / "scenes" / "panda_shelf" / "case.yaml")
    motion = kinematic_motion(case.robots[0])
    steps, every = (measured(case, motion, np.arange(motion.n_steps), need) for need in ("steps", "pairs"))
    for step in np.flatnonzero(steps.clearance == 0.0):
        assert steps.pair[step] == np.flatnonzero(every.every[step] == 0.0)[0]
