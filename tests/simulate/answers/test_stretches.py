"""Stretches below a level hold all that is below it, and little more, however coarse the samples are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.record.levels import LEVELS
from clearance.simulate.answers.stretches import joined_spans
from clearance.simulate.replay.curve_moments import nearest_moments
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.placed_robot import PlacedRobot
from clearance.world.robot import JointKind
from clearance.world.rules import Rule
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, driven, resampled
from tests.simulate.measure.test_between_steps import LIMITS, PAST, THROUGH, sweeping

SCENES = Path(__file__).parents[3] / "scenes"

TWICE = [[-1.0, 0.0], [1.0, 0.0], [-0.3, 0.3], [0.2, -0.4], [-1.1, 0.1], [-1.0, 0.0]]
"""Over the post or through it five times, twice with a bent elbow."""


def spans_of(case: Case) -> dict[str, np.ndarray]:
    """(k, 2) [s] of each level."""
    found = cl.check(case).session.motion_levels
    assert found is not None
    return {level: np.array(spans).reshape(-1, 2) for level, spans in found.spans.items()}


def test_spans_that_overlap_or_meet_are_one():
    spans = np.array([[9.0, 10.0], [3.0, 4.0], [0.0, 9.0], [1.0, 2.0], [11.0, 12.0]])
    assert joined_spans(spans).tolist() == [[0.0, 10.0], [11.0, 12.0]]


def finer(case: Case, times: int) -> Case:
    """The case with so many times the samples, on the same lines."""
    asked = case.robots[0].trajectory
    n = (asked.n_steps - 1) * times + 1
    return resampled(case, np.linspace(asked.times[0], asked.times[-1], n))


def sampled(case: Case, level: str, times: int) -> tuple[np.ndarray, np.ndarray]:
    """(n,) [s] many moments, and whether the case is below the level then."""
    record = cl.check(finer(case, times), certify=False).record
    limits = case.limits
    clearances = record.clearances
    below = {
        "below_warn": clearances < limits.warn,
        "below_fail": (clearances < limits.fail) | (clearances <= 0.0),
        "contact": clearances <= 0.0,
    }
    return record.motions[0].times, below[level]


def assert_around(spans: np.ndarray, times: np.ndarray, below: np.ndarray, wider: float) -> None:
    """All that is below lies in the spans, each begins and ends within [s] of it, and no gap is swallowed."""
    inside = np.zeros(len(times), dtype=bool)
    for start, end in spans:
        own = (times >= start) & (times <= end)
        inside |= own
        own_times = times[own & below]
        assert len(own_times), (start, end)
        assert own_times[0] - start <= wider and end - own_times[-1] <= wider
    assert not (below & ~inside).any()


@pytest.mark.parametrize("level", LEVELS)
@pytest.mark.parametrize("height", [1.0, PAST, 0.47])
def test_all_that_is_below_lies_in_them_and_little_more(height, level):
    case = sweeping(TWICE, height)
    times, below = sampled(case, level, 1000)
    assert_around(spans_of(case)[level], times, below, 0.02 + 0.002 + 0.001)


def test_what_is_left_between_two_steps_below_is_left():
    """The arm is in the post at both steps, and turns all the way round in between, through the wall behind it."""
    found = spans_of(sweeping([[0.0, 0.0], [2.0 * np.pi, 0.0]], 1.0))
    assert [len(found[level]) for level in LEVELS] == [3, 3, 3]
    turn = np.arcsin(0.045 / 0.75)  # so far at least the post is met
    assert found["contact"][0, 0] == 0.0 and found["contact"][2, 1] == 2.0
    assert turn / np.pi < found["contact"][0, 1] < 0.1


@pytest.mark.slow
def test_cubics_are_followed():
    velocities = np.array([[0.0, 0.0], [3.0, 0.0]])
    case = sweeping(THROUGH, PAST, velocities=velocities)
    (placed,) = case.robots
    asked = placed.trajectory
    share = np.linspace(0.0, 1.0, 20001)[:, None]
    rest, e1 = 1.0 - share, 4.0
    shoulder = -1.0 + 2.0 * share + share * rest * (rest * -2.0 - share * e1)
    table = Trajectory(2.0 * share[:, 0], asked.joint_names, np.hstack([shoulder, 0.0 * share]))
    dense = replace(case, robots=(replace(placed, trajectory=table),))
    for level in LEVELS:
        times, below = sampled(dense, level, 1)
        assert_around(spans_of(case)[level], times, below, 0.02 + 0.002)


def test_paddings_and_rules_are_those_of_the_pair():
    """A post that is padded by 5 mm, for which a rule asks 10 mm: 15 mm between the bodies."""
    case = sweeping(THROUGH, 0.47)
    post, wall = case.obstacles
    limits = replace(LIMITS, rules=(Rule(("fore", "post"), name="post", fail=0.01, warn=0.012),))
    told = replace(case, obstacles=(replace(post, padding=0.005), wall), limits=limits)
    plain = replace(case, limits=cl.Limits(0.015, 0.017))
    assert np.array_equal(spans_of(told)["below_fail"], spans_of(plain)["below_fail"])


def test_intervals_and_events_are_of_the_motion():
    session = cl.check(sweeping(THROUGH, PAST)).session
    (below,) = session.intervals["below_fail"]
    assert below.start < 0.9325 and below.end > 1.0675 and below.end - below.start < 0.18
    assert below.between and below.clearance == pytest.approx(0.003, abs=1e-4)
    assert (below.first_step, below.last_step) == (0, 0)
    told = [(event.what, event.between) for event in session.events]
    assert told == [
        ("warn limit entered", True),
        ("fail limit entered", True),
        ("fail limit left", True),
        ("warn limit left", True),
    ]
    entered = session.events[1]
    assert (entered.link, entered.obstacle) == ("fore", "post")
    there = cl.check(sweeping([[entered.time - 1.0, 0.0]], PAST)).worst["clearance"]
    assert entered.time == below.start and entered.clearance == pytest.approx(there, abs=1e-12)


def test_a_body_that_goes_wholly_into_another_stays_in_contact():
    """A cube of 0.1 m goes through a solid block of 1 m: from 0.45 to 1.55 m, its surface 0.45 m away half way."""
    block = Obstacle(Body("block", cl.box((1.0, 1.0, 1.0))), at(1.0))
    for positions in ([0.0, 2.0], [0.0, 0.9, 1.1, 2.0]):
        cube = driven(cl.box((0.1,) * 3), JointKind.PRISMATIC, [0.0], axis=(1, 0, 0))
        path = Trajectory(np.array(positions), ("joint",), np.array(positions)[:, None])
        case = Case("through", (replace(cube, trajectory=path),), (block,), LIMITS)
        (contact,) = spans_of(case)["contact"].tolist()
        assert contact[0] <= 0.45 <= contact[0] + 0.021 and contact[1] - 0.021 <= 1.55 <= contact[1]
        assert len(spans_of(case)["below_warn"]) == len(spans_of(case)["below_fail"]) == 1


@pytest.mark.slow
@pytest.mark.parametrize("scene", ["turntable_cell"])
def test_moments_of_cells_that_are_below_lie_in_the_stretches(scene):
    """Doors and turntables that move by tables, parts that are carried, rules; samples that are far apart."""
    case = cl.load_case(SCENES / scene / "case.yaml")
    told = replace(case, robots=tuple(map(thinned, case.robots)), waivers=())
    session = cl.check(told).session
    spans, rng = session.motion_levels.spans, np.random.default_rng(5)
    for rule in session.rules:
        for answer in rule.pairs.answers:
            for step in range(answer.section.phase.first, answer.section.phase.last):
                for moment in nearest_moments(rule, answer, step, np.sort(rng.random(3))):
                    below = (
                        moment.clearance < rule.limits.warn,
                        moment.clearance < rule.limits.fail,
                        moment.touches,
                    )
                    for level, is_below in zip(LEVELS, below, strict=True):
                        inside = any(a <= moment.time <= b for a, b in spans[level])
                        assert inside or not is_below, (level, moment.time, moment.clearance)


def thinned(placed: PlacedRobot) -> PlacedRobot:
    """The robot with every twentieth of its samples."""
    asked = placed.trajectory
    kept = np.unique(np.append(np.arange(0, asked.n_steps, 20), asked.n_steps - 1))
    velocities = None if asked.velocities is None else asked.velocities[kept]
    table = Trajectory(asked.times[kept], asked.joint_names, asked.positions[kept], velocities)
    return replace(placed, trajectory=table)


def test_a_single_pose_below_a_level_is_told_without_a_warning_of_numpy():
    """A run of one step has no interval whose share a moment could be."""
    near = Obstacle(Body("post", cl.box((0.1, 0.1, 0.1))), at(0.96, 0.0, 0.5))
    posed = replace(sweeping([[0.0, 0.0]]), obstacles=(near,))
    with np.errstate(invalid="raise", divide="raise"):
        assert cl.check(posed).summary["verdict"] == "near"
