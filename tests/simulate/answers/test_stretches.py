"""What is below a level, and the least of each pair, are those of the motion, however coarse the samples are."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.record.levels import LEVELS
from clearance.record.record import PairMinimum
from clearance.record.table import Names
from clearance.report.topics.pairs import PairJudge
from clearance.simulate.answers import intervals as listed
from clearance.simulate.answers import motion_minima as room
from clearance.simulate.answers.intervals import events, extent, intervals, not_listed
from clearance.simulate.answers.pairs_alone import near_alone
from clearance.simulate.answers.stretches import joined_spans
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.robot import JointKind
from clearance.world.rules import Rule
from clearance.world.trajectory import Trajectory
from tests.made_cases import at, driven, resampled
from tests.report.made import run_of as made_run
from tests.report.records import record, with_steps
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


def test_a_single_pose_below_a_level_is_told_without_a_warning_of_numpy():
    """A run of one step has no interval whose share a moment could be."""
    near = Obstacle(Body("post", cl.box((0.1, 0.1, 0.1))), at(0.96, 0.0, 0.5))
    posed = replace(sweeping([[0.0, 0.0]]), obstacles=(near,))
    with np.errstate(invalid="raise", divide="raise"):
        assert cl.check(posed).summary["verdict"] == "near"


def two_posts(post: float = PAST) -> Case:
    """The arm passes 3 mm above the first post, and 4 mm above another beside it a little later."""
    one = sweeping(THROUGH, post)
    other = Obstacle(Body("other", cl.box((0.05, 0.05, 0.476))), at(0.745, 0.06, 0.238))
    return replace(one, obstacles=(*one.obstacles, other))


def statuses(case: Case) -> dict[tuple[str, str], tuple[float, str]]:
    """The least clearance [m] and the status of each pair."""
    run = cl.check(case)
    judge = PairJudge.of(run.record)
    return {
        (one.link, one.obstacle): (one.clearance, judge.status_of(one))
        for one in run.session.motion_minima()
    }


def test_a_pair_that_another_hides_has_a_finding_and_a_row_of_its_own():
    run = cl.check(two_posts())
    assert {one.body_b for one in run.findings if one.broken} == {"post", "other"}
    nearest = run.session.motion_minima(2)
    assert [one.obstacle for one in nearest] == ["post", "other"]
    assert nearest[1].between and 0.0038 < nearest[1].proven <= nearest[1].clearance < 0.0041
    sampled = {one.obstacle: one.clearance for one in run.pair_minima}
    assert sampled["other"] > 0.5


def test_a_pair_that_comes_near_and_stays_above_is_left_out(monkeypatch):
    """As the second of two arms that mirror each other: both are near, and one is nearer than the samples."""
    session = cl.check(two_posts()).session
    every = {place for answer in session.rules[0].pairs.answers for place in answer.section.places}
    monkeypatch.setattr(room, "near_between", lambda *_: every)
    assert [one.obstacle for one in session.motion_minima(1)] == ["post"]


@pytest.mark.parametrize("fail", [0.0, 0.0029])
def test_the_least_of_the_nearest_pair_is_that_of_the_run(fail):
    """From samples half a metre away, a hundredth of the samples' clearance is more than the dip is deep."""
    case = sweeping(THROUGH, PAST)
    run = cl.check(replace(case, limits=cl.Limits(fail=fail)))
    (nearest,) = run.session.motion_minima(1)
    assert nearest.clearance == run.record.worst.clearance
    assert nearest.proven <= nearest.clearance < nearest.proven + 2e-4


def test_what_is_proven_of_each_pair_is_never_above_many_samples():
    case = sweeping(TWICE, 0.47)
    session, dense = cl.check(case).session, cl.check(finer(case, 2000), certify=False)
    least = {(one.link, one.obstacle): one.clearance for one in dense.pair_minima}
    for one in session.motion_minima():
        assert one.proven <= least[one.link, one.obstacle] <= one.clearance + 1e-12


def test_no_pair_is_proven_less_than_its_rule():
    """Far pairs are proven to a hundredth of their clearance, the rule to a tenth of a millimetre."""
    run = cl.check(replace(sweeping(TWICE, 0.47), limits=cl.Limits(fail=0.0)))
    least = run.record.certificate.lower_bound.min()
    assert all(one.proven >= least for one in run.session.motion_minima())


def test_where_pairs_are_too_many_those_that_are_far_are_of_the_samples(monkeypatch):
    monkeypatch.setattr(room, "MOST_INTERVALS", 0)
    minima = cl.check(two_posts()).session.motion_minima()
    found = {one.obstacle: one for one in minima if one.link == "fore"}
    assert found["other"].proven is not None and found["wall"].proven is None


def test_where_no_pair_can_be_proven_by_itself_those_that_the_proof_saw_nearest_stand_so(
    monkeypatch,
):
    """As between two clocks: a finding said violated, and the table of pairs clear."""
    monkeypatch.setattr(room, "can_be_alone", lambda *_: False)
    found = statuses(two_posts())
    assert found["fore", "post"] == (pytest.approx(0.003, abs=1.1e-4), "violated")
    assert found["fore", "other"][1] == "clear"  # hidden by the first


def test_a_pair_alone_has_the_certificate_of_the_rule_where_it_is_the_nearest():
    rule = cl.check(sweeping(TWICE, PAST)).session.rules[0]
    for pair, answer in near_alone(rule, 0.02).items():
        own = rule.certificate.pair == pair
        assert np.array_equal(
            answer.certificate.upper_bound[own], rule.certificate.upper_bound[own]
        )
        assert (answer.certificate.lower_bound >= rule.certificate.lower_bound).all()


@pytest.mark.parametrize(("padding", "off"), [(0.018, 4.042974363421338e-08), (0.003, 1e-8)])
def test_a_padded_pair_in_contact_is_in_contact_whatever_paths_are_off(padding, off):
    """A distance of 0 less both; added to it one after the other they leave 1e-18 m."""
    clearance = 0.0 - (padding + off)
    minimum = PairMinimum("fore", "post", clearance, 0, 0.0, (0.0,) * 3, (0.0,) * 3)
    judge = PairJudge({minimum.rule: cl.Limits()}, {"post": padding}, off)
    assert judge.status_of(minimum) == "contact"
    apart = replace(minimum, clearance=1e-12 + clearance)
    assert judge.status_of(apart) == "violated"


GAPS = [0.03, 0.018, 0.004, 0.0, 0.0, 0.003, 0.012, 0.05, 0.015]
LETTERS = "c n v x x v n c n"


def session_of(letters: str, gaps: list[float]):
    made = record(n_steps=len(gaps))
    codes = np.array(["cnvx".index(letter) for letter in letters.split()])
    status = Names(codes, ["clear", "near", "violated", "contact"])
    steps = made.rows.with_columns({"clearance": np.array(gaps), "status": status})
    return made_run(with_steps(made, steps)).session


def test_intervals_by_hand():
    run = session_of(LETTERS, GAPS)
    found = intervals(run)
    spans = {
        level: [(i.first_step, i.last_step, i.worst_step) for i in some]
        for level, some in found.items()
    }
    assert spans == {
        "below_warn": [(1, 6, 3), (8, 8, 8)],
        "below_fail": [(2, 5, 3)],
        "contact": [(3, 4, 3)],
    }
    (below,), times = found["below_fail"], run.record.steps["time"].to_pylist()
    assert (below.start, below.end, below.clearance) == (times[2], times[5], 0.0)


WARN, FAIL, TOUCH = (
    ("warn limit entered", "warn limit left"),
    ("fail limit entered", "fail limit left"),
    ("contact begins", "contact ends"),
)


@pytest.mark.parametrize(
    ("letters", "gaps", "expected"),
    [
        (LETTERS, GAPS, [(1, WARN[0]), (2, FAIL[0]), (3, TOUCH[0]), (5, TOUCH[1]), (6, FAIL[1]), (7, WARN[1]),
                         (8, WARN[0])]),
        ("c x c", [0.1, 0.0, 0.1], [(1, WARN[0]), (1, FAIL[0]), (1, TOUCH[0]), (2, TOUCH[1]), (2, FAIL[1]),
                                    (2, WARN[1])]),
    ],
    ids=["one by one", "all levels at once"],
)  # fmt: skip
def test_events_enter_the_widest_level_first_and_leave_the_deepest_first(letters, gaps, expected):
    found = [(event.step, event.what) for event in events(session_of(letters, gaps))]
    assert found == expected


def test_events_tell_the_least_until_the_level_is_left():
    told = {(event.step, event.what): event.least for event in events(session_of(LETTERS, GAPS))}
    assert told[1, "warn limit entered"] == told[2, "fail limit entered"] == 0.0
    assert told[8, "warn limit entered"] == 0.015
    assert told[7, "warn limit left"] is None


def test_a_run_that_never_rests_lists_its_first_intervals_and_says_how_many_more(monkeypatch):
    whole = session_of(LETTERS, GAPS)
    all_events, all_intervals = events(whole), intervals(whole)
    assert set(not_listed(whole).values()) == {0}
    monkeypatch.setattr(listed, "MOST_LISTED", 1)
    assert events(whole) == all_events[:1]
    assert intervals(whole) == {level: found[:1] for level, found in all_intervals.items()}
    assert not_listed(whole) == {"below_warn": 1, "below_fail": 0, "contact": 0, "events": 6}
    assert extent(whole, "below_warn") == (2, 7)
