"""Delays and slow-downs: what no delay mends, a run that begins later with its path, and up to what was looked."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadTime
from clearance.gains.answer import gain
from clearance.gains.sentences import lines_of
from clearance.world.carry import Carry
from clearance.world.rules import Allowance
from clearance.world.timing import Timing, Window
from tests.gains.gantries import along_x, crossing, gantry, standing


def two(one, other, *obstacles, fail=0.05):
    """Two blocks along x and along y, each from a place to a place in one second."""
    first = along_x(gantry("one"), start=one[0], end=one[1])
    times = first.trajectory.times
    at = np.stack([0.0 * times, np.linspace(*other, len(times))], axis=1)
    second = cl.PlacedRobot(gantry("other"), cl.Trajectory(times, ("x", "y"), at))
    return cl.Case("two", (first, second), obstacles, cl.Limits(fail=fail))


def post(x, y):
    return standing("post", cl.box((0.1, 0.1, 1.0)), (x, y, 0.0))


REFUSED = {
    "both come to rest": (two((-1.0, 0.0), (-1.0, -0.12)), "they stand there whatever the delay"),
    "both begin": (two((0.0, 1.0), (-0.12, -1.0)), "they stand there whatever the delay"),
    "others": (two((5.0, 6.0), (-1.0, 1.0), post(0.12, 0.3)), "nothing of this change moves them"),
    "on the path": (two((-1.0, 1.0), (5.0, 6.0), post(-0.5, 0.12)), "its path leads there whatever"),
}  # fmt: skip


@pytest.mark.parametrize("slow_down", [False, True])
@pytest.mark.parametrize("name", REFUSED)
def test_where_no_delay_helps_it_is_said_at_once(name, slow_down):
    case, told = REFUSED[name]
    found = gain(case, "timing", robot="one", slow_down=slow_down)
    assert not found.kept and found.n_measured == 1 and found.size == 0.0
    lines = dict(lines_of(found))
    assert told in lines["blocked"] and "no change of this kind can" in lines["not kept"]
    assert "bound" not in lines


def test_where_a_window_ends_a_later_path_may_pass():
    case, _ = REFUSED["on the path"]
    rule = cl.Rule(("post", "*"), cl.Window(0.0, 0.4), fail=0.05)
    found = gain(replace(case, limits=cl.Limits(rules=(rule,))), "timing", robot="one")
    assert found.kept and 0.1 < found.size < 0.4
    assert ("measured", "self-collision not checked [CL531]") in [*lines_of(found)]


def test_a_run_that_begins_with_the_path_begins_later():
    """A part on a line that has no end is near the path's start when the run begins, and soon away."""
    table = cl.PoseTable(
        np.array([0.0, 0.2, 1.0]), np.array([[-1.0, 0.12, 0.0], [-1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]]),
        np.tile([0.0, 0.0, 0.0, 1.0], (3, 1)), Timing(after="loop"),
    )  # fmt: skip
    part = cl.Obstacle(cl.Body("part", cl.box((0.1, 0.1, 0.1))), moves=table)
    case = cl.Case("line", (along_x(gantry()),), (part,), cl.Limits(fail=0.1))
    found = gain(case, "timing")
    least = 0.08 / 4.4  # the part goes 0.88 m in 0.2 s, and 0.08 m are missing
    assert found.kept and found.lower_bound <= least <= found.size <= least + 2e-3


def handing(*obstacles, allow=()):
    """Two blocks that cross at the origin; one picks up a part above itself on its way along y, at 0.25 s."""
    part = standing("part", cl.box((0.04, 0.04, 0.04)), (0.0, -0.5, 0.2))
    carry = Carry("part", "other/tool", Window(0.25), touch=("other/*",))
    return replace(crossing(0.05), obstacles=(part, *obstacles), carries=(carry,), allow=allow)


@pytest.mark.slow
@pytest.mark.parametrize("slow_down", [False, True])
def test_a_part_is_picked_up_where_the_robot_is_there_later(slow_down):
    found = gain(handing(), "timing", robot="other", slow_down=slow_down)
    (carry,) = found.case.carries
    later = 0.25 * (1.0 + found.size) if slow_down else 0.25 + found.size
    assert found.kept and found.size > 0.0 and carry.window.start == pytest.approx(later, abs=1e-12)


def test_what_holds_from_0_on_holds_from_the_start_of_a_run_that_begins_later():
    """Both begin at 0.1 s, as where the first of two robots is delayed by the search."""
    later = tuple(replace(one, timing=Timing(0.1)) for one in handing().robots)
    holding = (Carry("part", "other/tool", Window(0.0)),)

    def run(start):
        rule = cl.Rule(("one/*", "other/*"), Window(start, 0.3), fail=0.05)
        case = replace(handing(), robots=later, carries=holding, limits=cl.Limits(rules=(rule,)))
        return cl.check(case).record

    from_0, since = (run(start) for start in (0.0, 0.1))
    assert from_0.clearances.tobytes() == since.clearances.tobytes()
    assert [(one.span, [*one.carried]) for one in from_0.timeline.phases] == [
        ((0.1, 0.3), ["part"]), ((0.3, 1.1), ["part"]),
    ]  # fmt: skip
    with pytest.raises(BadTime, match=r"0.05 s is outside the run"):
        run(0.05)


@pytest.mark.slow
def test_windows_that_a_delay_leaves_are_named_and_parts_that_change_hands_refused():
    row = Allowance(("one/*", "other/*"), Window(0.8, 0.9))
    lines = [*lines_of(gain(handing(allow=(row,)), "timing", robot="other"))]
    assert any(
        "allow[0] (from 0.8 s until 0.9 s) stays" in text
        for label, text in lines
        if label == "warning"
    )
    case = handing()
    first = replace(case.carries[0], window=Window(0.25, 0.5))
    handed = replace(case, carries=(first, Carry("part", "one/tool", Window(0.5))))
    with pytest.raises(cl.BadInput, match="'part' changes hands"):
        gain(handed, "timing", robot="other")


@pytest.mark.slow
def test_no_delay_takes_a_part_past_a_post_in_its_way(monkeypatch):
    """Without the post, the fifteenth delay that is tried keeps the rules."""
    monkeypatch.setattr("clearance.gains.delay.MOST_DELAYS", 40)
    post = standing("post", cl.box((0.02, 0.02, 0.02)), (0.0, 0.5, 0.2))
    found = gain(handing(post), "timing", robot="other")
    assert not found.kept and "part and post" in str(found.blocked)
    told = dict(lines_of(found))["not kept"]
    assert told == "no delay up to 60 s was found with which every rule holds"
