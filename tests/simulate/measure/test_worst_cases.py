"""Cases made to defeat every bound: the answers are still those of brute force and of FCL."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.crosscheck.triangles import triangle_soup
from clearance.simulate.measure.layout import PairsInMotion
from clearance.simulate.measure.measure import measure
from clearance.simulate.measure.resources import Resources
from clearance.world.kinematics import link_poses
from clearance.world.motion import Motion, kinematic_motion
from clearance.world.pairs import measured_pairs
from tests.made_cases import WORST, arm, at, flying
from tests.simulate.answers.test_contact_modes import channel

SOME_STEPS = (0, 7, 23)


@pytest.fixture(scope="module", params=WORST)
def run(request):
    return cl.check(WORST[request.param](), need="pairs", certify=False)


def placed_bodies(run, step):
    """Shape and `world_from_body` of every link, and of every obstacle."""
    case = run.record.case
    (placed,) = case.robots
    poses = link_poses(placed, placed.trajectory.positions[step : step + 1])[0]
    names = placed.robot.link_names
    links = [(body.name, body.shape, poses[names.index(body.name)]) for body in placed.robot.bodies]
    return links, [(o.body.name, o.body.shape, o.world_from_body) for o in case.obstacles]


def pair_rows(run, step):
    rows = run.pairs.to_pydict()
    keys = zip(rows["step"], rows["link"], rows["obstacle"], rows["clearance"], strict=True)
    return {(link, obstacle): clearance for i, link, obstacle, clearance in keys if i == step}


@pytest.mark.peer
@pytest.mark.parametrize("step", SOME_STEPS)
def test_fcl_in_millimetres_says_the_same_of_every_pair(run, step):
    fcl = pytest.importorskip("fcl")

    def in_millimetres(shape, pose):
        soup = triangle_soup(shape)
        model = fcl.BVHModel()
        model.beginModel(len(soup.vertices), len(soup.triangles))
        model.addSubModel(soup.vertices * 1e3, soup.triangles)
        model.endModel()
        return fcl.CollisionObject(model, fcl.Transform(pose[:3, :3], pose[:3, 3] * 1e3))

    links, obstacles = placed_bodies(run, step)
    theirs = [in_millimetres(shape, pose) for _, shape, pose in obstacles]
    found = pair_rows(run, step)
    for name, shape, pose in links:
        ours = in_millimetres(shape, pose)
        for (obstacle, *_), other in zip(obstacles, theirs, strict=True):
            said = fcl.distance(ours, other, fcl.DistanceRequest(), fcl.DistanceResult()) * 1e-3
            assert found[name, obstacle] == pytest.approx(max(0.0, said), abs=1e-9)


def measured(case, motion, steps, need="steps"):
    """What is found of some steps of a motion that is nothing else."""
    part = Motion(motion.placed, motion.times[steps], motion.positions[steps], np.zeros(len(steps)))
    return measure(PairsInMotion(case, (part,), measured_pairs(case)[0]), need, Resources(jobs=1))


def ball_through_wall():
    """A faceted ball that slides into a channel, askew, so that many faces meet at once."""
    positions = np.zeros((100, 6))
    positions[:, 0] = np.linspace(-0.3, 1.7, 100)
    turned = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    wall = channel(), at(0.7, 0.05, 0.02, turned=turned)
    return flying("ball", cl.sphere(0.15), [wall], positions)


def whole_run(need):
    """The ball's case and motion, what is measured of all its steps, and those in contact."""
    case = ball_through_wall()
    motion = kinematic_motion(case.robots[0])
    whole = measured(case, motion, np.arange(motion.n_steps), need)
    return case, motion, whole, np.flatnonzero(whole.clearance == 0.0)


@pytest.mark.parametrize("need", ["steps", "pairs"])
def test_every_row_before_in_and_after_contact_is_that_of_its_step_alone(need):
    case, motion, whole, touching = whole_run(need)
    assert 5 < touching[0] < touching[-1] < motion.n_steps - 5 and len(touching) > 20
    for step in range(motion.n_steps):
        alone = measured(case, motion, np.array([step]), need)
        assert alone.clearance[0] == whole.clearance[step]
        assert np.array_equal(alone.points[0], whole.points[step])


def test_of_several_pairs_in_contact_the_least_is_named():
    """Three links in a row, and two balls that both the last two go through."""
    balls = [(cl.sphere(0.1, tolerance=0.01), at(x)) for x in (0.35, 0.6)]
    case = arm(
        "through", [cl.box((0.2, 0.1, 0.1))] * 3, balls, np.linspace([-1, 0, 0], [1, 0, 0], 60)
    )
    motion = kinematic_motion(case.robots[0])
    steps, every = (
        measured(case, motion, np.arange(motion.n_steps), need) for need in ("steps", "pairs")
    )
    touching = np.flatnonzero(steps.clearance == 0.0)
    assert ((every.every[touching] == 0.0).sum(axis=1) > 1).any()
    for step in touching:
        assert steps.pair[step] == np.flatnonzero(every.every[step] == 0.0)[0]
