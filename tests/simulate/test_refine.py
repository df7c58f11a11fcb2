"""A proof goes on where a decision hangs on it; what is at a limit but for rounding keeps it, and says so."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.report.junit_cases import results_of
from clearance.simulate import refine
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, PlacedRobot
from clearance.world.robot import Joint, JointKind, Robot
from clearance.world.trajectory import Trajectory
from tests.made_cases import at
from tests.simulate.test_between_steps import LIMITS, THROUGH, sweeping

TOP = 0.48
"""[m] How high the fore arm's lower side is, so that a post of TOP - d leaves d below it."""


def sliding(gap: float, limits: cl.Limits = LIMITS) -> Case:
    """A cube of 0.1 m slides along a wall that is `gap` [m] beside it."""
    slide = Joint(
        "slide", JointKind.PRISMATIC, "base", "cube", at(), np.array([1.0, 0.0, 0.0]), -3, 3
    )
    body = Body("cube", cl.box((0.1, 0.1, 0.1)))
    robot = Robot("slider", ("base", "cube"), (slide,), (body,))
    asked = Trajectory(np.arange(3.0), ("slide",), np.array([[0.0], [0.3], [0.5]]))
    wall = Obstacle(Body("wall", cl.box((4.0, 0.1, 1.0))), at(0.0, 0.1 + gap, 0.0))
    return Case("slide", (PlacedRobot(robot, asked),), (wall,), limits)


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
    first = next(results_of(run.record, run.verdict))
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


def test_a_limit_that_takes_more_than_its_share_of_work_stays_undecided(monkeypatch):
    monkeypatch.setattr(refine, "MOST_QUERIES", 100)
    run = cl.check(passing(0.005))
    assert (run.status, run.passed) == ("violated", False)
    assert "undecided" in run.verdict.unproven
    assert run.certificate.tally["queries"] < 10_000


def test_what_nothing_hangs_on_is_not_proven_again(monkeypatch):
    clear = cl.check(passing(0.03))
    monkeypatch.setattr(refine, "MOST_QUERIES", -1)
    assert cl.check(passing(0.03)).certificate.tally == clear.certificate.tally
