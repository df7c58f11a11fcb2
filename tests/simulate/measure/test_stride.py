"""Steps that are passed over: the bound by joint positions alone, and that nothing is missed by it."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.geometry.shapes import box, cylinder
from clearance.geometry.tree import surface_of
from clearance.kernels.motion.world import World
from clearance.world.case import Case, Limits
from clearance.world.kinematics import link_poses
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.examples import examples
from tests.made_cases import arm, at, dented, random_robot, spindle, torus
from tests.simulate.measure.forests import links_of, ways_in
from tests.strategies import rotations

SCENES = Path(__file__).parents[3] / "scenes"
SHAPE = box((0.3, 0.1, 0.2))
ASIDE = np.block(
    [[np.eye(3), np.array([[0.4], [0.0], [-0.2]])], [np.zeros((1, 3)), np.ones((1, 1))]]
)


def ways(surface, frames, links, positions):
    """(k,) [m] the bound on the motion of the body from the first step to each."""
    body, no_pairs = np.zeros(1, dtype=np.int64), np.empty((0, 2), dtype=np.int64)
    world = World(body, frames, body, np.empty((0, 4, 4)), no_pairs, links)
    return ways_in(surface, world, positions)


def placed_at(rng: np.random.Generator, robot: Robot) -> PlacedRobot:
    base = np.eye(4)
    base[:3, 3] = rng.uniform(-3.0, 3.0, 3)
    return PlacedRobot(robot, Trajectory(np.zeros(1), (), np.zeros((1, 0))), world_from_base=base)


@examples(60)
@given(st.integers(0, 2**32 - 1), st.integers(1, 7), st.sampled_from([0.0, 1e-9, 1e-3, 0.3, 3.0]))
def test_no_body_moves_farther_than_its_joints_say(seed, n_joints, size):
    rng = np.random.default_rng(seed)
    placed = [
        placed_at(rng, random_robot(rng, n_joints, sizes=(0.0, 0.5, 50.0), mimics=0.4))
        for _ in range(2)
    ]
    moving = [len(one.robot.moving_joints) for one in placed]
    first = rng.uniform(-4.0, 4.0, sum(moving)) * rng.choice([1.0, 1e3])
    positions = first + size * rng.uniform(-1.0, 1.0, (20, sum(moving)))
    positions[0] = first
    body = SHAPE if rng.random() < 0.5 else SHAPE.transformed(ASIDE)
    corners = np.column_stack([body.vertices, np.ones(len(body.vertices))])
    link, i_robot = n_joints, int(rng.integers(2))
    frame = link + i_robot * (n_joints + 1)
    columns = slice(0, moving[0]) if i_robot == 0 else slice(moving[0], None)
    poses = link_poses(placed[i_robot], positions[:, columns])[:, link]
    world = corners @ poses.transpose(0, 2, 1)
    moved = np.linalg.norm(world - world[0], axis=2).max(axis=1)
    bound = ways(surface_of(body), np.array([frame]), links_of(placed), positions)
    assert (moved <= bound).all()


def test_parts_of_a_long_chain_that_are_off_orthonormal_stretch_the_bound():
    offset = np.diag([1.0 + 4.9e-7] * 3 + [1.0])
    offset[0, 3] = 0.5
    axis = np.array([0.0, 0.0, 1.0])
    joints = [
        Joint(f"j{i}", JointKind("fixed"), f"l{i}", f"l{i + 1}", offset, axis)
        for i in range(1, 200)
    ]
    joints.insert(0, Joint("j0", JointKind("revolute"), "l0", "l1", np.eye(4), axis))
    robot = Robot("chain", tuple(f"l{i}" for i in range(201)), tuple(joints), ())
    placed = PlacedRobot(robot, Trajectory(np.zeros(1), (), np.zeros((1, 0))))
    positions = np.array([[0.0], [0.001]])
    speck = box((1e-4, 1e-4, 1e-4))
    ends = link_poses(placed, positions)[:, 200, :, 3]
    bound = ways(surface_of(speck), np.array([200]), links_of([placed]), positions)
    assert np.linalg.norm(ends[1] - ends[0]) <= bound[1] <= 0.1 * 1.001


@pytest.mark.slow
@pytest.mark.parametrize("need", ["minimum", "limit"])
def test_a_finer_motion_takes_few_more_looks(need):
    """Sixteen times the steps: most are passed over, and the answer is that of the steps asked one by one.

    Where several bodies come within the limit each has its own looks, so that fewer steps are without any.
    """
    case = cl.load_case(SCENES / "box_pipe" / "case.yaml")
    (placed,) = case.robots
    asked = placed.trajectory
    times = np.linspace(asked.times[0], asked.times[-1], 16 * (asked.n_steps - 1) + 1)
    positions = np.column_stack(
        [np.interp(times, asked.times, column) for column in asked.positions.T]
    )
    finer = replace(
        placed, trajectory=replace(asked, times=times, positions=positions, velocities=None)
    )
    case = replace(case, robots=(finer,))
    whole, found = (
        cl.check(case, certify=False, resources=cl.Resources(jobs=1)),
        cl.check(case, need=need, certify=False, resources=cl.Resources(jobs=1)),
    )
    assert found.record.tally["steps_passed_over"] > 0.6 * len(times)
    truth, told = whole.steps["clearance"].to_numpy(), found.steps["clearance"].to_numpy()
    known = ~np.isnan(told)
    assert (told[known] == truth[known]).all()
    assert known[truth < case.limits.warn].all() if need == "limit" else known[truth.argmin()]
    assert (found.steps["lower_bound"].to_numpy() <= truth + 1e-15).all()


def swaying_arm(random: np.random.Generator) -> Case:
    """Up to four links whose joints sway each at its own pace, some that rest or jerk, among obstacles."""
    n_links, n_steps = int(random.integers(1, 5)), int(random.integers(2, 500))
    pace = random.choice([0.001, 0.01, 0.1, 1.0], (1, n_links))
    sway = np.sin(np.arange(n_steps)[:, None] * pace + random.uniform(0.0, 6.0, (1, n_links)))
    positions = random.uniform(-2.0, 2.0, (1, n_links)) + random.choice([0.1, 0.5, 2.0]) * sway
    positions += random.choice([0.0, 1e-9, 0.05]) * random.normal(size=positions.shape)
    positions[:, random.integers(n_links)] *= random.choice([0.0, 1.0])
    shapes = {
        "spindle": lambda: spindle(0.05, 0.1, 5),
        "dented": lambda: dented(random, 0, 0.4, 0.08),
        "box": lambda: box(random.uniform(0.02, 0.2, 3)),
        "cylinder": lambda: cylinder(0.04, 0.2),
        "ring": lambda: torus(0.1, 0.04, 9, 5),
    }
    some = [shapes[kind]() for kind in random.choice(list(shapes), n_links + random.integers(1, 5))]
    around = random.choice([0.35, 0.8])
    obstacles = [
        (shape, at(*around * random.normal(size=3), turned=rotations(random, 1)[0]))
        for shape in some[n_links:]
    ]
    warn = random.choice([1e-3, 0.02, 0.1, 0.4])
    return replace(
        arm("swaying", some[:n_links], obstacles, positions), limits=Limits(warn / 2.0, warn)
    )


@pytest.mark.parametrize("seed", range(16))
def test_bodies_with_clocks_of_their_own_miss_nothing(seed):
    case = swaying_arm(np.random.default_rng(seed))
    runs = {
        need: cl.check(case, need=need, certify=False, resources=cl.Resources(jobs=1))
        for need in ("steps", "limit", "minimum")
    }
    truth = runs["steps"].steps["clearance"].to_numpy()
    told = runs["limit"].steps["clearance"].to_numpy()
    known = ~np.isnan(told)
    assert (told[known] == truth[known]).all()
    assert known[truth < case.limits.warn].all()
    assert runs["limit"].steps["status"].equals(runs["steps"].steps["status"])
    assert runs["limit"].worst["step"] == runs["steps"].worst["step"]
    assert runs["minimum"].worst["clearance"] == truth.min()
    assert runs["minimum"].worst["step"] == truth.argmin()
    for need in ("limit", "minimum"):
        if "lower_bound" in runs[need].steps.column_names:  # not if every step is known
            assert (runs[need].steps["lower_bound"].to_numpy() <= truth).all()
