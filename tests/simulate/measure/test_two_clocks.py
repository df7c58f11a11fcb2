"""Cells whose actors' clocks are not tied: all pairs of times against single questions on a grid of both."""

from __future__ import annotations

import functools
from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.report.junit_cases import results_of
from clearance.report.markdown import markdown
from clearance.report.topics.certainty import lines
from clearance.simulate.measure.sections import section_plan
from clearance.world.carry import Carry
from clearance.world.case import Clock
from clearance.world.robot import Joint, JointKind
from clearance.world.timing import Window
from tests.cells import cell, pose_at
from tests.gains.gantries import along_x, gantry, standing
from tests.made_cases import at
from tests.simulate.measure.test_unsynchronised import sliding

CLOCK = {
    "left": 0,
    "part": 0,
    "lid": 0,
    "right": 1,
    "track": 1,
    "door": 2,
    "crate": 2,
    "post": None,
}


def loose(seed: int, slack: float) -> cl.Case:
    """A cell in which only the left arm carries the part; three clocks."""
    case = cell(seed, apart=2.0)
    carries = (
        Carry("part", "left/tool", Window(1.0, 2.5)),
        Carry("part", "left/boom", Window(4.0)),
    )
    return replace(case, carries=carries, clock=Clock(slack))


@functools.cache
def measured(slack: float) -> cl.Run:
    """A cell at its steps alone."""
    return cl.check(loose(4, slack), certify=False)


def pose_of(x: float) -> np.ndarray:
    pose = np.eye(4)
    pose[0, 3] = x
    return pose


def clock_of(name: str) -> int | None:
    return CLOCK[name.split("/")[0]]


def grid_of(case, run, times_a, times_b):
    """(len(times_a), len(times_b)) [m] the least of all pairs of two clocks, each body at its own time."""
    pairs = {
        (p.a.name_in(case), p.b.name_in(case)): (p.a.shape_in(case), p.b.shape_in(case))
        for p in section_plan(run.record.timeline).pairs
    }
    least = np.full((len(times_a), len(times_b)), np.inf)
    i, k = np.nonzero(np.abs(times_a[:, None] - times_b[None]) <= case.clock.slack)
    for (a, b), shapes in pairs.items():
        if None in (clock_of(a), clock_of(b)) or clock_of(a) == clock_of(b):
            continue
        poses_a = np.array([pose_at(case, a, float(t)) for t in times_a])
        poses_b = np.array([pose_at(case, b, float(t)) for t in times_b])
        near = cl.Query(*shapes).distances(poses_a[i], poses_b[k]).distances
        least[i, k] = np.minimum(least[i, k], near)
    return least


@pytest.mark.slow
@pytest.mark.parametrize(("seed", "slack"), [(1, np.inf), (2, 0.7)])
def test_no_pair_of_times_is_nearer(seed, slack):
    """A cell for each slack: nearly all of the time goes into the runs, and each asks of every pair of clocks."""
    case = loose(seed, slack)
    run = cl.check(case)
    times = run.steps["time"].to_numpy()
    between = np.sort(np.concatenate([times[1:-1] + 1e-9, np.linspace(times[0], times[-1], 23)]))
    finer = 0.5 * (times[1:] + times[:-1])
    grid = grid_of(case, run, finer, between)
    lower = run.certificate.lower_bound
    assert (lower[:-1] <= grid.min(axis=1) + 1e-9).all()
    assert lower.min() >= run.record.worst.clearance - 1.001e-4


@pytest.mark.slow
def test_a_step_has_the_least_over_the_other_clock_and_says_when():
    run = measured(np.inf)
    case = run.record.case
    rows, tied = run.steps.to_pylist(), cl.check(replace(case, clock=Clock()), certify=False)
    assert (run.steps["clearance"].to_numpy() <= tied.steps["clearance"].to_numpy() + 1e-12).all()
    told = [row for row in rows if row["time_b"] is not None]
    assert told
    for row in told:
        poses = (
            pose_at(case, row["body_a"], row["time"]),
            pose_at(case, row["body_b"], row["time_b"]),
        )
        pair = next(
            p
            for p in section_plan(run.record.timeline).pairs
            if (p.a.name_in(case), p.b.name_in(case)) == (row["body_a"], row["body_b"])
        )
        near = cl.distance(
            pair.a.shape_in(case), pair.b.shape_in(case), pose_a=poses[0], pose_b=poses[1]
        )
        assert near.distance == pytest.approx(row["clearance"], abs=1e-9)


@pytest.mark.slow
def test_more_slack_is_no_farther():
    runs = [measured(slack) for slack in (0.0, 0.3, 2.0, np.inf)]
    least = [run.record.worst.clearance for run in runs]
    assert all(b <= a + 1e-12 for a, b in zip(least, least[1:], strict=False))


@pytest.mark.parametrize("slack", [0.0, 0.2, np.inf])
def test_a_part_is_met_where_it_lies_before_it_is_picked_up(slack):
    """A block passes it at 50 mm, half a metre from its own link."""
    one, two = gantry("one"), gantry("two")
    off = cl.Body("tool", cl.box((0.1, 0.1, 0.1)).transformed(pose_of(0.5)))
    passing = along_x(replace(two, bodies=(off,)), start=-1.5, end=0.5, y=0.15)
    robots = along_x(one, start=3.0, end=3.5), passing
    part = standing("part", cl.box((0.1, 0.1, 0.1)), (0.3, 0.0, 0.0))
    carries = (Carry("part", "one/tool", Window(0.975)),)
    case = cl.Case("lies", robots, (part,), cl.Limits(fail=0.01), carries=carries)
    worst = cl.check(replace(case, clock=Clock(slack))).record.worst
    assert worst.clearance == pytest.approx(0.05, abs=1e-12)


def test_what_needs_one_time_is_refused():
    case = loose(1, 0.5)
    with pytest.raises(BadInput, match="clocks are not tied"):
        cl.check(case, need="pairs")
    handed = replace(case, carries=(case.carries[0], Carry("part", "right/tool", Window(4.0))))
    with pytest.raises(BadInput, match="changes hands between actors whose clocks are not tied"):
        cl.check(handed)


@pytest.mark.peer
def test_the_cross_check_says_what_it_leaves_out():
    run = cl.check(loose(4, 0.5), cross_check=True, certify=False)
    assert run.cross_check.agrees
    assert any("not cross-checked" in notice.text for notice in run.record.notices)


@pytest.mark.peer
def test_where_no_clocks_are_tied_nothing_is_cross_checked():
    """At one time the blocks pass each other at 0.2; at times of their own at 0.1, all along."""
    passing = along_x(gantry("one")), along_x(gantry("two"), start=1.0, end=-1.0, y=0.2)
    run = cl.check(cl.Case("passing", passing, (), clock=Clock(np.inf)), cross_check=True)
    assert run.cross_check is None
    assert any("not cross-checked" in notice.text for notice in run.record.notices)


@pytest.mark.slow
def test_every_pair_has_its_least():
    case = loose(4, np.inf)
    few = tuple(one for one in case.obstacles if one.name not in ("lid", "crate", "post"))
    run = cl.check(replace(case, obstacles=few), certify=False)
    case = run.record.case
    told = {(row.link, row.obstacle): row.clearance for row in run.pair_minima}
    names = {
        (p.a.name_in(case), p.b.name_in(case)) for p in section_plan(run.record.timeline).pairs
    }
    assert set(told) == names
    assert min(told.values()) == pytest.approx(run.record.worst_sample.clearance, abs=1e-12)


@pytest.mark.slow
def test_contact_that_no_one_time_has_is_said_to_have_no_depth():
    run = cl.check(replace(loose(1, np.inf), accept=("start",)), certify=False)
    assert run.status == "contact"
    assert any("no depth" in text for text in run.verdict.warnings)


def past_two_posts(slack: float) -> cl.Case:
    """A tall slide that goes past two posts of another robot, one above the other, between its two samples."""
    tall = sliding("slide", (-0.5, 0.0, 0.0), (1.0, 0.0, 0.0), size=(0.1, 0.1, 0.8), n_steps=2)
    other = sliding("posts", (0.0, 0.0, 0.0), (0.0, 0.01, 0.0), n_steps=2)
    (joint,), (low,) = other.robot.joints, other.robot.bodies
    fixed = Joint("fixed", JointKind.FIXED, "tool", "high", pose_of(0.0))
    high = cl.Body("high", low.shape.transformed(at(z=0.3)))
    posts = cl.Robot("posts", ("base", "tool", "high"), (joint, fixed), (low, high))
    return cl.Case("two", (tall, replace(other, robot=posts)), (), clock=Clock(slack))


@pytest.mark.parametrize("slack", [np.inf, 0.1])
def test_a_pair_that_another_may_hide_passes_nowhere(slack):
    report = cl.check(past_two_posts(slack)).report
    pairs = {one.name: one for one in results_of(report) if one.group == "slide/tool"}
    broken = [one for one in pairs.values() if one.fault]
    (hidden,) = [one for one in pairs.values() if not one.fault]
    assert len(broken) == 1 and hidden.skipped
    assert hidden.text.startswith("not judged by itself, since its rule is broken and where clocks")
    said = "other pairs may break their limits too: where clocks are not tied only the nearest pair"
    assert said in markdown(report)
    assert ("incomplete", said + " of each step is known") in [*lines(report)]


@pytest.mark.parametrize("slack", [np.inf, 0.5])
def test_the_least_of_a_pair_is_at_the_step_that_has_it(slack):
    """Its points are so far from each other; the slide is nearest at its third step."""
    case = past_two_posts(slack)
    slide, posts = case.robots
    x = np.array([[0.0], [0.1], [0.35], [0.2]])
    path = cl.Trajectory(np.arange(4.0), ("joint",), x)
    rows = cl.Trajectory(np.arange(4.0), ("joint",), np.array([[0.0], [0.01], [0.0], [0.01]]))
    robots = replace(slide, trajectory=path), replace(posts, trajectory=rows)
    for row in cl.check(replace(case, robots=robots), certify=False).pair_minima:
        apart = np.linalg.norm(np.subtract(row.point_link, row.point_obstacle))
        assert apart == pytest.approx(row.clearance, abs=1e-9)
        assert (row.step, row.time) == (2, 2.0)
