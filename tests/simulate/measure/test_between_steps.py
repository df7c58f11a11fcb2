"""What only the motion between the steps shows: who, when, where, at which joints, in every answer of a run."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.simulate.replay.replay import replay_of
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at

LIMITS = cl.Limits(fail=0.005, warn=0.02)
POST_X = 0.75


def sweeping(positions, post_height=1.0, limits=LIMITS, velocities=None) -> Case:
    """An arm of two links that turns level about z; a post stands 0.75 m before it, a wall behind it."""
    joints = (
        Joint(
            "shoulder", JointKind.REVOLUTE, "base", "upper", at(z=0.5), np.array([0.0, 0, 1]), -3, 3
        ),
        Joint(
            "elbow", JointKind.REVOLUTE, "upper", "fore", at(x=0.5), np.array([0.0, 0, 1]), -3, 3
        ),
    )
    upper = cl.box((0.5, 0.05, 0.05)).transformed(at(x=0.25))
    fore = cl.box((0.4, 0.04, 0.04)).transformed(at(x=0.2))
    robot = Robot(
        "arm", ("base", "upper", "fore"), joints, (Body("upper", upper), Body("fore", fore))
    )
    positions = np.array(positions, dtype=float)
    times = 2.0 * np.arange(len(positions))
    asked = Trajectory(times, ("shoulder", "elbow"), positions, velocities)
    post = Obstacle(
        Body("post", cl.box((0.05, 0.05, post_height))), at(POST_X, 0.0, 0.5 * post_height)
    )
    wall = Obstacle(Body("wall", cl.box((0.05, 0.5, 1.0))), at(-0.75, 0.0, 0.5))
    return Case("sweep", (PlacedRobot(robot, asked),), (post, wall), limits)


THROUGH = [[-1.0, 0.0], [1.0, 0.0]]
"""Clear by half a metre at both ends; the fore arm goes through the post half way."""

PAST = 0.477
"""[m] a post of this height leaves 3 mm under the fore arm: below the fail limit, no contact."""


def test_two_waypoints_that_sweep_an_arm_through_a_post_are_contact():
    run = cl.check(sweeping(THROUGH))
    assert (run.status, run.passed, run.verdict.exit_code) == ("contact", False, 1)
    worst = run.worst
    assert (worst["link"], worst["obstacle"], worst["clearance"]) == ("fore", "post", 0.0)
    assert worst["between"] and worst["step"] == 0 and 0.8 < worst["time"] < 1.2
    point = np.array([worst[f"obstacle_{axis}"] for axis in "xyz"])
    assert (np.abs(point - [POST_X, 0.0, 0.5]) <= [0.025 + 1e-9, 0.025 + 1e-9, 0.02 + 1e-9]).all()
    assert run.worst_sample["clearance"] > 0.5 and run.worst_sample["status"] == "clear"
    assert not run.worst_sample["between"]


def test_the_samples_alone_say_so():
    run = cl.check(sweeping(THROUGH), certify=False)
    assert (run.status, run.verdict.basis, run.certificate) == ("clear", "samples", None)
    assert run.verdict.headline() == "clear at the samples only"
    assert run.worst == run.worst_sample


def test_what_is_named_really_occurs_there():
    """The pose of the moment, sampled as a step of its own, has the moment's clearance, pair and points."""
    case = sweeping(THROUGH, post_height=PAST)
    run = cl.check(case)
    moment = run.certificate.worst
    assert run.status == "violated" and moment is run.record.worst
    assert (
        moment.clearance == pytest.approx(0.003, abs=1e-4)
        and run.certificate.lower_bound[0] > 0.002
    )
    share = moment.time / 2.0
    assert moment.positions[0] == pytest.approx([-1.0 + 2.0 * share, 0.0])
    there = cl.check(sweeping([moment.positions[0]], post_height=PAST))
    assert there.worst["clearance"] == pytest.approx(moment.clearance, abs=1e-12)
    assert (
        (there.worst["link"], there.worst["obstacle"])
        == (moment.link, moment.obstacle)
        == ("fore", "post")
    )
    apart = np.linalg.norm(np.subtract(moment.point_link, moment.point_obstacle))
    assert apart == pytest.approx(moment.clearance, abs=1e-12)


def test_a_moment_on_cubics_is_where_the_cubic_is():
    """With velocities the arm passes the post at another time: the pose is that of the cubic."""
    velocities = np.array([[0.0, 0.0], [3.0, 0.0]])
    run = cl.check(sweeping(THROUGH, post_height=PAST, velocities=velocities))
    moment, share = run.certificate.worst, run.certificate.worst.time / 2.0
    step, e0, e1 = 2.0, 0.0 - 2.0, 6.0 - 2.0
    rest = 1.0 - share
    expected = -1.0 + share * step + share * rest * (rest * e0 - share * e1)
    assert moment.positions[0][0] == pytest.approx(expected, abs=1e-12)
    assert abs(expected) < 0.2  # over the post


def test_the_deepest_between_is_told_where_a_step_is_less_deep():
    """The step at 0.05 rad is in the post, less deep than the fore arm gets on its way there."""
    record = cl.check(sweeping([[-1.0, 0.0], [0.05, 0.0]])).record
    assert record.worst_sample.depth.penetration < record.worst.depth.penetration
    assert record.worst.between and record.worst.depth.penetration > 0.044


@pytest.mark.parametrize("need", ["steps", "pairs", "limit", "minimum"])
@pytest.mark.parametrize(("height", "status"), [(1.0, "contact"), (PAST, "violated")])
def test_every_need_is_certified(need, height, status):
    run = cl.check(sweeping([[-1.0, 0.0], *THROUGH, [1.2, 0.0]], height), need=need)
    assert (run.status, run.verdict.basis) == (status, "motion")
    assert (run.worst["link"], run.worst["obstacle"], run.worst["step"]) == ("fore", "post", 1)


def test_status_and_between_tell_the_motion_where_it_is_worse_than_both_steps():
    case = sweeping([[-1.2, 0.0], *THROUGH, [1.2, 0.0]])
    steps = cl.check(case).steps.to_pylist()
    assert [row["status"] for row in steps] == ["clear", "contact", "clear", "clear"]
    assert [row["between"] for row in steps] == [False, True, False, False]
    assert steps[1]["clearance"] > 0.5 and steps[1]["upper_bound"] == 0.0
    ends = sweeping([[-1.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    steps = cl.check(ends).steps.to_pylist()  # the middle step is in contact itself
    assert [row["status"] for row in steps] == ["clear", "contact", "clear"]
    assert not any(row["between"] for row in steps)


def test_the_replay_stops_at_the_moment_with_the_right_bodies():
    run = cl.check(sweeping([[-1.2, 0.0], *THROUGH]))
    replay = replay_of(run.session)
    worst = replay.i_worst
    assert (replay.steps[worst], replay.between[worst]) == (1, 1)
    assert replay.times[worst] == run.worst["time"] and replay.status[worst] == 3
    assert [replay.bodies[i].name for i in replay.nearest[worst]] == ["fore", "post"]
    shoulder = run.record.worst.positions[0][0]
    turn = replay.poses[1][worst]
    assert 2.0 * np.arctan2(turn[5], turn[6]) == pytest.approx(shoulder, abs=1e-6)


def test_the_replay_goes_the_way_between_far_samples_with_what_is_measured_there():
    case = sweeping([[-1.2, 0.0], *THROUGH], PAST)
    replay, record = replay_of(cl.check(case).session), cl.check(case).record
    assert (np.diff(replay.times) > 0.0).all() and np.diff(replay.times).max() <= 4.0 / 199
    shoulders = np.interp(replay.times, [0.0, 2.0, 4.0], [-1.2, -1.0, 1.0])
    there = cl.check(sweeping(np.column_stack([shoulders, 0.0 * shoulders]), PAST), certify=False)
    assert replay.clearances == pytest.approx(there.record.clearances, abs=1e-12)
    assert replay.steps[replay.between == 0].tolist() == [0, 1, 2]
    lowest = replay.clearances[(replay.times > 3.0 - 0.01) & (replay.times < 3.0 + 0.01)]
    assert lowest.min() == pytest.approx(record.worst.clearance, abs=1e-9) and len(lowest)


def test_a_gap_below_rounding_ends_and_says_what_it_became():
    case = sweeping(THROUGH, post_height=PAST)
    run = cl.answer(cl.Question(case, certify_gap=1e-300))
    (warning,) = run.verdict.warnings
    assert "rounding" in warning and run.certificate.gap > 1e-11
    assert 0.0 < run.certificate.gap < 1e-8
    bound, seen = run.certificate.lower_bound.min(), run.certificate.upper_bound.min()
    assert seen - run.certificate.gap <= bound <= seen
    assert cl.answer(cl.Question(case, certify_gap=1e-6)).verdict.warnings == ()


def test_a_proof_that_takes_too_many_parts_is_widened_and_ends(monkeypatch):
    from clearance.simulate.measure import certify, refine

    case = sweeping(THROUGH, post_height=PAST)
    tight = cl.answer(cl.Question(case, certify_gap=1e-6)).certificate
    monkeypatch.setattr(certify, "MOST_PARTS", 4)
    for most in ("MOST_QUERIES", "LEAST_QUERIES"):  # which would decide whether there is contact
        monkeypatch.setattr(refine, most, -1)
    wide = cl.answer(cl.Question(case, certify_gap=1e-6)).certificate
    assert wide.lower_bound[0] < tight.lower_bound[0] <= wide.upper_bound[0]
    assert wide.tally["queries"] < tight.tally["queries"]


@pytest.mark.parametrize("limits", [LIMITS, cl.Limits()])
def test_contact_between_two_steps_has_its_depth(limits):
    """Half way the fore arm, 40 mm thick, is 45 mm deep in the post: half of both, the shortest way out."""
    run = cl.check(sweeping(THROUGH, limits=limits))
    depth = run.record.worst.depth
    assert depth.penetration == pytest.approx(0.045, abs=1e-9) and depth.exact
    assert run.worst["between"] and run.worst["time"] == pytest.approx(1.0)
    assert cl.check(sweeping(THROUGH), contact="none").record.worst.depth is None
