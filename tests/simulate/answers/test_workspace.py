"""The region that robots share: closed forms for sliders, containment for arms, refusals."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension, BadInput
from clearance.geometry import boolean
from clearance.simulate.answers.workspace.swept_pieces import swept_pieces
from clearance.simulate.answers.workspace.workspace import shared_workspace
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.cubic import positions_along
from clearance.world.motion import kinematic_motion
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.timeline import timeline_of
from clearance.world.trajectory import Trajectory
from tests.report.records import arm, moved

WITH_MANIFOLD = pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")


def slider(name, axis, start, stop, base=(0.0, 0.0, 0.0), n_steps=5) -> Case:
    """A 0.2 cube that slides along an axis of the world."""
    joint = Joint(
        "rail", JointKind.PRISMATIC, "ground", "cube", np.eye(4), np.array(axis, dtype=float)
    )
    robot = Robot(name, ("ground", "cube"), (joint,), (Body("cube", cl.box((0.2, 0.2, 0.2))),))
    times = np.arange(float(n_steps))
    path = Trajectory(times, ("rail",), np.linspace(start, stop, n_steps)[:, None])
    return Case(name, (PlacedRobot(robot, path, moved(*base)),), ())


def swinging(name, base, n_steps=12, excluded=()) -> Case:
    """The arm of the report's tests, all joints moving."""
    share = np.linspace(0.0, 1.0, n_steps)
    positions = np.column_stack([2.0 * share - 1.0, 0.9 * np.sin(3 * share), 0.2 * share])
    path = Trajectory(share, ("pan", "lift", "slide"), positions)
    return Case(name, (PlacedRobot(arm(name), path, base, exclude_links=excluded),), ())


@WITH_MANIFOLD
def test_two_sliders_that_cross_share_a_cube():
    one = slider("one", (1, 0, 0), -1.0, 1.0)
    two = slider("two", (0, 1, 0), -1.0, 1.0, base=(0.3, 0.0, 0.05))
    found = shared_workspace([one, two])
    assert found.volume == pytest.approx(0.2 * 0.2 * 0.15, rel=1e-6)
    assert found.volume >= 0.2 * 0.2 * 0.15
    assert found.region.centroid == pytest.approx([0.3, 0.0, 0.025], abs=1e-8)
    assert found.leaves == 0.0  # sliding is straight
    (pair,) = found.links
    assert (pair.robot_a, pair.link_a, pair.robot_b, pair.link_b) == ("one", "cube", "two", "cube")


@WITH_MANIFOLD
def test_of_three_robots_what_two_reach_counts_once():
    cases = [slider("x", (1, 0, 0), -1, 1), slider("y", (0, 1, 0), -1, 1, (0.0, 0.0, 0.001))]
    cases.append(slider("z", (0, 0, 1), -1, 1, (0.0, 0.001, 0.0)))
    found = shared_workspace(cases)
    assert found.volume == pytest.approx(0.2**3, rel=0.05)
    assert len(found.links) == 3


@WITH_MANIFOLD
def test_timing_does_not_matter_and_apart_is_empty():
    one = slider("one", (1, 0, 0), -1.0, 1.0)
    there = slider("two", (0, 1, 0), -1.0, 1.0, base=(0.3, 0.0, 0.05))
    back = slider("two", (0, 1, 0), 1.0, -1.0, base=(0.3, 0.0, 0.05))
    assert shared_workspace([one, there]).volume == pytest.approx(
        shared_workspace([one, back]).volume, rel=1e-12
    )
    far = shared_workspace([one, slider("two", (0, 1, 0), -1.0, 1.0, base=(3.0, 0.0, 0.0))])
    assert far.volume == 0.0 and far.region.is_empty and far.links == ()


def pieces_of(motion, within):
    """The pieces of a robot that is alone."""
    return swept_pieces(timeline_of(Case("alone", (motion.placed,), ()), (motion,)), 0, within)


def between_the_steps(motion, n_parts):
    """(instants in steps, the motion at these): each interval in `n_parts`."""
    n = motion.n_steps
    fine = np.linspace(0.0, n - 1.0, n_parts * (n - 1) + 1)
    times = np.interp(fine, np.arange(n), motion.times)
    asked = Trajectory(motion.times, motion.joint_names, motion.positions, motion.velocities)
    return fine, dataclasses.replace(
        motion, times=times, positions=positions_along(asked, times), velocities=None,
        tracking_error=np.zeros(len(fine)),
    )  # fmt: skip


def greatest_escape(pieces, motion, n_parts):
    """[m] how far a corner of a link ever stands out of the pieces that hold it; below 0 if inside."""
    fine, dense = between_the_steps(motion, n_parts)
    robot, poses = motion.placed.robot, dense.poses()
    worst = -np.inf
    for body in robot.bodies:
        posed = poses[:, robot.link_names.index(body.name)]
        corners = np.einsum("nij,kj->nki", posed[:, :3, :3], body.shape.vertices)
        corners += posed[:, None, :3, 3]
        held = np.full(len(fine), np.inf)
        for piece in (p for p in pieces if p.link == body.name):
            within = (fine >= piece.first) & (fine <= piece.last)
            rows = corners[within] @ piece.body.normals.T + piece.body.half_spaces[:, 3]
            held[within] = np.minimum(held[within], rows.max(axis=(1, 2)))
        worst = max(worst, held.max())
    return worst


@pytest.mark.parametrize("within", [1e-4, 5e-3, 0.2])
def test_the_pieces_hold_the_links_between_the_samples(within):
    motion = kinematic_motion(swinging("arm", moved(0.3, -0.2, 0.1), n_steps=6).robots[0])
    assert greatest_escape(pieces_of(motion, within), motion, 20) <= 0.0


@pytest.mark.parametrize("seed", range(2))
def test_the_pieces_hold_motion_on_cubics_sampled_100_times_finer(seed):
    """Velocities that have nothing to do with the positions: joints swing far beyond their samples."""
    motion = kinematic_motion(swinging("arm", moved(0.3, -0.2, 0.1), n_steps=6).robots[0])
    random = np.random.default_rng(seed)
    wild = random.normal(size=motion.positions.shape) * random.uniform(5.0, 20.0)
    on_cubics = dataclasses.replace(motion, velocities=wild)
    assert greatest_escape(pieces_of(on_cubics, 0.01), on_cubics, 100) <= 0.0
    assert greatest_escape(pieces_of(motion, 0.01), on_cubics, 100) > 0.0


def test_a_slider_on_a_cubic_swings_beyond_its_samples():
    """Both ends at 0 with velocities 8 and -8: half way it stands at 2, its chord at 0; leaves = 16 / 8."""
    case = slider("one", (1, 0, 0), 0.0, 0.0, n_steps=2)
    motion = kinematic_motion(case.robots[0])
    motion = dataclasses.replace(motion, velocities=np.array([[8.0], [-8.0]]))
    (piece,) = pieces_of(motion, 0.01)
    assert piece.leaves == pytest.approx(2.0, rel=1e-12)
    assert greatest_escape([piece], motion, 100) <= 0.0


@pytest.mark.slow
@WITH_MANIFOLD
def test_the_region_of_two_arms_is_what_pairs_of_pieces_share():
    one, two = swinging("left", moved(0.0)), swinging("right", moved(0.2, 1.0))
    found = shared_workspace([one, two], within=0.05)
    swept = [pieces_of(kinematic_motion(c.robots[0]), 0.05) for c in (one, two)]
    pieces = [cl.intersect([p.body, q.body]) for p in swept[0] for q in swept[1]]
    parts = [shared for shared in pieces if shared.volume > 0.0]
    assert found.volume <= sum(part.volume for part in parts) * (1 + 1e-9)
    assert found.volume >= max(part.volume for part in parts) * (1 - 1e-9)
    points = np.concatenate([part.centroid[None] for part in parts])
    low, high = found.region.vertices.min(axis=0), found.region.vertices.max(axis=0)
    assert (points >= low).all() and (points <= high).all()


@WITH_MANIFOLD
@pytest.mark.cold
def test_concave_links_can_be_taken_by_their_parts():
    """An L that slides over a cube's way: its hull meets the cube, its parts do not."""
    rim = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 3), (0, 3)]
    points = 0.1 * np.array([(x, y, z) for z in (0.0, 1.0) for x, y in rim])
    caps = [[6, 7, 8, 9], [6, 9, 10, 11], [3, 2, 1, 0], [5, 4, 3, 0]]
    shape = cl.Polyhedron(
        points, caps + [[i, (i + 1) % 6, (i + 1) % 6 + 6, i + 6] for i in range(6)]
    )
    one = slider("one", (0, 0, 1), -1.0, 1.0)
    robot = dataclasses.replace(one.robots[0].robot, bodies=(Body("cube", shape),))
    one = dataclasses.replace(one, robots=(dataclasses.replace(one.robots[0], robot=robot),))
    two = slider("two", (0, 0, 1), -1.0, 1.0, base=(0.235, 0.235, 0.0))
    assert shared_workspace([one, two]).volume > 1e-6
    assert shared_workspace([one, two], cut_concave=True).region.is_empty


@WITH_MANIFOLD
def test_refusals():
    one = slider("one", (1, 0, 0), -1.0, 1.0)
    with pytest.raises(BadInput, match="1 robot is given; cases with two or more"):
        shared_workspace([one])
    with pytest.raises(BadInput, match=r"same spot; give each its own robot\.base"):
        shared_workspace([one, slider("two", (0, 1, 0), -1.0, 1.0)])
    table = Body("table", cl.box((1.0, 1.0, 0.1)))
    here = dataclasses.replace(one, obstacles=(Obstacle(table, moved(0.0, 2.0)),))
    there = slider("two", (0, 1, 0), -1.0, 1.0, base=(0.3, 0.0, 0.0))
    there = dataclasses.replace(there, obstacles=(Obstacle(table, moved(1.0, 2.0)),))
    with pytest.raises(BadInput, match="'table' stands elsewhere in 'two' than in 'one'"):
        shared_workspace([here, there])
    with pytest.raises(BadDimension, match="within is nan m"):
        shared_workspace([one, there], within=float("nan"))
