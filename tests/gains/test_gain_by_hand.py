"""Changes whose least size is known by hand; what cannot be reached; what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.gains.answer import gain
from clearance.gains.joint_ranges import joint_ranges
from clearance.gains.obstruction import Obstruction
from clearance.gains.search import Search, SearchResult
from clearance.gains.sentences import lines_of
from clearance.gains.shift import obstacle_shift
from clearance.gains.shortfalls import proven
from clearance.tolerance import CERTIFY_GAP
from clearance.world.body import Body, Obstacle
from clearance.world.placed_robot import MotionLimit
from clearance.world.robot import Joint, JointKind, Mimic
from clearance.world.rules import Waiver
from clearance.world.timing import Timing
from clearance.world.trajectory import MoveSpan
from tests.findings.gates import load_gates
from tests.gains.gantries import along_x, crossing, gantry, slot, standing
from tests.made_cases import at, prism
from tests.simulate.measure.test_refine import sliding

FINE = 1e-6


@pytest.mark.slow
@pytest.mark.parametrize("kind, who", [("base", {}), ("obstacle", {"obstacle": "left"})])
def test_a_bar_through_a_slot_is_moved_by_what_is_missing(kind, who):
    found = gain(slot(fail=0.04, off=0.03), kind, **who)
    assert found.kept and found.after.passed and not found.before.passed
    assert found.size == pytest.approx(0.02, abs=FINE)
    away = 0.02 if kind == "obstacle" else -0.02
    assert found.change == pytest.approx([0.0, away, 0.0], abs=FINE)
    assert 0.02 - FINE < found.lower_bound <= found.size


def test_a_path_through_a_slot_bends_by_what_is_missing():
    found = gain(slot(fail=0.04, off=0.03), "waypoints")
    assert found.kept and found.after.passed
    assert np.abs(found.change[:, 1]).max() == pytest.approx(0.02, abs=FINE)
    assert found.change[[0, -1]] == pytest.approx(np.zeros((2, 2)), abs=1e-12)
    assert 0.0 < found.lower_bound <= found.size == pytest.approx(2.0 * 0.02, abs=2 * FINE)


def test_a_change_that_is_more_than_enough_is_shortened_along_its_own_line():
    """The left wall has to be moved by 10 mm; 15 mm and 5 mm aside are enough too."""
    search = Search(obstacle_shift(slot(fail=0.03), "left"), 0.0)
    far = search.state_at(np.array([0.005, 0.015, 0.0]))
    found = search.shortened(SearchResult(far, proven(far.case, 0.0), 1))
    assert found.kept and found.state.x == pytest.approx([0.01 / 3.0, 0.01, 0.0], rel=0.01)


def test_an_obstacle_moves_without_the_program_that_may_work_on_it():
    case = slot()
    (bar,) = case.robots
    work = replace(bar.trajectory, moves=(MoveSpan("LIN 1", 0.0, 1.0),))
    programmed = replace(case, robots=(replace(bar, trajectory=work),))
    left = [
        line
        for one in (case, programmed)
        for label, line in lines_of(gain(one, "obstacle", obstacle="left"))
        if label == "note"
    ]
    assert left == [
        "the program of robot 'gantry' stays as it is: if it works on left, move its work frame as well"
    ]


def test_an_obstacle_that_a_change_puts_into_another_is_said():
    """The left wall goes 20 mm farther from the bar: one block is 10 mm behind it, one 30 mm."""
    near, far = (
        standing(name, cl.box((0.1, 0.1, 0.1)), (0.0, 0.55 + gap, z))
        for name, gap, z in (("near", 0.01, 0.0), ("far", 0.03, 0.5))
    )
    case = slot()
    found = cl.gain(
        replace(case, obstacles=(*case.obstacles, near, far)), "obstacle", obstacle="left"
    )
    said = [line for label, line in lines_of(found) if label == "warning"]
    assert found.kept and [line for line in said if "'near'" in line and "'left'" in line]
    assert not [line for line in said if "'far'" in line]


@pytest.mark.parametrize("fail", [0.02, 0.1])
def test_the_least_delay_of_two_that_cross(fail):
    found = gain(crossing(fail), "timing", robot="one")
    least = 2.0 * 0.5 * (0.1 + fail / np.sqrt(2.0))  # at 2 m/s
    assert found.kept and found.after.passed
    assert found.lower_bound <= least * (1.0 + 1e-9) and least <= found.size <= least + 2e-3


@pytest.mark.slow
@pytest.mark.parametrize("fail", [0.02, 0.1])
def test_the_least_slow_down_of_two_that_cross(fail):
    found = gain(crossing(fail), "timing", robot="one", slow_down=True)
    assert found.kept and found.after.passed and found.unit == "share"
    slowed = found.case.robots[0].timing.rate
    assert slowed == 1.0 / (1.0 + found.size)
    quicker = crossing(fail).robots[0]
    almost = replace(quicker, timing=replace(quicker.timing, rate=1.0 / (0.998 + found.size)))
    case = crossing(fail)
    assert not cl.check(replace(case, robots=(almost, case.robots[1]))).passed
    assert 0.5 * found.size < found.lower_bound <= found.size


def test_a_table_that_begins_late_or_never_moves_is_slowed_as_it_should():
    case = crossing(0.1)
    early = replace(case.robots[0], timing=Timing(-0.3, 1.0))
    asked = replace(early.trajectory, times=early.trajectory.times + 0.3)
    late = replace(case, robots=(replace(early, trajectory=asked), case.robots[1]))
    found = gain(late, "timing", robot="one", slow_down=True)
    assert found.kept and 0.0 < found.lower_bound <= found.size
    asked = replace(early.trajectory, times=early.trajectory.times - 0.3)
    with pytest.raises(BadInput, match="begins before its time 0"):
        both = (replace(early, trajectory=asked), case.robots[1])
        gain(replace(case, robots=both), "timing", robot="one", slow_down=True)


@pytest.mark.parametrize("kind", ["waypoints", "base", "obstacle", "timing"])
def test_what_is_kept_already_is_not_changed(kind):
    case = crossing(0.1) if kind == "timing" else slot(fail=0.01)
    if kind == "timing":
        case = replace(case, robots=(along_x(gantry("one"), y=5.0), case.robots[1]))
    who = {"obstacle": {"obstacle": "left"}, "timing": {"robot": "one"}}.get(kind, {})
    found = gain(case, kind, **who)
    assert found.kept and found.size == 0.0 and not found.change.any()


def test_what_nothing_moves_is_said_at_once():
    found = gain(slot(fail=0.04, off=0.03), "obstacle", obstacle="right")
    assert not found.kept and found.n_measured == 1
    assert "left" in str(found.blocked) and "nothing of this change moves them" in str(
        found.blocked
    )


def test_a_clearance_that_shows_the_digits_of_what_is_needed_says_that_it_is_rounding():
    near, far = (str(Obstruction("a", "b", 1.0, 0.005 - d, 0.005, "stays")) for d in (1e-9, 1e-6))
    start = "a and b are {} mm apart at 1.000 s, {}, and stays"
    assert near == start.format("5.000", "equal to the 5 mm that are needed but for rounding")
    assert far == start.format("4.999", "5 mm are needed")


def test_a_moment_that_is_kept_and_violated_is_said_at_once():
    found = gain(slot(), "waypoints", keep=((0.4, 0.6),))
    assert not found.kept and found.n_measured == 1
    assert 0.4 <= found.blocked.time <= 0.6 and "is to be kept" in str(found.blocked)


def test_clocks_that_are_not_tied_are_refused():
    case = replace(crossing(), clock=cl.Clock(0.1))
    with pytest.raises(BadInput, match="clocks"):
        gain(case, "base", robot="one")


def test_a_path_beyond_its_limits_is_refused():
    bar = gantry(size=(0.4, 0.1, 0.1), y_range=(-0.1, 0.02))
    with pytest.raises(BadInput, match=r"joint 'y' is 0\.01 m beyond its upper limit"):
        gain(replace(slot(), robots=(along_x(bar, y=0.03),)), "waypoints")


def quick(n, speed, acceleration=np.inf):
    """A block on cubics along x, past a post that it comes 10 mm too near to."""
    times = np.linspace(0.0, 2.0, n)
    at = np.stack([np.linspace(-1.0, 1.0, n), np.zeros(n)], axis=1)
    rates = np.tile([1.0, 0.0], (n, 1))
    limits = {"y": MotionLimit(speed, acceleration)}
    path = cl.Trajectory(times, ("x", "y"), at, rates)
    placed = cl.PlacedRobot(gantry(), path, motion_limits=limits)
    post = standing("post", cl.box((0.1, 0.1, 1.0)), (0.5, 0.12, 0.0))
    return cl.Case("quick", (placed,), (post,), cl.Limits(fail=0.03, joints="fail"))


@pytest.mark.slow
@pytest.mark.parametrize("n, speed, acceleration", [(5, 0.05, 0.2), (41, 0.03, np.inf)])
def test_speeds_and_accelerations_are_kept_on_cubics(n, speed, acceleration):
    found = gain(quick(n, speed, acceleration), "waypoints")
    assert found.kept == found.after.passed
    assert "joint limits" not in found.after.verdict.headline()
    ranges = joint_ranges(found.case.robots[0])
    assert all(one.headroom.min() > -1e-9 for one in ranges)


def with_own_speed(case, speed):
    """The same with a speed of y that the robot's own file gives, and no other limits."""
    placed = case.robots[0]
    x, y = placed.robot.joints
    robot = replace(placed.robot, joints=(x, replace(y, velocity=speed)))
    return replace(case, robots=(replace(placed, robot=robot, motion_limits={}),))


@pytest.mark.parametrize("speed, is_kept", [(0.06, True), (0.004, False)])
def test_speeds_of_the_robots_own_file_are_kept(speed, is_kept):
    found = gain(with_own_speed(quick(41, 1.0), speed), "waypoints")
    worst = {one.what: one.headroom.min() for one in joint_ranges(found.case.robots[0])}
    assert found.kept == is_kept and worst["speed limit of the robot's own file"] > -1e-9
    assert is_kept or any("limit of the robot's own file" in line for line in found.binding)


def test_what_is_too_fast_for_its_own_file_is_told_and_made_no_faster():
    case = quick(41, 1.0)
    at = case.robots[0].given_trajectory.positions.copy()
    at[:, 1] = 0.02 * np.sin(20.0 * case.robots[0].given_trajectory.times)
    path = cl.Trajectory(case.robots[0].given_trajectory.times, ("x", "y"), at)
    case = replace(case, robots=(replace(case.robots[0], trajectory=path),))
    case = with_own_speed(case, 0.3)
    found = gain(case, "waypoints")
    speeds = [
        np.abs(np.diff(one.robots[0].given_trajectory.positions[:, 1])) / 0.05
        for one in (case, found.case)
    ]
    assert speeds[0].max() > 0.3 and (speeds[1] <= np.maximum(speeds[0], 0.3) + 1e-9).all()
    assert any(label == "note" and "y by " in line for label, line in lines_of(found))


def test_a_joint_that_follows_is_kept_within_its_limits():
    robot = gantry()
    follower = replace(
        robot.joints[1], name="z", lower=-0.02, upper=0.02, parent="base", child="jaw",
        mimic=Mimic("y", -2.0, 0.005),
    )  # fmt: skip
    links = (*robot.link_names, "jaw")
    jawed = cl.Robot(robot.name, links, (*robot.joints, follower), robot.bodies)
    case = slot(off=0.0, fail=0.03)
    low = standing("low", cl.box((0.5, 0.4, 2.0)), (0.0, -0.26, 0.0))
    case = replace(case, robots=(replace(case.robots[0], robot=jawed),), obstacles=(low,))
    found = gain(case, "waypoints")
    jaw = 0.005 - 2.0 * found.case.robots[0].given_trajectory.positions[:, 1]
    assert not found.kept and np.abs(jaw).max() <= 0.02 + 1e-9


@pytest.mark.parametrize("kind", ["obstacle", "base"])
def test_balls_of_a_cloud_that_overlap_are_parted(kind):
    cloud = cl.PointCloud([[0.0, 0.0, 0.0], [0.5, 0.0, 0.0], [-0.5, 0.02, 0.0]], 0.05)
    scan = standing("scan", cloud, (0.0, 0.08, 0.0))  # 20 mm deep in the block's way
    case = cl.Case("scan", (along_x(gantry()),), (scan,), cl.Limits(fail=0.01))
    found = gain(case, kind)
    assert found.kept and found.size == pytest.approx(0.03, abs=FINE)
    assert found.lower_bound == pytest.approx(0.03, rel=1e-4)


def disc_past_two_posts(way, *short):
    """A disc on a line, or on two at a right angle, past a post beside each half, too near by what is given.

    Four of its corners lie along x and y: those come nearest to a post.
    """
    times, along = np.linspace(0.0, 1.0, 81), np.linspace(-1.0, 1.0, 81)
    first, second = (0.37 - one for one in short)
    if way == "line":
        at, posts = np.stack([along, 0.0 * along], axis=1), ((-0.5, first), (0.5, -second))
    else:
        at = np.stack([np.minimum(along, 0.0), np.maximum(along, 0.0)], axis=1)
        posts = ((-0.5, first), (-second, 0.5))
    robot = replace(gantry(), bodies=(cl.Body("tool", prism(0.1, 0.1)),))
    placed = cl.PlacedRobot(robot, cl.Trajectory(times, ("x", "y"), at))
    post = cl.PointCloud([[0.0, 0.0, 0.0]], 0.05)
    named = (
        standing(name, post, (*xy, 0.0)) for name, xy in zip(("one", "two"), posts, strict=True)
    )
    return cl.Case("discs", (placed,), tuple(named), cl.Limits(fail=0.22))


def test_what_only_a_finer_proof_holds_is_not_kept(monkeypatch):
    def too_easy(case, margin, gap=CERTIFY_GAP):
        return proven(case, margin if gap == CERTIFY_GAP else margin - 0.001, gap)

    monkeypatch.setattr("clearance.gains.search.proven", too_easy)
    found = gain(disc_past_two_posts("line", 0.01, 0.005), "waypoints")
    assert found.kept and found.after.passed


def test_a_disc_round_a_corner_is_moved_away_from_both_posts():
    found = gain(disc_past_two_posts("corner", 0.025, 0.025), "base")
    assert found.kept and found.change == pytest.approx([0.025, -0.025, 0.0], abs=FINE)
    assert found.size == pytest.approx(0.025 * np.sqrt(2.0), abs=FINE)
    assert found.lower_bound == pytest.approx(0.025, rel=1e-4)  # each post by itself wants that


def test_waivers_are_said_not_to_be_counted_and_before_is_of_what_fails(tmp_path):
    """Gate a is nearer and waived; b fails, and is to be moved."""
    case = load_gates(tmp_path, {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.004)})
    waiver = Waiver(("box", "gate_a"), at_least=0.002, reason="r", by="N")
    told = dict(lines_of(gain(replace(case, waivers=(waiver,)), "obstacle", obstacle="gate_b")))
    assert (
        told["before"].startswith("box and gate_b: 4.000 mm") and "with 1 waiver" in told["before"]
    )
    assert told["waivers"].startswith("not counted") and "box and gate_a" in told["blocked"]


def test_a_pair_that_nothing_moves_may_be_at_its_limit_but_for_rounding():
    """The wall is as far as the limit, the post 2 mm from where the cube ends."""
    one = sliding(0.005)
    post = Obstacle(Body("post", cl.box((0.1, 0.02, 0.1))), at(0.602))
    found = gain(replace(one, obstacles=(*one.obstacles, post)), "obstacle", obstacle="post")
    assert found.kept and found.change == pytest.approx([0.003, 0.0, 0.0], abs=FINE)


def test_a_clearance_that_hardly_grows_with_a_joint_is_gained_all_the_same():
    """A block below a roof, on a slide along it that falls by 2 mm a metre."""
    slide = Joint("x", JointKind.PRISMATIC, "base", "tool", np.eye(4), [-1.0, -0.002, 0.0])
    block = cl.Body("tool", cl.box((0.1, 0.1, 0.1)))
    robot = cl.Robot("slider", ("base", "tool"), (slide,), (block,))
    path = cl.Trajectory(np.linspace(0.0, 1.0, 41), ("x",), np.zeros((41, 1)))
    roof = standing("roof", cl.box((3.0, 0.1, 1.0)), (0.0, 0.15, 0.0))
    case = cl.Case("roof", (cl.PlacedRobot(robot, path),), (roof,), cl.Limits(fail=0.05002))
    found = gain(case, "waypoints", keep_ends=False)
    assert found.kept and found.size == pytest.approx(2.0 * 0.01, rel=0.05)
    told = dict(lines_of(gain(case, "waypoints")))["not kept"]
    assert told.endswith("while the ends of the path are kept (--free-ends frees them)")
