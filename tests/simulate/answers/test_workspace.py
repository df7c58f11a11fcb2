"""The region that robots share: closed forms for sliders, containment for arms, refusals."""

from __future__ import annotations

import dataclasses
import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadDimension, BadInput
from clearance.geometry import boolean
from clearance.report.workspace import workspace_summary
from clearance.report.workspace_picture import picture_of
from clearance.simulate.answers.workspace.swept_pieces import swept_pieces
from clearance.simulate.answers.workspace.workspace import shared_workspace
from clearance.world.body import Body, Mount, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.cubic import positions_along
from clearance.world.motion import kinematic_motion
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import JointKind
from clearance.world.timeline import timeline_of
from clearance.world.timing import Window
from clearance.world.trajectory import CornerZone, Deviation, Trajectory
from tests import cells
from tests.examples import examples
from tests.made_cases import at, driven, l_prism
from tests.report.records import arm
from tests.world.test_shortfall import off

WITH_MANIFOLD = pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")


def slider(name, axis, start, stop, base=(0.0, 0.0, 0.0), n_steps=5) -> Case:
    """A 0.2 cube that slides along an axis of the world."""
    way, cube = np.linspace(start, stop, n_steps), cl.box((0.2, 0.2, 0.2))
    kind = JointKind.PRISMATIC
    return Case(
        name, (driven(cube, kind, way, axis=axis, base=at(*base), name=name, link="cube"),), ()
    )


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
def test_a_body_that_may_stand_outside_its_facets_is_refused():
    one, two = slider("one", (1, 0, 0), -1.0, 1.0), slider("two", (0, 1, 0), -1.0, 1.0)
    cad = Obstacle(Body("cad", off(cl.box((0.1, 0.1, 0.1)), 0.001)))
    cases = [replace(case, obstacles=(cad,)) for case in (one, two)]
    with pytest.raises(BadInput, match="'cad' may stand 1 mm outside its facets, which a shared w"):
        shared_workspace(cases)


@WITH_MANIFOLD
def test_of_three_robots_what_two_reach_counts_once():
    cases = [slider("x", (1, 0, 0), -1, 1), slider("y", (0, 1, 0), -1, 1, (0.0, 0.0, 0.001))]
    cases.append(slider("z", (0, 0, 1), -1, 1, (0.0, 0.001, 0.0)))
    found = shared_workspace(cases)
    assert found.volume == pytest.approx(0.2**3, rel=0.05)
    assert len(found.links) == 3


@WITH_MANIFOLD
def test_what_may_be_passed_in_a_corner_zone_is_shared():
    """The two are 10 mm apart, and the first may be 15 mm off on part of its way."""
    one, other = (
        slider("one", (1, 0, 0), -1.0, 1.0),
        slider("two", (0, 1, 0), -1.0, -0.9, (0.3, 0.69, 0.0)),
    )
    assert shared_workspace([one, other]).volume == 0.0
    (placed,) = one.robots
    times = placed.trajectory.times
    zone = CornerZone(
        "LIN 1", times[0], times[-1], 0.05, {placed.robot.bodies[0].name: Deviation(0.015, 0.0)}
    )
    cornering = replace(placed, trajectory=replace(placed.trajectory, corners=(zone,)))
    found = shared_workspace([replace(one, robots=(cornering,)), other])
    assert found.volume > 0.0 and not found.region.is_empty


def pieces_of(motion, within):
    """The pieces of a robot that is alone."""
    case = Case("alone", (motion.placed,), ())
    return swept_pieces(case, timeline_of(case, (motion,)), 0, within)


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
            within = (dense.times >= piece.start) & (dense.times <= piece.end)
            rows = corners[within] @ piece.body.normals.T + piece.body.half_spaces[:, 3]
            held[within] = np.minimum(held[within], rows.max(axis=(1, 2)))
        worst = max(worst, held.max())
    return worst


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_the_pieces_hold_motion_on_cubics_sampled_100_times_finer(seed):
    """Velocities that have nothing to do with the positions: joints swing far beyond their samples."""
    motion = kinematic_motion(swinging("arm", at(0.3, -0.2, 0.1), n_steps=6).robots[0])
    random = np.random.default_rng(seed)
    wild = random.normal(size=motion.positions.shape) * random.uniform(5.0, 20.0)
    on_cubics = dataclasses.replace(motion, velocities=wild)
    assert greatest_escape(pieces_of(on_cubics, 0.01), on_cubics, 100) <= 0.0
    assert greatest_escape(pieces_of(motion, 0.01), on_cubics, 100) > 0.0


def test_a_slider_on_a_cubic_swings_beyond_its_samples():
    """Both ends at 0 with velocities 8 and -8: half way it stands at 2; 16 / 8 / 15^2 is below 0.01."""
    case = slider("one", (1, 0, 0), 0.0, 0.0, n_steps=2)
    motion = kinematic_motion(case.robots[0])
    motion = dataclasses.replace(motion, velocities=np.array([[8.0], [-8.0]]))
    pieces = pieces_of(motion, 0.01)
    assert len(pieces) == 15
    assert max(p.leaves for p in pieces) == pytest.approx(2.0 / 15**2, rel=1e-9)
    assert greatest_escape(pieces, motion, 100) <= 0.0
    assert max(p.points[:, 0].max() for p in pieces) < 2.1


@WITH_MANIFOLD
@pytest.mark.cold
def test_concave_links_can_be_taken_by_their_parts():
    """An L that slides over a cube's way: its hull meets the cube, its parts do not."""
    shape = l_prism().scaled(0.1)
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
    here = dataclasses.replace(one, obstacles=(Obstacle(table, at(0.0, 2.0)),))
    there = slider("two", (0, 1, 0), -1.0, 1.0, base=(0.3, 0.0, 0.0))
    there = dataclasses.replace(there, obstacles=(Obstacle(table, at(1.0, 2.0)),))
    with pytest.raises(BadInput, match="'table' stands elsewhere in 'two' than in 'one'"):
        shared_workspace([here, there])
    with pytest.raises(BadDimension, match="within is nan m"):
        shared_workspace([one, there], within=float("nan"))


def timeline(case):
    return timeline_of(case, [kinematic_motion(placed) for placed in case.robots])


def on_the_door(case):
    """The case with its first robot on the obstacle that moves by itself."""
    left, *others = case.robots
    there = Mount("door", left.world_from_base)
    return replace(case, robots=(replace(left, world_from_base=np.eye(4), mount=there), *others))


def escape(pieces, corners, pose):
    """[m] how far a corner of a body stands out of the pieces that hold it; below 0 if inside."""
    world = corners @ pose[:3, :3].T + pose[:3, 3]
    return min((world @ p.body.normals.T + p.body.half_spaces[:, 3]).max() for p in pieces)


@pytest.mark.slow
@examples(3)
@given(st.integers(0, 2**32 - 1), st.sampled_from([0.01, 0.05, 1.0]))
def test_pieces_hold_links_on_links_and_parts_in_hand_between_the_steps(seed, within):
    """A part belongs to the robot that has it in hand, then and only then."""
    case = on_the_door(cells.cell(seed))
    run = timeline(case)
    for i, placed in enumerate(case.robots):
        pieces = swept_pieces(case, run, i, within)
        bodies = {
            body.name: (f"{placed.robot.name}/{body.name}", body.shape)
            for body in placed.robot.bodies
        }
        bodies |= {one.name: (one.name, one.body.shape) for one in case.obstacles}
        windows = [c.window for c in case.carries if c.by == f"{placed.robot.name}/tool"]
        for name, (called, shape) in bodies.items():
            own = [p for p in pieces if p.link == name]
            if name in ("part", "lid"):
                assert all(any(w.holds(p.start, p.end) for w in windows) for p in own)
                held = sum(p.end - p.start for p in own)
                assert held == pytest.approx(sum(w.end - w.start for w in windows))
            for start, end in [*itertools.pairwise(run.times)][seed % 3 :: 3]:
                of_step = [p for p in own if p.start < end and start < p.end]
                for t in np.linspace(start, end, 6)[1:-1] if of_step else ():
                    there = [p for p in of_step if p.start <= t <= p.end]
                    assert escape(there, shape.vertices, cells.pose_at(case, called, t)) <= 0.0


def together(*cases, obstacles=(), carries=(), mounts=None):
    """The robots of some cases in one."""
    robots = [case.robots[0] for case in cases]
    for i, mount in (mounts or {}).items():
        robots[i] = replace(robots[i], world_from_base=np.eye(4), mount=mount)
    return Case("cell", tuple(robots), tuple(obstacles), carries=tuple(carries))


@WITH_MANIFOLD
def test_a_base_that_moves_takes_its_robot_to_what_it_alone_would_not_reach():
    """A cube that slides along y stands on a rail along x, which takes it through a third robot's way."""
    rail = slider("rail", (1, 0, 0), 0.0, 2.0)
    rider = slider("rider", (0, 1, 0), 0.0, 0.5)
    other = slider("other", (0, 0, 1), -1.0, 1.0, base=(2.0, 0.5, 0.0))
    mount = {1: Mount("rail/cube", at(0.0, 0.0, 0.5))}
    found = shared_workspace([together(rail, rider, other, mounts=mount)])
    (pair,) = found.links
    assert (pair.robot_a, pair.robot_b) == ("rider", "other")
    assert 0.2**3 <= found.volume <= 1.2 * 0.2**3
    assert found.carried == (("rider", "rail"),)
    assert workspace_summary(found)["not_counted"] == [["rider", "rail"]]
    assert picture_of(found).startswith("<svg")


CORNERS = np.array([[x, y, z] for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05)])


@WITH_MANIFOLD
@pytest.mark.parametrize("shape", [cl.box((0.2, 0.2, 0.2)), cl.PointCloud(CORNERS, 0.05)])
def test_a_part_in_hand_reaches_where_the_hand_does_not(shape):
    """A scan counts as the box about its balls."""
    one = slider("one", (1, 0, 0), 0.0, 1.0)
    two = slider("two", (0, 0, 1), -1.0, 1.0, base=(1.0, 0.5, 0.0))
    part = Obstacle(Body("part", shape), at(0.0, 0.5, 0.0))
    cell = together(one, two, obstacles=[part])
    assert shared_workspace([cell]).region.is_empty
    found = shared_workspace([replace(cell, carries=(Carry("part", "one/cube", Window(0.0)),))])
    (pair,) = found.links
    assert (pair.link_a, pair.link_b) == ("part", "cube")
    assert found.volume == pytest.approx(0.2**3, rel=1e-6)
    let_go = (Carry("part", "one/cube", Window(0.0, 2.0)),)
    assert shared_workspace([replace(cell, carries=let_go)]).region.is_empty


@WITH_MANIFOLD
def test_two_robots_on_each_other_alone_are_refused():
    rail, rider = slider("rail", (1, 0, 0), 0.0, 2.0), slider("rider", (0, 1, 0), 0.0, 0.5)
    cell = together(rail, rider, mounts={1: Mount("rail/cube", at(0.0, 0.0, 0.5))})
    with pytest.raises(BadInput, match="two robots of which neither stands on the other"):
        shared_workspace([cell])


@WITH_MANIFOLD
def test_what_is_mounted_on_a_link_belongs_to_its_robot():
    """A bar on the second cube reaches 0.1 m into the way of the first; both slide by 1 m along x."""
    one = slider("one", (1, 0, 0), -0.5, 0.5)
    two = slider("two", (1, 0, 0), -0.5, 0.5, base=(0.0, 1.0, 0.0))
    bar = cl.Body("bar", cl.box((0.1, 0.8, 0.1)))
    mounted = cl.Obstacle(bar, mount=Mount("two/cube", at(0.0, -0.6, 0.0)))
    found = shared_workspace([together(one, two, obstacles=[mounted])])
    (pair,) = found.links
    assert (pair.link_a, pair.link_b) == ("cube", "bar")
    assert found.volume == pytest.approx(1.1 * 0.1 * 0.1, rel=1e-6)
