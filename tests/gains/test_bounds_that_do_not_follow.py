"""Where a bound, or a refusal, would not follow from what moves; how far and how fast joints move a point.

Parts change hands, robots are absent, joints are beyond their limits.
"""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.gains.delay import greatest_speed
from clearance.gains.joint_ranges import ACCELERATION, SPEED, joint_ranges
from clearance.gains.lower_bounds import motion_radii
from clearance.world.carry import Carry
from clearance.world.forest import forest_of, positions_along
from clearance.world.motion import kinematic_motion
from clearance.world.pairs import BodyIndex
from clearance.world.placed_robot import MotionLimit
from clearance.world.pose_table import PoseTable
from clearance.world.robot import Joint, JointKind
from clearance.world.timing import AS_GIVEN, Timing, Window
from tests.examples import first_fast
from tests.gains.gantries import X, along_x, gantry, standing
from tests.simulate.measure.wandering import case_of

Z = np.eye(3)[2]
TIMES = np.linspace(0.0, 2.0, 41)


def turntable(*joints):
    """A small block on a joint that turns about z, and on what else is given."""
    turn = Joint("turn", JointKind.REVOLUTE, "base", "arm", np.eye(4), Z, -10.0, 10.0)
    last = joints or (Joint("held", JointKind.FIXED, "arm", "tool", np.eye(4), X),)
    bodies = (cl.Body("tool", cl.box((0.02, 0.02, 0.02))),)
    return cl.Robot("table", ("base", "arm", "tool"), (turn, *last), bodies)


def turned(*angles, robot=None):
    """The robot turned from angle to angle, 2 s."""
    at = np.interp(TIMES, np.linspace(0.0, 2.0, len(angles)), angles)
    return cl.PlacedRobot(robot or turntable(), cl.Trajectory(TIMES, ("turn",), at[:, None]))


def part_over_to(other, until=np.inf):
    """A part that is turned by half a turn, to x = -1, and comes 20 mm near to something."""
    part = standing("part", cl.box((0.1, 0.1, 0.1)), (1.0, 0.0, 0.0))
    carry = Carry("part", "tool", Window(0.0, until))
    placed = turned(0.0, np.pi, np.pi, 0.0, 0.0)
    return cl.Case("over", (placed,), (part, other), cl.Limits(fail=0.04), carries=(carry,))


def cart(x):
    """A block that stands at x = -2 until 1.4 s, and 0.2 s later is where it stays."""
    at = np.interp(TIMES, [0.0, 1.4, 1.6, 2.0], [-2.0, -2.0, x, x])
    places = np.stack([at, np.zeros(41), np.zeros(41)], axis=1)
    table = PoseTable(TIMES, places, np.tile([0.0, 0.0, 0.0, 1.0], (41, 1)))
    return cl.Obstacle(cl.Body("cart", cl.box((0.1, 0.1, 0.1))), moves=table)


@pytest.mark.slow
def test_a_part_that_is_turned_over_moves_twice_as_far_as_the_base():
    found = cl.gain(part_over_to(cart(-1.12), until=0.9), "base")
    assert found.kept and found.change == pytest.approx([0.01, 0.0, 0.0], abs=1e-6)
    assert found.lower_bound == 0.0


@pytest.mark.parametrize("kind", first_fast(["timing", "base", "waypoints"], 1))
def test_a_part_in_hand_bounds_no_change_of_what_carries_it(kind):
    wall = standing("wall", cl.box((0.1, 0.4, 0.4)), (-1.12, 0.0, 0.0))
    case = replace(part_over_to(wall), robots=(turned(0.0, np.pi), along_x(gantry(), y=9.0)))
    case = replace(case, carries=(Carry("part", "table/tool", Window(0.0)),))
    found = cl.gain(case, kind, robot="table", keep_ends=False, most_delay=0.01)
    assert found.lower_bound == 0.0


@pytest.mark.slow
@pytest.mark.parametrize("limits", [(0.0, 0.1), (-np.inf, np.inf)])
def test_a_slide_beyond_its_limits_is_as_fast_as_it_is(limits):
    slide = Joint("slide", JointKind.PRISMATIC, "arm", "tool", np.eye(4), X, *limits)
    at = np.stack([TIMES - 1.0, np.full(41, 2.0)], axis=1)
    swung = cl.PlacedRobot(turntable(slide), cl.Trajectory(TIMES, ("turn", "slide"), at))
    across = np.stack([np.full(41, 2.0), TIMES - 1.0], axis=1)
    other = cl.PlacedRobot(gantry("other"), cl.Trajectory(TIMES, ("x", "y"), across))
    case = cl.Case("swing", (swung, other), (), cl.Limits(fail=0.05))
    found = cl.gain(case, "timing", robot="table")
    within = replace(slide, lower=-3.0, upper=3.0)
    known = replace(swung, robot=turntable(within))
    same = cl.gain(replace(case, robots=(known, other)), "timing", robot="table")
    assert found.clearances_kept and (found.size, found.lower_bound) == (
        same.size,
        same.lower_bound,
    )


def passing(slow, timing=AS_GIVEN):
    """A block passes fast by one that hardly moves."""
    one = along_x(gantry("slow"), np.array([0.0, 1.0]), 0.0, slow)
    two = along_x(gantry("fast"), np.linspace(0.0, 1.0, 201), -0.5, 9.5, y=0.105)
    return cl.Case("pass", (replace(one, timing=timing), two), (), cl.Limits(fail=0.01))


def test_a_robot_that_comes_later_is_bounded_by_when_it_comes():
    found = cl.gain(passing(0.001, Timing(0.05, 1.0, "absent")), "timing", robot="slow")
    assert found.kept and found.lower_bound < found.size < 0.02


@pytest.mark.parametrize(
    "keep, is_kept", [((0.6, 0.65), True), ((1.1, 1.15), False), ((1.7, 1.8), False)]
)
def test_a_stretch_that_is_kept_is_kept_between_samples_too(keep, is_kept):
    post = standing("post", cl.box((0.1, 0.1, 1.0)), (0.5, 0.12, 0.0))
    placed = along_x(gantry(), np.linspace(0.0, 2.0, 5))
    found = cl.gain(cl.Case("post", (placed,), (post,), cl.Limits(fail=0.03)), keep=(keep,))
    assert found.kept == is_kept
    assert is_kept or "is to be kept" in str(found.blocked)
    before, after = (one.given_trajectory for one in (placed, found.case.robots[0]))
    at = [np.interp(keep, one.times, one.positions[:, 1]) for one in (before, after)]
    assert at[1] == pytest.approx(at[0], abs=1e-12)


def test_no_report_says_what_a_base_does_to_a_part_in_hand():
    wall = standing("wall", cl.box((0.1, 0.4, 0.4)), (-1.12, 0.0, 0.0))
    rates = cl.check(part_over_to(wall)).report.sensitivity.rates
    assert {rate.kind for rate in rates} == {"joint", "obstacle"}


STEP = 1e-4


@pytest.mark.parametrize("seed", first_fast(range(8), 3))
def test_no_joint_moves_a_point_farther_than_its_radius(seed):
    case = case_of(seed, 1)
    motions = [kinematic_motion(placed) for placed in case.robots]
    for i in range(len(case.robots[0].robot.bodies)):
        body = BodyIndex(0, i)
        corners, radii = body.shape_in(case).vertices, motion_radii(case, body)
        for k in range(0, 50, 10):
            (here,) = positions_along(case, motions, k, np.array([0.0]))
            asked = np.vstack([here, here + STEP * np.eye(len(here))])
            poses = body.poses_in(case, forest_of(case).poses(asked))
            placed = corners @ poses[:, :3, :3].transpose(0, 2, 1) + poses[:, None, :3, 3]
            ways = np.linalg.norm(placed[1:] - placed[0], axis=2).max(axis=1)
            assert (ways <= STEP * radii[: len(ways)] * (1.0 + 1e-3) + 1e-12).all()


def on_a_cubic(velocities, rate=1.0):
    """A block goes 1 m along x in 1 s of its table."""
    at = np.array([[0.0, 0.0], [1.0, 0.0]])
    path = cl.Trajectory(
        np.array([0.0, 1.0]), ("x", "y"), at, np.outer(velocities, [1.0, 0.0]).reshape(2, 2)
    )
    limits = {"x": MotionLimit(4.0, 20.0)}
    placed = cl.PlacedRobot(gantry(), path, motion_limits=limits)
    return cl.Case("quick", (replace(placed, timing=cl.Timing(rate=rate)),), ())


@pytest.mark.parametrize("velocities", [(0.0, 0.0), (3.0, 0.0), (0.0, 2.5)])
@pytest.mark.parametrize("rate", [1.0, 2.0])
def test_a_cubic_is_nowhere_faster_than_is_said(velocities, rate):
    case = on_a_cubic(velocities, rate)
    one, two = velocities
    shares = np.linspace(0.0, 1.0, 1001)
    speeds = rate * (
        one + 2.0 * (3.0 - 2.0 * one - two) * shares + 3.0 * (one + two - 2.0) * shares**2
    )
    accelerations = rate**2 * (2.0 * (3.0 - 2.0 * one - two) + 6.0 * (one + two - 2.0) * shares)
    assert greatest_speed(case, 0) >= np.abs(speeds).max() - 1e-12
    room = {one.what: one.headroom.min() for one in joint_ranges(case.robots[0])}
    assert room[SPEED] == pytest.approx(4.0 - np.abs(speeds).max(), abs=1e-4)
    assert room[ACCELERATION] == pytest.approx(20.0 - np.abs(accelerations).max(), abs=1e-4)
