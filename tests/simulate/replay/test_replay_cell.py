"""The replay of a cell in which everything moves: bodies are where hands, tables and carriers put them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.simulate.replay.replay import replay_of
from clearance.world.carry import Carry
from clearance.world.timing import Timing, Window
from tests.gains.gantries import crossing, slot
from tests.made_cases import at
from tests.report.cells import box, cell, sliding, table_of


@pytest.fixture(scope="module")
def run():
    return cl.check(cell())


@pytest.fixture(scope="module")
def record(run):
    return run.record


@pytest.fixture(scope="module")
def replay(run):
    return replay_of(run.session)


def frame_at(replay, time: float) -> int:
    return int(np.argmin(np.abs(replay.times - time) + replay.between))


def place(replay, name: str, time: float) -> list[float]:
    """(3,) where a body is drawn at a time."""
    (i,) = [i for i, body in enumerate(replay.bodies) if body.name == name]
    poses = replay.poses[i]
    return poses[frame_at(replay, time) if len(poses) > 1 else 0, :3].tolist()


def shown(replay, name: str) -> list[float]:
    """The times at which a body is drawn."""
    (i,) = [i for i, body in enumerate(replay.bodies) if body.name == name]
    flags = np.broadcast_to(replay.shown[i], len(replay.times))
    return sorted(set(replay.times[flags == 1].tolist()))


@pytest.mark.parametrize(
    ("name", "time", "expected"),
    [
        ("left/tool", 1, [1, 0, 0.5]),
        ("right/tool", 2, [1.2355, 0, 0.5]),
        ("part", 0, [1.16, 0, 0.5]),
        ("part", 2, [1.16, 0, 0.5]),
        ("part", 3, [1.16 + 3 - 1.2355, 0, 0.5]),
        ("part", 4, [1.16 + 3 - 1.2355, 0, 0.5]),
        ("door", 2, [1.4, 0.5, 0.6]),
        ("cart", 2, [0.9, -1, 0.2]),
        ("crate", 2, [0.9, -1, 0.37]),
        ("fence", 2, [-0.104, 0, 0.6]),
    ],
)
def test_every_body_is_where_its_carrier_or_its_table_puts_it(replay, name, time, expected):
    assert place(replay, name, time) == pytest.approx(expected, abs=1e-6)


def test_what_is_absent_is_hidden_and_so_is_what_stands_on_it(replay):
    everything = sorted(set(replay.times.tolist()))
    assert shown(replay, "cart") == shown(replay, "crate")
    assert min(shown(replay, "cart")) == 1.0 and max(shown(replay, "cart")) < 4.0
    assert shown(replay, "door") == everything


def test_the_replay_knows_who_holds_what_and_what_judges_each_frame(replay):
    hands = [(one.part, one.by, one.start, one.end) for one in replay.carries]
    assert hands == [("part", "left/tool", 1.0, 2.0), ("part", "right/tool", 2.0, 4.0)]
    names = [replay.bodies[one.i_by].name for one in replay.carries]
    assert names == ["left/tool", "right/tool"]
    assert replay.rules[replay.rule[replay.i_worst]].name == "fence"
    kinds = {body.name: body.kind for body in replay.bodies}
    assert (kinds["part"], kinds["door"], kinds["crate"]) == ("part", "moving", "moving")


def test_the_line_ends_on_the_bodies_drawn(record, replay):
    """Also at the step at which something goes, where the row can be of what is there until then."""
    for i in range(len(replay.times)):
        for k, end in zip(replay.nearest[i], replay.lines[i].reshape(2, 3), strict=True):
            flags = replay.shown[k]
            assert flags[i if len(flags) > 1 else 0], replay.bodies[k].name
            poses = replay.poses[k]
            low, high = (
                np.array([-1, 1])[:, None]
                * np.ptp(replay.shapes[replay.bodies[k].i_shape][0], axis=0)
                / 2
            )
            inside = end - poses[i if len(poses) > 1 else 0, :3]
            assert (inside > low - 1e-6).all() and (inside < high + 1e-6).all()


def test_moments_between_steps_are_drawn_where_things_are_then():
    """The cart passes below the tool between two steps; the part it carries goes with it."""
    robots = (sliding("left", [(0, 0), (1, 0)]), sliding("right", [(0, 3), (1, 3)]))
    obstacles = (
        box("cart", (0.2, 0.2, 0.2), moves=table_of([(0, -1, 0.0, 0.2), (1, 1.5, 0.0, 0.2)])),
        box("part", (0.1, 0.1, 0.1), at(-1, 0, 0.38)),
    )
    carries = (Carry("part", "cart", Window(0.0)),)
    run = cl.check(cell((), robots, obstacles, carries))
    record, replay = run.record, replay_of(run.session)
    assert record.worst.between
    i = replay.i_worst
    assert replay.between[i] and replay.times[i] == record.worst.time
    share = record.worst.time
    (part,) = [k for k, body in enumerate(replay.bodies) if body.name == "part"]
    assert replay.poses[part][i, :3] == pytest.approx([-1 + 2.5 * share, 0, 0.38], abs=1e-6)


def test_a_robot_that_comes_and_goes_is_hidden_before_and_after():
    robots = (
        sliding("left", [(0, 0), (3, 0)]),
        sliding("right", [(1, 3), (2, 1)], timing=Timing(after="absent")),
    )
    replay = replay_of(cl.check(cell((), robots, (box("table", (4, 4, 0.1)),), ())).session)
    assert shown(replay, "right/tool")[0] == 1.0
    assert max(shown(replay, "right/tool")) <= 2.0


@pytest.mark.parametrize("after", ["absent", "loop"])
def test_a_step_at_which_something_goes_shows_what_was_nearest_until_then(after):
    """The cart comes to 10 mm from the tool at 2 s, and is gone, or back where it began, from then on."""
    robots = (sliding("left", [(0, 0), (4, 0)]), sliding("right", [(0, 3), (4, 3)]))
    ways = table_of([(0, 0.5, 0, 0.5), (2, 0.11, 0, 0.5)], after=after)
    obstacles = (box("cart", (0.1, 0.1, 0.1), moves=ways), box("table", (4, 4, 0.1)))
    replay = replay_of(cl.check(cell((), robots, obstacles, ())).session)
    assert replay.times[replay.i_worst] == 2.0
    assert 2.0 in shown(replay, "cart")
    assert place(replay, "cart", 2.0) == pytest.approx([0.11, 0, 0.5], abs=1e-6)
    assert replay.clearances[replay.i_worst] == pytest.approx(0.01)


def session_of(case):
    return cl.check(case, certify=False).session


def test_only_what_was_elsewhere_is_drawn_twice():
    case = slot()
    base = np.eye(4)
    base[1, 3] = -0.01
    moved = replace(case.robots[0], world_from_base=base)
    after = replay_of(session_of(replace(case, robots=(moved,))))
    (body,) = session_of(case).earlier_motion(after)
    assert after.bodies[body.i_body].name == "tool" and body.shown.all()
    assert body.poses[:, 1] == pytest.approx(after.poses[body.i_body][:, 1] + 0.01, abs=1e-6)
    assert not session_of(case).earlier_motion(replay_of(session_of(case)))


def test_a_run_that_ended_earlier_stands_at_its_end():
    """One of two that cross begins a second later: at each moment it was where it is a second later."""
    case = crossing()
    late = replace(case.robots[0], timing=replace(case.robots[0].timing, start=1.0))
    after = replay_of(session_of(replace(case, robots=(late, case.robots[1]))))
    (body,) = session_of(case).earlier_motion(after)
    expected = np.interp(after.times, [0.0, 1.0], [-1.0, 1.0])
    assert body.poses[:, 0] == pytest.approx(expected, abs=1e-6)
