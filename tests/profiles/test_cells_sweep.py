"""Sweeps of cells in which everything moves: against where their bodies are by formulas of their own."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import UnknownLink, UnknownObstacle
from clearance.findings.limit_lines import profile_text
from clearance.profiles.answer import answer_profiles
from clearance.profiles.chords import knots_of
from clearance.profiles.plane import Plane
from clearance.profiles.swept_bodies import over_time, swept_bodies
from clearance.world.body import Body, Obstacle
from clearance.world.carry import Carry
from clearance.world.case import ReservedSpace
from clearance.world.motion import kinematic_motion
from clearance.world.pose_table import PoseTable
from clearance.world.rules import matches
from clearance.world.timeline import timeline_of
from clearance.world.timing import Timing, Window
from tests import cells
from tests.examples import examples
from tests.oracle.outlines import inside
from tests.profiles.finely import assert_within_chord_and_turn
from tests.profiles.moving import drawn, rows

shapely = pytest.importorskip("shapely")

PLANE = Plane.of("xz")


def body_of(case, name):
    """The shape of a body by its name in tables."""
    for obstacle in case.obstacles:
        if obstacle.name == name:
            return obstacle.body.shape
    robot, link = name.split("/")
    placed = next(one for one in case.robots if one.robot.name == robot)
    return next(body.shape for body in placed.robot.bodies if body.name == link)


def seen(case, name, times):
    """(k, v, 2) [m] the corners of a body in the plane at some times."""
    poses = np.array([cells.pose_at(case, name, t) for t in times])
    corners = body_of(case, name).vertices
    world = corners @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
    return PLANE.coordinates(world)


def end_of(case):
    """[s] when the run ends."""
    return float(over_time(case).timeline.times[-1])


def held(case):
    """The windows in which a robot holds the part; the lid stands on the part."""
    return [c.window for c in case.carries if "/" in c.by]


def assert_contains(profile, points, rng):
    """Nothing of (n, 2) points is outside; some of them by rational arithmetic."""
    points = points.reshape(-1, 2)
    region = profile.region
    shapely.prepare(region)
    assert shapely.distance(region, shapely.points(points)).max() <= 1e-6
    chosen = rows(profile)
    assert all(inside(point, chosen) for point in points[rng.integers(len(points), size=3)])


LINKS = [f"{robot}/{link}" for robot in ("left", "right", "track") for link in ("boom", "tool")]


@pytest.mark.peer
@examples(3)
@example(26141)
@given(st.integers(0, 2**32 - 1))
def test_links_on_links_and_parts_in_hand_are_within_the_outline(seed):
    case, rng = cells.cell(seed), np.random.default_rng(seed)
    found = cl.swept_profile(case, "xz", tolerance=1e-2)
    assert found.bound <= 1e-2
    times = np.linspace(0.0, end_of(case) - 1e-9, 120)  # the formulas begin a loop again as it ends
    for name in LINKS:
        assert_contains(found, seen(case, name, times), rng)
    for window in held(case):
        times = np.linspace(window.start, window.end, 40)[1:-1]
        for name in ("part", "lid"):
            assert_contains(found, seen(case, name, times), rng)


@pytest.mark.slow
@examples(10)
@given(st.integers(0, 2**32 - 1), st.sampled_from([*LINKS, "door", "crate", "part", "lid"]))
@example(0, "crate")
def test_a_chain_is_where_its_body_is_and_points_stay_within_the_chord_bound(seed, name):
    case = cells.cell(seed)
    names = ["right/*"] if name in ("part", "lid") else [name] if name in LINKS else []
    obstacles = [name] if name in ("door", "crate") else []
    for one in swept_bodies(over_time(case), names, obstacles):
        if one.label != name or one.chain is None:
            continue
        knots = knots_of(one.chain, one.body.shape, PLANE, 0.5, solid=False)
        assert_within_chord_and_turn(
            knots, one.body.shape, PLANE, lambda at, one=one: one.chain.poses_at(at)[:, -1], 1e-13
        )
        instants = np.linspace(0.0, one.chain.n_steps - 1, 37)[1:-1]
        times = np.interp(instants, np.arange(one.chain.n_steps), one.chain.motions[0].times)
        for t, pose in zip(times, one.chain.poses_at(instants)[:, -1], strict=True):
            assert pose == pytest.approx(cells.pose_at(case, name, t), abs=1e-9)


def carrying(**changes):
    """A slider along x with a cube of 0.2 that picks a part up at half way, 1 m to its side."""
    from tests.simulate.answers.test_workspace import slider

    made = slider("made", (1, 0, 0), 0.0, 1.0, n_steps=3)
    at = np.eye(4)
    at[1, 3] = 1.0
    part = Obstacle(Body("part", cl.box((0.2, 0.2, 0.2))), at)
    return replace(
        made, obstacles=(part,), carries=(Carry("part", "cube", Window(1.0, **changes)),)
    )


@pytest.mark.peer
def test_a_part_is_swept_only_while_it_is_carried():
    found = cl.swept_profile(carrying(end=1.5))
    boxes = [shapely.box(-0.1, -0.1, 1.1, 0.1), shapely.box(-0.1, 0.9, 0.35, 1.1)]
    truth = shapely.union_all(boxes)
    assert found.region.buffer(1e-9).covers(truth)
    assert truth.buffer(found.bound + 1e-9).covers(found.region)
    whole = cl.swept_profile(carrying(end=1.5), links=[], obstacles=["part"])
    assert whole.area == pytest.approx(0.2 * 0.45, abs=1e-3)


def test_a_part_that_goes_from_a_hand_to_a_truck_is_not_swept_on_the_truck():
    case, turned = carrying(end=1.5), np.array([[0, 0, 0, 1.0]] * 2)
    table = PoseTable(np.array([0.0, 2.0]), np.array([[0, 3.0, 0], [1.0, 3.0, 0]]), turned)
    truck = Obstacle(Body("truck", cl.box((0.2, 0.2, 0.2))), moves=table)
    carries = (*case.carries, Carry("part", "truck", Window(1.5)))
    case = replace(case, obstacles=(*case.obstacles, truck), carries=carries)

    def left_out(obstacles):
        return cl.swept_profile(case, obstacles=obstacles).notes

    assert left_out([]) == ("not swept, though moving by themselves: part, truck",)
    assert left_out(["part"]) == ("not swept, though moving by themselves: truck",)
    assert left_out(["part", "truck"]) == ()


@pytest.mark.parametrize(("top", "kept"), [(1.15, True), (1.05, False)])
def test_a_reserved_outline_is_held_against_what_is_in_hand_too(top, kept):
    """The part reaches y = 1.1 while it is carried."""
    corners = [(-0.3, -0.3), (1.5, -0.3), (1.5, top), (-0.3, top)]
    space = ReservedSpace("zone", drawn(corners), "xy", mode="outside")
    wall = Obstacle(
        Body("wall", cl.box((0.1, 0.1, 0.1))), cells.pose(np.random.default_rng(1), 9.0)
    )
    case = carrying(end=1.5)
    case = replace(case, obstacles=(*case.obstacles, wall), profiles=(space,))
    (answer,) = cl.check(case).record.profiles
    assert answer.passed == answer.contained == kept
    assert f": {'kept' if kept else 'NOT KEPT'}, gap " in profile_text(answer)
    assert (answer.link, answer.step) in {("part", 1), ("part", 2)}
    assert answer.gap == pytest.approx(top - 1.1, abs=1e-3)
    line = timeline_of(case, [kinematic_motion(placed) for placed in case.robots])
    off = [replace(phase, case=replace(phase.case, path_error=1e-3)) for phase in line.phases]
    (lessened,) = answer_profiles(case, replace(line, phases=tuple(off)))
    if kept:
        assert lessened.answer.gap == pytest.approx(answer.gap - 1e-3, abs=1e-12)


def test_patterns_of_links_and_what_they_carry():
    case = cells.cell(3)
    over = over_time(case)

    def labels(links, obstacles=()):
        return {one.label for one in swept_bodies(over, links, obstacles)}

    assert labels(["left/*"]) == {"left/boom", "left/tool", "part", "lid"}
    assert labels(["left/boom"]) == {"left/boom"}
    assert labels(["*/boom"]) == labels(["boom"]) == {n for n in LINKS if matches(n, "*/boom")}
    assert labels([], ["d*"]) == {"door"}
    with pytest.raises(
        UnknownLink, match="links: unknown link 'left/bom'; did you mean 'left/boom'"
    ):
        labels(["left/bom"])
    with pytest.raises(
        UnknownObstacle, match="obstacles: unknown obstacle 'dor'; did you mean 'door'"
    ):
        labels([], ["dor"])


def test_what_is_absent_sweeps_nothing():
    case = carrying()
    times, turned = np.array([0.0, 1.0]), np.array([[0, 0, 0, 1.0]] * 2)
    table = PoseTable(times, np.array([[0, 3.0, 0], [1.0, 3, 0]]), turned, Timing(after="absent"))
    door = Obstacle(Body("door", cl.box((0.2, 0.2, 0.2))), moves=table)
    found = cl.swept_profile(
        replace(case, obstacles=(*case.obstacles, door)), links=[], obstacles=["door"]
    )
    assert found.area == pytest.approx(0.2 * 1.2, abs=1e-3)
    assert {found.maker(i)[1] for i in range(found.n_pieces)} == {0}
