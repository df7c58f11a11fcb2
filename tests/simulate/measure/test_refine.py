"""A proof goes on where a decision hangs on it; what is at a limit but for rounding keeps it, and says so."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.report.junit_cases import results_of
from clearance.simulate.measure import refine
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case
from clearance.world.robot import JointKind
from tests.made_cases import at, driven
from tests.simulate.measure.test_between_steps import LIMITS, THROUGH, sweeping
from tests.simulate.measure.wandering import case_of

TOP = 0.48
"""[m] How high the fore arm's lower side is, so that a post of TOP - d leaves d below it."""


def sliding(gap: float, limits: cl.Limits = LIMITS) -> Case:
    """A cube of 0.1 m slides along a wall that is `gap` [m] beside it."""
    cube = driven(cl.box((0.1, 0.1, 0.1)), JointKind.PRISMATIC, [0.0, 0.3, 0.5], axis=(1, 0, 0))
    wall = Obstacle(Body("wall", cl.box((4.0, 0.1, 1.0))), at(0.0, 0.1 + gap, 0.0))
    return Case("slide", (cube,), (wall,), limits)


def passing(gap: float, limits: cl.Limits = LIMITS) -> Case:
    """An arm that sweeps over a post, `gap` [m] above it half way and nowhere nearer."""
    return sweeping(THROUGH, post_height=TOP - gap, limits=limits)


@pytest.mark.parametrize("made", [sliding, pytest.param(passing, marks=pytest.mark.slow)])
@pytest.mark.parametrize(("limit", "status"), [("fail", "near"), ("warn", "clear")])
def test_a_gap_that_is_as_wide_as_its_limit_keeps_it(made, limit, status):
    gap = getattr(LIMITS, limit)
    run = cl.check(made(gap))
    limits = run.record.rules[0].limits
    assert (run.status, run.passed, run.verdict.unproven) == (status, True, None)
    assert gap - limits.rounding <= run.certificate.lower_bound.min() <= run.worst["clearance"]
    assert 0.0 < limits.rounding < 2e-11
    told = f"equal to the {limit} limit but for rounding"
    assert told in run.verdict.at_level and run.summary["at_level"] == run.verdict.at_level
    first = next(results_of(run.report))
    assert told in first.text and not first.fault


@pytest.mark.parametrize("made", [sliding, passing])
@pytest.mark.parametrize(
    ("off", "status"), [(-1e-10, "violated"), (1e-9, "near"), (-1e-6, "violated"), (5e-5, "near")]
)
def test_what_is_a_tenth_of_a_nanometre_off_its_limit_is_decided(made, off, status):
    if made is passing and off == 1e-9:
        off = 2e-8  # a dip that is as near its limit takes seconds
    run = cl.check(made(0.005 + off))
    assert (run.status, run.verdict.unproven, run.verdict.at_level) == (status, None, "")


@pytest.mark.parametrize("gap", [0.0123, 0.0777])
def test_the_least_clearance_is_proven_to_a_thousandth_of_a_millimetre_whatever_gap_is_allowed(gap):
    run = cl.check(passing(gap), certify_gap=1e-3)
    lower = run.certificate.lower_bound.min()
    assert gap - 1.001 * refine.LEAST_GAP <= lower <= gap
    assert gap - 1e-12 <= run.worst["clearance"] <= gap + refine.LEAST_GAP


def test_what_is_seen_below_the_least_clearance_is_proven_as_finely():
    certificate = cl.check(case_of(11, 2), certify_gap=1e-2).certificate
    seen = certificate.upper_bound.min()
    assert seen - refine.LEAST_GAP <= certificate.lower_bound.min() <= seen
    assert certificate.tally["queries"] < 1000


def test_a_limit_that_takes_more_than_its_share_of_work_stays_undecided(monkeypatch):
    monkeypatch.setattr(refine, "MOST_QUERIES", 100)
    run = cl.check(passing(0.005))
    assert (run.status, run.passed) == ("violated", False)
    assert "undecided" in run.verdict.unproven
    assert run.certificate.tally["queries"] < 10_000


def turning(off: float, limits: cl.Limits) -> Case:
    """A plate turns a corner past a wall twice, `off` [m] beyond the fail limit both times."""
    plate = driven(cl.box((0.6, 0.08, 0.05)), JointKind.REVOLUTE, [-1.0, 1.3])
    away = float(np.hypot(0.3, 0.04)) + limits.fail + off
    wall = Obstacle(Body("wall", cl.box((0.1, 2.0, 1.0))), at(away + 0.05))
    return Case("turn", (plate,), (wall,), limits)


@pytest.mark.slow
@pytest.mark.parametrize("off", [1e-8, 1e-9])
def test_bodies_that_pass_at_a_few_nanometres_are_proven_apart(off):
    run = cl.check(turning(off, cl.Limits()))
    assert (run.status, run.verdict.unproven, run.verdict.at_level) == ("clear", None, "")
    assert 0.0 < run.certificate.lower_bound.min() <= off
    assert not any(run.session.intervals.values())


def test_contact_that_is_neither_seen_nor_excluded_is_not_clear(monkeypatch):
    monkeypatch.setattr(refine, "MOST_QUERIES", -1)
    run = cl.check(turning(1e-8, cl.Limits()))
    assert (run.status, run.passed) == ("violated", False)
    assert "not proven to stay out of contact" in run.verdict.unproven
    assert [one.kind for one in run.findings if one.broken] == ["unproven"]


@pytest.mark.slow
def test_what_touches_but_for_rounding_says_so_and_has_no_stretch_of_contact():
    run = cl.check(sliding(1e-13, cl.Limits()))
    assert (run.status, run.passed) == ("clear", True)
    assert run.verdict.at_level.startswith("touches but for rounding (")
    assert not any(run.session.intervals.values())
    assert cl.check(sliding(-1e-15, cl.Limits())).status == "contact"


def test_what_is_at_its_limit_all_the_way_takes_little_work_and_is_not_called_kept():
    """A plate turns 0.2 m below a bar."""
    case = turning(1.0, cl.Limits(0.2))
    bar = Obstacle(Body("bar", cl.box((0.1, 0.2, 0.05))), at(0.25, 0.0, 0.25))
    run = cl.check(replace(case, obstacles=(bar,)))
    assert (run.status, run.verdict.at_level) == ("violated", "")
    assert "undecided" in run.verdict.unproven
    assert run.certificate.tally["queries"] < 20_000
