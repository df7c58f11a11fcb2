"""Whole runs in which an obstacle is a cloud of points, against arithmetic on every point."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadShape
from clearance.profiles.sweep import swept_profile
from clearance.world.motion import kinematic_motion
from tests.made_cases import at, flying

HALF = np.array([0.15, 0.1, 0.05])
RADIUS = 0.02


def way(n_steps: int, reach: float = 1.0) -> np.ndarray:
    """(n, 6) a box goes past the points, turning."""
    share = np.linspace(0.0, 1.0, n_steps)[:, None]
    return share * [2.0 * reach, 0.1, 0.05, 1.0, 0.7, 2.0] - [reach, 0.0, 0.0, 0.0, 0.0, 0.0]


def scan(n: int = 4000, gap: float = 0.25) -> np.ndarray:
    """(n, 3) a wavy wall beside the way, and a few points that none is near."""
    u, v = np.random.default_rng(4).uniform(-1.0, 1.0, (2, n))
    wall = np.stack([u, gap + 0.05 * np.sin(9.0 * u) * np.cos(7.0 * v), v], axis=1)
    return np.concatenate([wall, [[0.0, 0.0, 3.0], [0.0, 0.0, -3.0]]])


def case_of(points: np.ndarray, positions: np.ndarray, **more) -> cl.Case:
    case = flying("scanned", cl.box(2.0 * HALF), [], positions)
    obstacle = cl.Obstacle(cl.Body("scan", cl.PointCloud(points, RADIUS)), **more)
    return replace(case, obstacles=(*case.obstacles, obstacle))


def true_clearances(case: cl.Case, points: np.ndarray, positions: np.ndarray) -> np.ndarray:
    """(n,) [m] of the box to the balls, 0 where a ball is in it."""
    links = np.array([case.robots[0].robot.link_names.index("l6")])
    motion = case.with_trajectory(np.arange(len(positions)) * 0.01, positions)
    poses = kinematic_motion(motion.robots[0]).poses()[:, links[0]]
    found = []
    for pose in poses:
        seen = (points - pose[:3, 3]) @ pose[:3, :3]
        away = np.linalg.norm(np.maximum(np.abs(seen) - HALF, 0.0), axis=1)
        found.append(max(0.0, away.min() - RADIUS))
    return np.array(found)


@pytest.mark.parametrize("gap", [0.4, 0.2, 0.0])
def test_every_step_and_what_is_proven_between(gap):
    points, positions = scan(gap=gap), way(41)
    case = case_of(points, positions)
    run = cl.check(case)
    found = run.record.steps["clearance"].to_numpy()
    assert np.abs(found - true_clearances(case, points, positions)).max() <= 1e-12
    shares = np.linspace(0.0, 1.0, 20)[:, None]
    finer = positions[:-1, None] + shares * np.diff(positions, axis=0)[:, None]
    between = true_clearances(case, points, finer.reshape(-1, 6)).reshape(-1, 20).min(axis=1)
    proven = run.certificate.lower_bound[:-1]
    assert (proven <= between + 1e-12).all()
    assert (between - proven <= 1e-4 + 1e-3).all()  # samples are not the least
    assert (found == 0.0).any() == (gap < 0.3)


def test_a_point_deep_in_a_link_is_a_contact_at_every_need():
    """Nothing is near the surface: only the winding number sees it."""
    positions = way(9)
    case = case_of(np.array([[0.0, 0.0, 0.03], [0.0, 9.0, 0.0]]), positions)
    middle = flying("inside", cl.box(2.0 * HALF), [], np.zeros((3, 6)))
    middle = replace(middle, obstacles=case.obstacles)
    for need in ("steps", "pairs", "limit", "minimum"):
        run = cl.check(middle, need=need)
        assert (run.worst["clearance"], run.status) == (0.0, "contact")


def test_a_cloud_that_moves_by_a_clock_of_its_own():
    """Every step of one clock against every step of the other, by arithmetic."""
    points, positions = scan(300), way(15)
    times = np.linspace(0.0, 1.0, 12)
    poses = np.tile(np.eye(4), (12, 1, 1))
    poses[:, 1, 3] = np.linspace(0.0, 0.8, 12)
    moves = cl.PoseTable(times, poses[:, :3, 3], np.tile([0.0, 0.0, 0.0, 1.0], (12, 1)))
    case = replace(case_of(points, positions, moves=moves), clock=cl.Clock(float("inf")))
    least = min(
        true_clearances(case, points + [0.0, y, 0.0], positions).min() for y in poses[:, 1, 3]
    )
    record = cl.check(case).record
    assert abs(np.nanmin(record.steps["clearance"].to_numpy()) - least) <= 1e-12
    assert record.certificate.lower_bound.min() <= least + 1e-12


def test_contact_with_a_cloud_is_said_to_have_no_depth():
    case = case_of(scan(gap=0.0), way(15))
    run = cl.check(case)
    told = [notice.text for notice in run.record.notices if notice.kind == "contact"]
    assert told == [
        "contact with scan has no depth, volume or separation vector here: clouds of points"
    ]
    assert not len(run.record.contacts)
    block = cl.Obstacle(cl.Body("block", cl.box([0.2, 0.2, 0.2])))
    both = cl.check(replace(case, obstacles=(*case.obstacles, block))).record
    assert {row.obstacle for row in both.contacts} == {"block"}
    assert both.deepest.penetration > 0.05


@pytest.mark.peer
@pytest.mark.parametrize("gap", [0.4, 0.0])
def test_the_cross_check_asks_fcl_about_the_cloud_too(gap):
    block = cl.Obstacle(cl.Body("block", cl.box([0.2, 0.2, 0.2])), at(0.3, -0.25))
    case = case_of(scan(gap=gap), way(15))
    for one in (case, replace(case, obstacles=(*case.obstacles, block))):
        record = cl.check(one, cross_check=True).record
        assert record.cross_check.agrees and record.cross_check.n_steps == 15
        assert record.cross_check.greatest_difference <= record.cross_check.tolerance < 1e-8
        assert not [notice for notice in record.notices if notice.kind == "cross-check"]


@pytest.mark.peer
def test_a_cloud_that_is_too_large_for_fcl_is_left_out_and_named(monkeypatch):
    monkeypatch.setattr("clearance.crosscheck.pairs.MOST_POINTS", 4000)
    case = case_of(scan(), way(15))
    alone = cl.check(case, cross_check=True).record
    assert alone.cross_check is None
    (told,) = [notice.text for notice in alone.notices if notice.kind == "cross-check"]
    assert told.startswith("1 pairs with clouds of points are not cross-checked")
    block = cl.Obstacle(cl.Body("block", cl.box([0.2, 0.2, 0.2])), at(0.3, -0.25))
    both = cl.check(replace(case, obstacles=(*case.obstacles, block)), cross_check=True).record
    assert both.cross_check.n_steps == 15
    assert not both.cross_check.disagreements


def test_what_needs_a_surface_is_refused_by_name():
    case = case_of(scan(10), way(3))
    with pytest.raises(BadInput, match="'scan' is a cloud of points"):
        cl.Question(case, method="paper")
    with pytest.raises(BadShape, match="'scan' is a cloud of points, which has no outline"):
        swept_profile(case, "xy", obstacles=["scan"])
    robot = case.robots[0].robot
    cloud = replace(robot, bodies=(cl.Body("l6", cl.PointCloud([[0, 0, 0]], 0.1)),))
    with pytest.raises(BadShape, match="link 'l6' of robot 'flying' is a cloud of points"):
        replace(case, robots=(replace(case.robots[0], robot=cloud),))
