"""Where everything is at every step and between, by formulas by hand, and the move that a program makes then."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadInput, BadTime, UnknownLink, UnknownObstacle
from clearance.world.body import Mount, Obstacle
from clearance.world.carry import Carry
from clearance.world.forest import WORLD, forest_of, link_poses_at, positions_between
from clearance.world.made_moves import MadeMoves
from clearance.world.motion import kinematic_motion
from clearance.world.robot import Joint, JointKind
from clearance.world.timeline import timeline_of
from clearance.world.timing import Timing, Window
from clearance.world.trajectory import MoveSpan
from tests.cells import END, cell, pose_at

NAMES = (
    *(f"{robot}/{link}" for robot in ("left", "right", "track") for link in ("base", "boom", "tool")),
    "post", "door", "crate", "part", "lid",
)  # fmt: skip


def timeline(case):
    return timeline_of(case, [kinematic_motion(placed) for placed in case.robots])


def poses_in(phase, link_poses):
    """Of each of `NAMES` (4, 4) in a phase, of (links, 4, 4)."""
    forest = forest_of(phase.case)
    standing = {o.name: o.world_from_body for o in phase.case.obstacles}
    links = [forest.link_called(phase.case, name) for name in NAMES]
    return [
        standing[name] if link == WORLD else link_poses[link]
        for name, link in zip(NAMES, links, strict=True)
    ]


@pytest.mark.parametrize("seed", range(4))
def test_bodies_are_where_their_tables_and_hands_say(seed):
    case = cell(seed)
    line = timeline(case)
    assert [p.last for p in line.phases[:-1]] == [p.first for p in line.phases[1:]]
    for phase in line.phases:
        poses = link_poses_at(phase.case, phase.motions, slice(None))
        for k, t in enumerate(phase.times):
            left = k == phase.n_steps - 1
            expected = [pose_at(case, name, float(t), left=left) for name in NAMES]
            assert np.allclose(poses_in(phase, poses[k]), expected, rtol=0.0, atol=1e-9), t
        for k in range(phase.n_steps - 1):
            share = 0.37
            t = float(phase.times[k] + share * (phase.times[k + 1] - phase.times[k]))
            columns = positions_between(phase.case, phase.motions, k, share)
            between = forest_of(phase.case).poses(columns[None])[0]
            expected = [pose_at(case, name, t) for name in NAMES]
            assert np.allclose(poses_in(phase, between), expected, rtol=0.0, atol=1e-9), t


def test_what_is_absent_and_all_on_it_is_gone_before_and_after():
    case = cell(5)
    door = case.obstacles[1]
    moves = replace(door.moves, timing=Timing(1.0, 1.0, "absent"))
    case = replace(
        case,
        obstacles=(case.obstacles[0], replace(door, moves=moves), *case.obstacles[2:]),
        carries=(),
    )
    for phase in timeline(case).phases:
        gone = phase.span[1] <= 1.0 or phase.span[0] >= 1.0 + float(moves.times[-1])
        assert phase.absent_obstacles == (frozenset({1, 2}) if gone else frozenset())


def leaving(case, name):
    """The case without hands, in which the door or the second robot is in the cell for its table only."""
    absent = Timing(0.0, 1.0, "absent")
    robots, obstacles = list(case.robots), list(case.obstacles)
    if name == "door":
        obstacles[1] = replace(obstacles[1], moves=replace(obstacles[1].moves, timing=absent))
    else:
        robots[1] = replace(robots[1], timing=absent)
    return replace(case, robots=tuple(robots), obstacles=tuple(obstacles), carries=())


@pytest.mark.parametrize("until", [1.5, 2.0, 4.0])
def test_a_part_that_is_picked_up_in_the_cell_stays_in_it_beyond_its_table(until):
    case = leaving(cell(5), "door")  # its table ends at 2 s
    case = replace(case, carries=(Carry("door", "left/tool", Window(1.0, until)),))
    assert all(not phase.absent_obstacles for phase in timeline(case).phases)


def test_a_part_is_picked_up_where_its_table_ends_but_not_later():
    case = leaving(cell(5), "door")
    held = replace(case, carries=(Carry("door", "left/tool", Window(2.0)),))
    assert all(not phase.absent_obstacles for phase in timeline(held).phases)
    with pytest.raises(BadTime, match="'door' is not in the cell"):
        timeline(replace(case, carries=(Carry("door", "left/tool", Window(2.5)),)))


def test_a_part_leaves_with_what_carries_it():
    case = leaving(cell(5), "right")  # its table ends at 3 s
    case = replace(case, carries=(Carry("part", "right/tool", Window(1.0)),))
    for phase in timeline(case).phases:
        assert phase.absent_obstacles == (frozenset({3, 4}) if phase.span[0] >= 3.0 else set())


@pytest.mark.parametrize(
    ("window", "says"),
    [(Window(3.0), "picks up part 'part'"), (Window(3.5, 5.0), "picks up part 'part'"),
     (Window(1.0, 5.0), "lets go of part 'part'")],
)  # fmt: skip
def test_what_is_not_in_the_cell_neither_picks_up_nor_lets_go(window, says):
    case = leaving(cell(5), "right")
    case = replace(case, carries=(Carry("part", "right/tool", window),))
    with pytest.raises(BadTime, match=says):
        timeline(case)


@pytest.mark.parametrize(
    ("changes", "fault", "says"),
    [
        ({"carries": (Carry("part", "left/hand", Window(1.0)),)}, UnknownLink, "left/hand"),
        ({"carries": (Carry("prat", "left/tool", Window(1.0)),)}, UnknownObstacle, "did you mean 'part'"),
        ({"carries": (Carry("part", "left/tool", Window(END + 1.0)),)}, BadTime, "outside the run"),
    ],
)  # fmt: skip
def test_what_cannot_be_carried_is_refused(changes, fault, says):
    with pytest.raises(fault) as reported:
        timeline(replace(cell(1), **changes))
    assert says in str(reported.value) or fault is UnknownObstacle


def test_two_hands_at_once_are_refused():
    carries = (Carry("part", "left/tool", Window(1.0, 3.0)), Carry("part", "door", Window(2.0)))
    with pytest.raises(BadInput, match="at once"):
        replace(cell(1), carries=carries)


def test_actors_on_each_other_in_a_ring_are_refused():
    case = cell(1)
    left, right, track = case.robots
    ring = replace(track, world_from_base=np.eye(4), mount=Mount("right/tool"))
    with pytest.raises(BadInput, match="a ring"):
        forest_of(replace(case, robots=(left, right, ring), carries=()))
    crates = (
        Obstacle(case.obstacles[0].body, mount=Mount("crate")),
        replace(case.obstacles[2], mount=Mount("post")),
    )
    with pytest.raises(BadInput, match="a ring"):
        forest_of(replace(case, obstacles=crates, carries=()))


def test_what_loops_may_be_running_when_the_run_begins():
    case = cell(7)
    door = case.obstacles[1]
    period = float(np.ptp(door.moves.times))
    running = replace(door, moves=replace(door.moves, timing=Timing(-0.3 * period, 1.0, "loop")))
    case = replace(case, obstacles=(case.obstacles[0], running, *case.obstacles[2:]), carries=())
    line = timeline(case)
    assert line.times[0] == 0.0
    first = line.phases[0]
    poses = link_poses_at(first.case, first.motions, slice(0, 1))[0]
    expected = [pose_at(case, name, 0.0) for name in NAMES]
    assert np.allclose(poses_in(first, poses), expected, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("begins", [1.0, 0.0, -1.5, -40.0])
def test_a_run_lasts_once_through_each_table_that_loops(begins):
    case = cell(7)
    door = case.obstacles[1]
    period = 4.0 * END
    rate = float(np.ptp(door.moves.times)) / period
    slow = replace(door, moves=replace(door.moves, timing=Timing(begins, rate, "loop")))
    case = replace(case, obstacles=(case.obstacles[0], slow, *case.obstacles[2:]), carries=())
    times = timeline(case).times
    assert times[0] == 0.0
    assert times[-1] == pytest.approx(max(0.0, begins) + period)


SPANS = (MoveSpan("PTP 1", 0.0, 1.0), MoveSpan("LIN 2", 1.0, 1.0), MoveSpan("LIN 3", 1.0, 4.0))


def robot(name: str, timing: Timing, moves: tuple[MoveSpan, ...] = SPANS) -> cl.PlacedRobot:
    joint = Joint("axis", JointKind.REVOLUTE, "base", "arm", np.eye(4))
    body = cl.Body("arm", cl.box([1, 1, 1]))
    motion = cl.Trajectory(np.array([0.0, 4.0]), ("axis",), np.array([[0.0], [0.0]]), moves=moves)
    one = cl.Robot(name, ("base", "arm"), (joint,), (body,))
    return cl.PlacedRobot(one, trajectory=motion, timing=timing)


def made(*robots: cl.PlacedRobot) -> MadeMoves:
    return MadeMoves.of(cl.Case("cell", robots, (cl.Obstacle(cl.Body("post", cl.box([1, 1, 1]))),)))


@pytest.mark.parametrize(
    ("timing", "told"),
    [
        (Timing(), {-0.1: "", 0.0: "PTP 1", 1.0: "PTP 1", 1.1: "LIN 3", 4.0: "LIN 3", 4.1: ""}),
        (Timing(start=2.0, rate=2.0), {1.9: "", 2.5: "PTP 1", 2.6: "LIN 3", 4.0: "LIN 3", 4.1: ""}),
        (Timing(after="loop"), {4.0: "LIN 3", 4.5: "PTP 1", 7.0: "LIN 3", 12.5: "PTP 1"}),
    ],
)
def test_the_end_of_a_move_is_its_own_and_rounds_repeat(timing, told):
    moves = made(robot("one", timing))
    assert {time: moves.at(time) for time in told} == told
    codes, names = moves.codes(np.array([*told]))
    assert [names[code] if code >= 0 else "" for code in codes] == [*told.values()]


def test_each_robot_that_makes_a_move_is_named_and_one_without_a_program_is_not():
    moves = made(
        robot("left", Timing()), robot("right", Timing(start=3.0)), robot("still", Timing(), ())
    )
    assert made(robot("left", Timing()), robot("still", Timing(), ())).at(0.5) == "PTP 1"
    assert moves.at(0.5) == "left/PTP 1" and moves.at(3.5) == "left/LIN 3, right/PTP 1"
    assert (
        moves.over(0.5, 6.0) == "left/PTP 1 to right/LIN 3"
        and moves.over(5.0, 6.0) == "right/LIN 3"
    )


def test_rows_have_their_moves_at_every_depth_and_none_without_a_program():
    told = {"rows": [{"time": 0.5}, {"time": None}, {"a": {"start": 0.5, "end": 2.0}}], "end": 4.0}
    named = made(robot("one", Timing())).named(told)
    first, second, third = named["rows"]
    assert first == {"time": 0.5, "move": "PTP 1"} and second == {"time": None}
    assert third["a"]["moves"] == "PTP 1 to LIN 3" and "move" not in named
    assert MadeMoves().named(told) is told
