"""The paths of two robots that are changed together: each gives way by half of what is missing."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.gains.answer import gain
from clearance.gains.sentences import lines_of
from tests.gains.gantries import along_x, gantry, standing

BOTH = ("one", "other")


def side_by_side(fail=0.04):
    """Two blocks that go along x beside each other, 20 mm apart."""
    robots = (along_x(gantry("one")), along_x(gantry("other"), y=0.12))
    return cl.Case("beside", robots, (), cl.Limits(fail=fail))


def test_each_gives_way_by_half():
    alone = gain(side_by_side(), "waypoints", robot="one", keep_ends=False)
    both = gain(side_by_side(), "waypoints", robot=BOTH, keep_ends=False)
    assert alone.kept and both.kept and both.after.passed
    assert alone.size == pytest.approx(2.0 * 0.02, abs=1e-6)
    assert both.size == pytest.approx(2.0 * 0.01, abs=1e-6)
    assert both.who == "one, other" and len(both.change) == 2
    assert [np.sign(one[20, 1]) for one in both.change] == [-1.0, 1.0]
    assert 0.0 < both.lower_bound <= both.size
    changed = [line for label, line in lines_of(both) if label == "changed"]
    assert [line.split(" by")[0] for line in changed] == ["joint one/y", "joint other/y"]


def test_what_each_of_two_must_mend_takes_both():
    post = cl.box((0.1, 0.1, 1.0))
    posts = (standing("low", post, (0.0, -0.12, 0.0)), standing("high", post, (0.0, 0.62, 0.0)))
    robots = (along_x(gantry("one")), along_x(gantry("other"), y=0.5))
    case = cl.Case("posts", robots, posts, cl.Limits(fail=0.03))
    for name in BOTH:
        found = gain(case, "waypoints", robot=name)
        assert not found.kept and "nothing of this change moves them" in str(found.blocked)
    found = gain(case, "waypoints", robot=BOTH)
    assert found.kept and found.size == pytest.approx(2.0 * 0.01, abs=1e-6)


@pytest.mark.slow
def test_a_moment_is_kept_only_where_all_that_moves_the_pair_is_still():
    first = along_x(gantry("one"), end=0.0)
    passing = replace(along_x(gantry("other"), start=-3.0, y=0.12), timing=cl.Timing(-0.5))
    case = cl.Case("passing", (first, passing), (), cl.Limits(fail=0.04))
    found = gain(
        case, "waypoints", robot=BOTH
    )  # at 0 s the first begins, as the other is beside it
    assert found.kept and found.change[1][:, 1].max() == pytest.approx(0.02, abs=1e-3)
    found = gain(side_by_side(), "waypoints", robot=BOTH)
    assert not found.kept and found.blocked.why == "that moment is to be kept"


@pytest.mark.parametrize(
    "kind, how, told",
    [
        ("base", {"robot": BOTH}, "2 robots are named, of which one is changed"),
        ("waypoints", {"robot": BOTH, "keep_tool": [(0.5, 0.1, 0.1)]}, "2 robots are named"),
        ("waypoints", {"robot": ("one", "one")}, "a robot is named twice"),
        ("waypoints", {"robot": ("one", "otter")}, "did you mean 'other'"),
    ],
)
def test_several_robots_where_one_is_meant(kind, how, told):
    with pytest.raises(BadInput, match=told):
        gain(side_by_side(), kind, **how)
