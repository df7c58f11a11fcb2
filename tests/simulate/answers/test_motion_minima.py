"""The least of each pair is of the motion, however coarse the samples; none is hidden by a nearer one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.record.record import PairMinimum
from clearance.report.topics.pairs import PairJudge
from clearance.simulate.answers import motion_minima as room
from clearance.simulate.answers.pairs_alone import near_alone
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from tests.made_cases import at
from tests.simulate.answers.test_stretches import TWICE, finer
from tests.simulate.measure.test_between_steps import PAST, THROUGH, sweeping


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


@pytest.mark.slow
@pytest.mark.parametrize("case", [two_posts(), sweeping(TWICE, 0.47), sweeping(TWICE)])
def test_pairs_stand_as_at_a_hundred_times_as_many_samples(case):
    coarse, fine = statuses(case), statuses(finer(case, 100))
    assert coarse.keys() == fine.keys()
    for pair, (clearance, status) in coarse.items():
        assert status == fine[pair][1]
        assert clearance == pytest.approx(fine[pair][0], rel=0.01, abs=1.1e-4)


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
