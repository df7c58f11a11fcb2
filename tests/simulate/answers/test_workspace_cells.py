"""What robots share where everything moves: against positions by formulas of their own, and closed forms."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadInput
from clearance.geometry import boolean
from clearance.report.workspace import workspace_summary
from clearance.report.workspace_picture import picture_of
from clearance.simulate.answers.workspace.swept_pieces import swept_pieces
from clearance.simulate.answers.workspace.workspace import shared_workspace
from clearance.world.body import Body, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import Case
from clearance.world.motion import kinematic_motion
from clearance.world.mount import Mount
from clearance.world.timeline import timeline_of
from clearance.world.timing import Window
from tests import cells
from tests.examples import examples
from tests.report.records import moved
from tests.simulate.answers.test_workspace import slider

WITH_MANIFOLD = pytest.mark.skipif(not boolean.available(), reason="manifold3d is not installed")


def timeline(case):
    return timeline_of(case, [kinematic_motion(placed) for placed in case.robots])


def on_the_door(case):
    """The case with its first robot on the obstacle that moves by itself."""
    left, *others = case.robots
    there = Mount("door", left.world_from_base)
    return replace(case, robots=(replace(left, world_from_base=np.eye(4), mount=there), *others))


def escape(pieces, name, corners, pose, step):
    """[m] how far a corner of a body stands out of the pieces that hold it after a step; below 0 if inside."""
    world = corners @ pose[:3, :3].T + pose[:3, 3]
    own = [p for p in pieces if p.link == name and p.first <= step < p.last]
    return min(
        (world @ p.body.normals.T + p.body.half_spaces[:, 3]).max() for p in own
    )  # fmt: skip


@pytest.mark.slow
@examples(3)
@given(st.integers(0, 2**32 - 1), st.sampled_from([1e-3, 0.05, 1.0]))
def test_pieces_hold_links_on_links_and_parts_in_hand_between_the_steps(seed, within):
    case = on_the_door(cells.cell(seed))
    run = timeline(case)
    for i, placed in enumerate(case.robots):
        pieces = swept_pieces(run, i, within)
        names = {body.name: f"{placed.robot.name}/{body.name}" for body in placed.robot.bodies}
        shapes = {body.name: body.shape for body in placed.robot.bodies}
        for obstacle in case.obstacles:
            names[obstacle.name], shapes[obstacle.name] = obstacle.name, obstacle.body.shape
        for name in {piece.link for piece in pieces}:
            for step in range(len(run.times) - 1):
                if not any(p.link == name and p.first <= step < p.last for p in pieces):
                    assert name in ("part", "lid")
                    continue
                for t in np.linspace(*run.times[step : step + 2], 9)[1:-1]:
                    pose = cells.pose_at(case, names[name], t)
                    assert escape(pieces, name, shapes[name].vertices, pose, step) <= 0.0


@pytest.mark.slow
@examples(3)
@given(st.integers(0, 2**32 - 1))
def test_what_is_in_hand_belongs_to_the_robot_that_holds_it(seed):
    case = cells.cell(seed)
    run = timeline(case)
    for i, placed in enumerate(case.robots):
        windows = [c.window for c in case.carries if c.by == f"{placed.robot.name}/tool"]
        for name in ("part", "lid"):
            own = [p for p in swept_pieces(run, i, 0.05) if p.link == name]
            spans = [(run.times[p.first], run.times[p.last]) for p in own]
            assert all(any(w.holds(*span) for w in windows) for span in spans)
            held = sum(end - start for start, end in spans)
            assert held == pytest.approx(sum(w.end - w.start for w in windows))


def together(*cases, obstacles=(), carries=(), mounts=None):
    """The robots of some cases in one."""
    robots = [case.robots[0] for case in cases]
    for i, mount in (mounts or {}).items():
        robots[i] = replace(robots[i], world_from_base=np.eye(4), mount=mount)
    return Case("cell", tuple(robots), tuple(obstacles), carries=tuple(carries))


@WITH_MANIFOLD
def test_robots_of_one_case_share_what_they_share_in_cases_of_their_own():
    one = slider("one", (1, 0, 0), -1.0, 1.0)
    two = slider("two", (0, 1, 0), -1.0, 1.0, base=(0.3, 0.0, 0.05))
    apart, found = shared_workspace([one, two]), shared_workspace([together(one, two)])
    assert (found.region.vertices == apart.region.vertices).all()
    assert found.names == ("one", "two") and found.links == apart.links


@WITH_MANIFOLD
def test_a_robot_on_a_mount_that_stands_shares_what_it_would_standing_there():
    one = slider("one", (1, 0, 0), -1.0, 1.0)
    two = slider("two", (0, 1, 0), -1.0, 1.0, base=(0.3, 0.0, 0.05))
    plate = Obstacle(Body("plate", cl.box((0.1, 0.1, 0.1))), moved(0.3, 0.0, 0.0))
    mount = {1: Mount("plate", moved(0.0, 0.0, 0.05))}
    found = shared_workspace([together(one, two, obstacles=[plate], mounts=mount)])
    assert found.volume == pytest.approx(shared_workspace([one, two]).volume, rel=1e-12)


@WITH_MANIFOLD
def test_a_base_that_moves_takes_its_robot_to_what_it_alone_would_not_reach():
    """A cube that slides along y stands on a rail along x, which takes it through a third robot's way."""
    rail = slider("rail", (1, 0, 0), 0.0, 2.0)
    rider = slider("rider", (0, 1, 0), 0.0, 0.5)
    other = slider("other", (0, 0, 1), -1.0, 1.0, base=(2.0, 0.5, 0.0))
    mount = {1: Mount("rail/cube", moved(0.0, 0.0, 0.5))}
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
    part = Obstacle(Body("part", shape), moved(0.0, 0.5, 0.0))
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
    cell = together(rail, rider, mounts={1: Mount("rail/cube", moved(0.0, 0.0, 0.5))})
    with pytest.raises(BadInput, match="two robots of which neither stands on the other"):
        shared_workspace([cell])
