"""The paths of two robots that are changed together: each gives way by half of what is missing."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput
from clearance.gains.answer import gain
from clearance.gains.sentences import lines_of
from tests.gains.gantries import along_x, gantry, slot, standing
from tests.made_cases import at

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
    case = replace(case, obstacles=(posts[0], standing("high", post, (0.0, 0.63, 0.0))))
    found = gain(case, "waypoints", robot=BOTH)
    assert found.kept and found.size == pytest.approx(2.0 * 0.01, abs=1e-6)


@pytest.mark.parametrize(
    "kind, how, told",
    [
        ("waypoints", {"robot": BOTH, "keep_tool": [(0.5, 0.1, 0.1)]}, "2 robots are named"),
        ("waypoints", {"robot": ("one", "otter")}, "did you mean 'other'"),
    ],
)
def test_several_robots_where_one_is_meant(kind, how, told):
    with pytest.raises(BadInput, match=told):
        gain(side_by_side(), kind, **how)


def beside_a_bar(angle):
    """A block goes along x at y = 0; the face of a long bar is 0.05 before it, less at one end by its angle."""
    c, s = np.cos(angle), np.sin(angle)
    turned = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    pose = at(-0.1 * s, 0.1 + 0.1 * c, turned=turned)  # the middle of its face stays
    bar = cl.Obstacle(cl.Body("bar", cl.box((2.0, 0.2, 0.2))), pose)
    path = along_x(gantry(), start=-0.9, end=0.9)
    return cl.Case("bar", (path,), (bar,), cl.Limits(fail=0.045))


def test_a_turn_and_a_shift_share_what_is_missing():
    case = beside_a_bar(0.02)
    shifted, turned = (cl.gain(case, "obstacle", turn=turn) for turn in (None, "z"))
    assert turned.kept and turned.size < 0.75 * shifted.size and np.all(turned.change[[1, 3]])


def test_a_box_is_kept_and_what_is_beyond_it_is_said():
    found = cl.gain(slot(), "base", within=(0.001, 0.019, 0.001))
    assert (
        not found.kept and found.n_measured == 1 and "within what is allowed" in str(found.blocked)
    )
    assert cl.gain(slot(), "base", within=(0.0, (-0.021, 0.0), 0.0)).kept
