"""Which bodies move by one clock."""

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadDimension
from clearance.world.body import Mount
from clearance.world.carry import Carry
from clearance.world.case import Clock
from clearance.world.clocks import NO_CLOCK, clocks_of
from clearance.world.forest import owner_of
from clearance.world.plausibility import notices_of
from clearance.world.rules import Rule
from clearance.world.timing import Window
from tests.formats.making_cell import load_cell


def body(name: str) -> cl.Body:
    return cl.Body(name, cl.box([1, 1, 1]))


def robot(name: str, on: str | None = None, link: str = "base") -> cl.PlacedRobot:
    mount = None if on is None else Mount(on)
    return cl.PlacedRobot(cl.Robot(name, (link,), (), (body(link),)), mount=mount)


def case(*robots: cl.PlacedRobot, carries: tuple[Carry, ...] = ()) -> cl.Case:
    obstacles = tuple(cl.Obstacle(body(name)) for name in ("table", "part", "tray"))
    return cl.Case("cell", robots, obstacles, carries=carries, clock=Clock(np.inf))


def test_two_robots_on_one_standing_table_keep_their_own_clocks():
    clocks = clocks_of(case(robot("left", "table"), robot("right", "table")))
    assert clocks[False, 0] != clocks[False, 1]
    assert clocks[True, 0] == NO_CLOCK


def test_a_part_on_a_carried_tray_has_the_clock_of_what_carries_both():
    carries = (Carry("part", "tray", Window(0)), Carry("tray", "left/base", Window(0)))
    clocks = clocks_of(case(robot("left"), robot("right"), carries=carries))
    assert clocks[True, 1] == clocks[True, 2] == clocks[False, 0]
    assert clocks[True, 0] == NO_CLOCK


def test_a_link_may_have_a_stroke_in_its_name():
    assert owner_of(case(robot("arm", link="tool/base")), Mount("tool/base")) == (False, 0)


@pytest.mark.parametrize("level", [-0.001, np.nan, np.inf, "5 mm"])
def test_a_rule_has_levels_like_limits(level):
    with pytest.raises(BadDimension):
        Rule(("a", "b"), fail=level)


EPOCH = 1750851666.25
PATH = "time,shoulder\n{0},0\n{1},0.5\n"
REPORTED = (
    "CHECK CLOCKS: obstacle 'door' moves from 0 to 1 s, robot 'left' moves from 1750851666.25 to 1750851667.25 s: "
    "they never move together; do their times come from one clock? If so, give the later table a `start:`, or the "
    "earlier one `after: hold`"
)


def cell(folder, start, *changes, **files):
    """The door moves from 0 to 1 s, and the left arm for a second from `start` on."""
    windows = ("from: 0.25, until: 0.75", f"from: {start + 0.25}, until: {start + 0.75}", "from: 0.5, until: 1",
               f"from: {start}", "until: 0.5", f"until: {start + 0.5}")  # fmt: skip
    path = PATH.format(repr(start), repr(start + 1.0))
    return load_cell(folder, *windows, *changes, trajectory=path, **files)


def reported(case):
    return [notice.text for notice in notices_of(case) if notice.kind == "clocks"]


def test_an_arm_by_the_clock_on_the_wall_and_a_door_from_0_are_suspect(tmp_path):
    assert reported(cell(tmp_path, EPOCH)) == [REPORTED]


@pytest.mark.parametrize("start", [0.0, 0.5, 1.0])
def test_tables_with_a_moment_in_common_are_not(tmp_path, start):
    assert not reported(cell(tmp_path, start))


@pytest.mark.parametrize(
    ("door", "arm"),
    [("{file: door.csv, after: hold}", None), ("{file: door.csv, after: absent}", None),
     ("{file: door.csv, after: loop}", None), (None, "{file: path.csv, start: 0}"),
     ("{file: door.csv, start: 2.5}", None)],
)  # fmt: skip
def test_what_the_case_says_is_meant(tmp_path, door, arm):
    changes = ["moves: door.csv", f"moves: {door}"] if door else []
    changes += ["trajectory: path.csv", f"trajectory: {arm}"] if arm else []
    assert not reported(cell(tmp_path, 3.0, *changes))


@pytest.mark.parametrize(
    ("start", "severity"), [(1.5, None), (3.0, "warning"), (50.0, "warning"), (700.0, "suspect")]
)
def test_a_start_that_leaves_all_standing_longer_than_any_table_takes(tmp_path, start, severity):
    """Both tables take a second."""
    arm = "trajectory: path.csv", f"trajectory: {{file: path.csv, start: {start}}}"
    windows = [f"from: {start + late}, until: {start + late + 0.25}" for late in (0.25, 0.5)]
    changes = "from: 0.25, until: 0.75", windows[0], "from: 0.5, until: 1", windows[1]
    case = load_cell(tmp_path, *arm, *changes, trajectory=PATH.format(0, 1))
    found = [one for one in notices_of(case) if one.kind == "units"]
    assert [str(one.severity) for one in found] == ([severity] if severity else [])
    assert all(f"nothing moves from 1 to {start:g} s" in one.text for one in found)


@pytest.mark.parametrize(("start", "n_found"), [(0.5, 0), (500.0, 1)])
def test_what_stands_in_the_cell_for_a_time_only_after_all_motion_is_suspect(
    tmp_path, start, n_found
):
    door = "moves: door.csv", "moves: {file: door.csv, after: absent}"
    stands = "time,x,y,z,qx,qy,qz,qw\n{0},4,0,0,0,0,0,1\n{1},4,0,0,0,0,0,1\n"
    found = reported(cell(tmp_path, 0.0, *door, door=stands.format(start, 6.0 * start)))
    assert len(found) == n_found
    assert all("obstacle 'door' is in the cell from 500 to 3000 s" in text for text in found)


def test_when_the_earlier_begins_does_not_say_why_the_later_is_later(tmp_path):
    assert reported(cell(tmp_path, EPOCH, "moves: door.csv", "moves: {file: door.csv, start: 0}"))


def test_a_table_between_two_ties_them(tmp_path):
    """The right arm moves from 0.5 to 3.5 s, so all three are of one clock."""
    right = "joints: {shoulder: 0.2}", "trajectory: right.csv"
    between = PATH.format(0.5, 3.5)
    found = cell(tmp_path, 3.0, *right, right__csv=between)
    assert not reported(found)


def test_a_table_of_one_row_says_nothing_of_a_clock(tmp_path):
    case = cell(tmp_path, EPOCH)
    door = next(one for one in case.obstacles if one.moves is not None)
    moves = replace(
        door.moves,
        **{key: getattr(door.moves, key)[:1] for key in ("times", "positions", "quaternions")},
    )
    obstacles = [replace(one, moves=moves) if one is door else one for one in case.obstacles]
    assert not reported(replace(case, obstacles=tuple(obstacles)))


def test_a_program_that_leaves_out_waits_is_suspect_beside_others_that_move(tmp_path):
    case = cell(tmp_path, 0.0)
    (left, *others), left_out = case.robots, ("WaitDI (line 23)",)
    waits = replace(left, trajectory=replace(left.given_trajectory, left_out=left_out))
    case = replace(case, robots=(waits, *others))
    (told,) = reported(case)
    assert "the times of robot 'left' leave out WaitDI (line 23), and obstacle 'door' moves" in told
    (covered,) = [
        one for one in notices_of(replace(case, clock=Clock(1.0))) if one.kind == "clocks"
    ]
    assert covered.severity == "warning"
    assert (
        "leave out WaitDI (line 23)" in covered.text and "within the slack of 1 s" in covered.text
    )
    assert not reported(replace(case, clock=Clock(np.inf)))
    assert not reported(replace(case, obstacles=tuple(one for one in case.obstacles if one.stands)))


def test_a_program_whose_accelerations_nobody_says_is_told_beside_others_that_move(tmp_path):
    case = cell(tmp_path, 0.0)
    (left, *others) = case.robots
    rough = replace(left, trajectory=replace(left.given_trajectory, is_rough=True))
    case = replace(case, robots=(rough, *others))
    (told,) = [one for one in notices_of(case) if one.kind == "clocks"]
    assert told.severity == "warning"
    assert (
        "the times of robot 'left' rest on accelerations that no file says, and obst" in told.text
    )
    assert not reported(replace(case, clock=Clock(1.0)))
    assert not reported(replace(case, obstacles=tuple(one for one in case.obstacles if one.stands)))


def test_a_robot_that_a_program_moves_too_has_its_clock():
    drives = cl.Trajectory(np.arange(2.0), (), np.zeros((2, 0)), drives=("turn",))
    arm = replace(robot("arm"), trajectory=drives)
    clocks = clocks_of(case(robot("turn"), arm, robot("other"), robot("jig", "turn/base")))
    assert clocks[False, 0] == clocks[False, 1] == clocks[False, 3] != clocks[False, 2]


def two_recordings(folder, apart, *changes, **more):
    """Both arms by recordings of which the right one's first stamp is some seconds after the left one's."""
    files = "joints: {shoulder: 0.2}", "trajectory: path.csv"
    case = load_cell(folder, *files, *changes)
    left, right = (
        replace(one, trajectory=replace(one.given_trajectory, began=EPOCH + late, **more))
        for one, late in zip(case.robots, (0.0, apart), strict=True)
    )
    return replace(case, robots=(left, right))


@pytest.mark.parametrize(
    ("apart", "is_message", "severity", "says"),
    [
        (3.25, False, "suspect",
         "CHECK CLOCKS: by its stamps the recording of robot 'right' begins 3.25 s after that of 'left', "
         "but it is taken from 0 s; beside its file, `start: 3.25` keeps the delay and `start: 0` drops it"),
        (-3.25, False, "suspect", "robot 'left' begins 3.25 s after"),
        (1.25, False, "suspect", "begins 1.25 s after that of 'left'"),
        (0.25, False, "warning", "begins 0.25 s after that of 'left'"),
        (5e-4, False, None, ""),
        (0.25, True, "suspect", "the message of robot 'right' begins 0.25 s after that of 'left'"),
        (0.05, True, "warning", "begins 0.05 s after that of 'left'"),
    ],
)  # fmt: skip
def test_recordings_and_messages_that_begin_apart_are_told(
    tmp_path, apart, is_message, severity, says
):
    """Two drivers of one rate never send their first messages at one moment. These send two a second.

    The stamps of two planned messages at once are nearer than a tenth, whatever is between their points.
    """
    case = two_recordings(tmp_path, apart, is_message=is_message)
    found = [notice for notice in notices_of(case) if notice.kind == "clocks"]
    assert [notice.severity for notice in found] == ([severity] if severity else [])
    assert all(says in notice.text for notice in found)


@pytest.mark.parametrize(
    ("late", "says"),
    [
        (
            3.25,
            "obstacle 'door' begins 3.25 s after that of robot 'left', but it is taken from 0 s",
        ),
        (
            -3.25,
            "robot 'left' begins 3.25 s after that of obstacle 'door', but it is taken from 0 s",
        ),
        (0.0, None),
    ],
)
def test_recorded_poses_are_held_against_the_stamps_of_robots(tmp_path, late, says):
    case = two_recordings(tmp_path, 0.0)
    door, *others = case.obstacles
    door = replace(door, moves=replace(door.moves, began=EPOCH + late))
    found = reported(replace(case, robots=case.robots[:1], obstacles=(door, *others)))
    assert len(found) == (says is not None)
    assert all(says in text for text in found)


def test_a_planned_message_does_not_excuse_recordings_that_begin_apart(tmp_path):
    """Their samples are 5 ms apart and they begin 80 ms apart; the message may be that late."""
    case = two_recordings(tmp_path, 0.08)
    (left, right), (door, *others) = case.robots, case.obstacles
    left = replace(left, trajectory=replace(left.trajectory, is_message=True))
    right, door = (
        replace(one, **{name: replace(table, times=table.times / 1000.0)})
        for one, name, table in (
            (right, "trajectory", right.trajectory),
            (door, "moves", door.moves),
        )
    )
    door = replace(door, moves=replace(door.moves, began=EPOCH))
    found = notices_of(replace(case, robots=(left, right), obstacles=(door, *others)))
    (one,) = [notice for notice in found if "by its stamps" in notice.text]
    assert one.severity == "suspect" and "after that of obstacle 'door'" in one.text


@pytest.mark.parametrize("start", [0, 0.5, 3.25])
def test_a_recording_begins_when_the_case_says(tmp_path, start):
    said = (
        "trajectory: path.csv}\nscene",
        f"trajectory: {{file: path.csv, start: {start}}}}}\nscene",
    )
    assert not reported(two_recordings(tmp_path, 3.25, *said))


def recorded_tables(folder, late, says="", *changes, swing=0.5):
    """Both arms by tables that are recordings; the right one's stamps begin some seconds after the left one's."""
    files = ("trajectory: path.csv", "trajectory: {file: path.csv, gaps: linear}", "joints: {shoulder: 0.2}",
             f"trajectory: {{file: right.csv, gaps: linear{says}}}")  # fmt: skip
    right = f"time,shoulder\n{late},0\n{late + 1.0},{swing}\n"
    return load_cell(folder, *files, *changes, right__csv=right)


def test_a_recorded_table_that_begins_later_than_another_is_suspect(tmp_path):
    """A second of samples; the left arm moves to 1 s, the door too."""
    case = recorded_tables(
        tmp_path, 1.5, "", "moves: door.csv", "moves: {file: door.csv, rate: 0.5}"
    )
    assert reported(case) == [
        "CHECK CLOCKS: by its stamps the recording of robot 'right' begins 1.5 s after that of 'left', "
        "and no sample says where it is until then; beside its file, `start: 0` keeps the delay and "
        "`start: -1.5` drops it"
    ]


@pytest.mark.parametrize(
    ("late", "says", "swing"),
    [(1.0, "", 0.5), (1.5, ", start: 0", 0.5), (1.5, ", start: -1.5", 0.5), (1.5, "", 0.0)],
)
def test_a_recorded_table_begins_later_within_an_interval_or_because_the_case_says_so(
    tmp_path, late, says, swing
):
    slow_door = "moves: door.csv", "moves: {file: door.csv, rate: 0.5}"
    assert not reported(recorded_tables(tmp_path, late, says, *slow_door, swing=swing))


def test_a_recorded_table_that_begins_later_than_a_planned_one_is_a_warning(tmp_path):
    """Nobody recorded where the right arm is, while the left one moves as planned."""
    slow_door = "moves: door.csv", "moves: {file: door.csv, rate: 0.5}"
    planned = "trajectory: {file: path.csv, gaps: linear}", "trajectory: path.csv"
    case = recorded_tables(tmp_path, 1.5, "", *slow_door, *planned)
    (one,) = [notice for notice in notices_of(case) if notice.kind == "clocks"]
    assert one.severity == "warning" and one.text.startswith(
        "robot 'right' is recorded from 1.5 s on, and no sample says where it is until then"
    )
    said = recorded_tables(tmp_path, 1.5, ", start: 0", *slow_door, *planned)
    assert not reported(said)
