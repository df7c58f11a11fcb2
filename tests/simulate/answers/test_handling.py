"""Parts that change hands or stand: contact gets a hint with the line that excuses it, and carries that may not be
meant are warned of: from afar, of what is held already, and of half an object.
"""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest
import yaml

import clearance as cl
from clearance import check, load_case
from clearance.report.topics.certainty import notes_of
from clearance.simulate.answers.handling import handling_hints
from clearance.simulate.answers.standing import always_in_contact, standing_contacts, standing_hint
from clearance.world.body import Mount
from clearance.world.carry import Carry
from clearance.world.collision_matrix import CollisionMatrix
from clearance.world.robot import Joint, JointKind
from clearance.world.rules import Allowance
from clearance.world.timing import Timing, Window
from tests.formats.making import CASE, write_case
from tests.made_cases import at
from tests.report.cells import box, cell, sliding, table_of

UP = np.array([[0.0, 0, -1, 0], [0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
"""What slides along x slides up."""


def lifting(**changes):
    """A tool comes down on a part on a pad, lifts it from 2 s on, sets it down at 4 s, and leaves it."""
    tool = sliding("left", [(0, 1), (1, 0.5), (2, 0.25), (3, 0.75), (4, 0.25), (5, 1)], base=UP)
    other = sliding("right", [(0, 3), (5, 3)])
    obstacles = (box("part", (0.1, 0.1, 0.1), at(z=0.14)), box("pad", (1, 1, 0.18)))
    return cell(
        (), (tool, other), obstacles, (Carry("part", "left/tool", Window(2.0, 4.0)),), **changes
    )


@pytest.fixture(scope="module")
def record():
    return cl.check(lifting()).record


def test_the_part_and_what_it_stands_on_are_named_with_the_time_of_contact(record):
    """The part goes 0.5 m in 1 s, which is looked at in 128 pieces: it is 3.9 mm off the pad after the first."""
    hints = [(one.part, one.mate, one.when, one.start, one.end) for one in handling_hints(record)]
    assert hints == [
        ("part", "pad", "picked up by left/tool at 2 s", 2.0, 2.007813),
        ("part", "pad", "let go by left/tool at 4 s", 3.992187, 4.0),
    ]
    notes = notes_of(record, standing_hint(record))
    assert any(
        "part touches pad when it is picked up by left/tool at 2 s" in note for note in notes
    )


def test_the_row_of_each_hint_excuses_it_and_stands_in_one_block_for_all(record):
    allow = []
    *others, last = standing_hint(record)
    rows = yaml.safe_load(last.partition("add to the case: ")[2])["allow"]
    assert len(others) == 1 and not any("allow" in hint for hint in others)
    assert rows == [yaml.safe_load(hint.row) for hint in handling_hints(record)]
    for row in rows:
        window = Window(row.get("from", -np.inf), row.get("until", np.inf))
        allow.append(Allowance(tuple(row["between"]), window))
    again = cl.check(lifting(allow=tuple(allow)))
    assert handling_hints(again.record) == []
    assert again.status != "contact"
    assert again.worst["clearance"] == pytest.approx(0.5 / 128, abs=0.5e-6)


def test_fingers_that_hold_a_part_before_they_carry_it_are_named_too():
    """The tool stands against the part from 1 s, carries it from 2 s on, and then moves with it."""
    robots = (
        sliding("left", [(0, 0), (1, 1), (2, 1), (3, 0)]),
        sliding("right", [(0, 1.5), (1, 1.2), (2, 1.2), (3, 1.2)]),
    )
    obstacles = (box("part", (0.1, 0.1, 0.1), at(1.1, 0, 0.5)), box("table", (4, 4, 0.1)))
    carries = (Carry("part", "left/tool", Window(2.0), touch=("right/*",)),)
    hints = handling_hints(cl.check(cell((), robots, obstacles, carries)).record)
    told = [(one.mate, one.start, one.end) for one in hints]
    assert told == [("left/tool", 0.992187, 2.0), ("right/tool", 0.992187, 2.0)]


@pytest.mark.parametrize(
    ("samples", "start"),
    [
        ([(0, 2), (2, 1)], None),  # through the part
        ([(0, 0), (2, 1.01)], 1.96875),  # 10 mm into it: 2 of 128 pieces of 7.9 mm before
        ([(0, 0), (1, 1.15), (1.5, 0.5), (2, 1)], 1.996093),  # through it before, and then to it
    ],
)
def test_a_row_excuses_no_deeper_contact_than_as_the_part_changes_hands(samples, start):
    """The part's near side is at 1.05 m, and so the tool touches it at 1 m."""
    robots = (sliding("left", [*samples, (3, 0)]), sliding("right", [(0, 3), (3, 3)]))
    obstacles = (box("part", (0.1, 0.1, 0.1), at(1.1, 0, 0.5)), box("table", (4, 4, 0.1)))
    carries = (Carry("part", "left/tool", Window(2.0)),)
    record = cl.check(cell((), robots, obstacles, carries)).record
    (hint,) = handling_hints(record)
    assert hint.is_deeper == (start is None) and (hint.is_deeper or hint.start == start)
    (told,) = standing_hint(record)
    assert ("add to the case: allow" in told) == (start is not None)
    assert ("deeper in it" in told) == (start is None)


def test_pairs_in_contact_whenever_they_are_measured_are_named_over_all_phases():
    """A cart rides on the robot, in contact with a second one's tool that moves with it all the time."""
    robots = (
        sliding("left", [(0, 0), (4, 1)]),
        replace(sliding("right", [(0, 0), (4, 1)]), world_from_base=at(y=0.05, z=0.5)),
    )
    obstacles = (
        box("part", (0.1, 0.1, 0.1), at(2, 0, 2)),
        box("tray", (0.05, 0.05, 0.05), mount=Mount("right/tool", at(y=-0.1))),
    )
    carries = (Carry("part", "left/tool", Window(1.0, 2.0)),)
    record = cl.check(cell((), robots, obstacles, carries)).record
    assert len(record.timeline.phases) == 3
    found = always_in_contact(record)
    assert sorted(found) == [("left/tool", "right/tool"), ("left/tool", "tray")]
    links, riding = standing_hint(record)
    assert "left/tool - right/tool" in links and "link against link" in links
    assert "left/tool - tray" in riding and "whenever they are measured" in riding
    both = 'allow: [["left/tool", "right/tool"], ["left/tool", "tray"]]'
    assert riding.endswith(both) and "allow" not in links
    some = cl.check(cell((), robots, obstacles, carries, allow=(Allowance(found[0]),))).record
    (rest,) = standing_hint(some)
    assert rest.endswith(f"add to its rows of allow: {json.dumps(found[1])}")
    excused = tuple(Allowance(pair) for pair in found)
    assert standing_hint(cl.check(cell((), robots, obstacles, carries, allow=excused)).record) == []


TABLES = CASE.replace(
    "trajectory:",
    "  - {name: table, pose: {xyz: [0, 0, -0.15]}, box: {size: [1, 1, 0.1]}}\n"
    "  - {name: 'plate, 2', pose: {xyz: [0, 0, -0.05]}, box: {size: [0.1, 0.1, 0.1]}}\n"
    "  - {name: collar, pose: {xyz: [0, 0, 0.6]}, box: {size: [0.1, 0.1, 0.1]}}\ntrajectory:",
)
"""The arm's base stands on a table and in a plate; the collar is inside its upper link, which turns."""


@pytest.fixture
def run(tmp_path):
    return check(load_case(write_case(tmp_path, TABLES)), need="pairs")


def test_only_links_that_never_move_are_named(run):
    assert sorted(standing_contacts(run.record)) == [("base", "plate, 2"), ("base", "table")]


def test_the_hint_holds_the_line_to_paste_and_the_line_leaves_them_out(run, tmp_path):
    (hint,) = standing_hint(run.record)
    assert hint.startswith("2 pairs touch all the time, since the link never moves")
    assert notes_of(run.record, run.session.hints).count(hint) == 1
    line = hint.partition("case: ")[2]
    again = check(load_case(write_case(tmp_path, TABLES + line + "\n")))
    assert standing_hint(again.record) == []
    assert len(again.record.case.allow) == 2


def test_a_link_that_stands_because_its_joint_rests_is_standing_too(run):
    placed = run.record.case.robots[0]
    asked = replace(placed.trajectory, positions=np.zeros_like(placed.trajectory.positions))
    resting = replace(run.record.case, robots=(replace(placed, trajectory=asked),))
    found = standing_contacts(check(resting).record)
    assert ("upper", "collar") in found


@pytest.mark.parametrize("fixed", [{}, {"left_finger": 0.0}])
def test_fingers_that_rest_closed_at_nobodys_word_are_told_by_their_joint(fixed):
    """A hand slides on, its two fingers 0.1 m thick and side by side; one of them can open."""
    joints = (
        Joint("rail", JointKind.PRISMATIC, "base", "right", at(z=1.0)),
        Joint("left_finger", JointKind.PRISMATIC, "right", "left", at(y=0.1)),
    )
    bodies = tuple(cl.Body(name, cl.box((0.1, 0.1, 0.1))) for name in ("base", "right", "left"))
    robot = cl.Robot("hand", ("base", "right", "left"), joints, bodies)
    path = cl.Trajectory(np.arange(3.0), ("rail",), np.arange(3.0)[:, None])
    asked = cl.SelfClearance(CollisionMatrix())
    placed = cl.PlacedRobot(robot, path, self_clearance=asked, fixed_positions=fixed)
    (told,) = standing_hint(cl.check(cl.Case("own", (placed,), ())).record)
    says = "'left_finger' between them is given by nobody and stays at 0"
    assert (says in told) == (not fixed) and "add to the case: allow" in told
    assert (
        "link against link: left - right; the SRDF does not excuse the neighbours left - right"
        in told
    )


def told(obstacles, *carries):
    """The warnings on carries of a tool that slides from 0 to 1 m, and back."""
    robots = (sliding("left", [(0, 0), (1, 1), (2, 0)]), sliding("right", [(0, 3), (2, 3)]))
    warnings = cl.check(cell((), robots, obstacles, carries)).verdict.warnings
    return [one for one in warnings if "[CL428]" in one]


PART = box("a/0", (0.1, 0.1, 0.1), at(1.1, 0, 0.5))


@pytest.mark.parametrize("carried", [("a/0",), ("a/0", "a/1")])
def test_an_object_that_is_carried_in_part_is_warned_of(carried):
    others = [box("a/1", (0.1, 0.1, 0.1), at(1.1, 0, 0.6)), box("wall", (1, 1, 0.1), at(z=-1.0))]
    said = told((PART, *others), *(Carry(one, "left/tool", Window(1.0)) for one in carried))
    whole = "object 'a' is carried in part: 'a/0' moves, 'a/1' stays; part: a carries all [CL428]"
    assert said == ([whole] if carried == ("a/0",) else [])


@pytest.mark.parametrize(
    ("carries", "is_told"),
    [
        ([("left/tool", 1.0)], True),
        ([("left/tool", 0.0)], False),
        ([("left/tool", 0.0, 0.5), ("left/tool", 1.0)], False),
        ([("right/tool", 1.0)], False),
    ],
)
def test_a_part_that_its_carrier_has_already_is_warned_of(carries, is_told):
    held = box("part", (0.1, 0.1, 0.1), mount=Mount("left/tool", at(0.2)))
    rows = [Carry("part", by, Window(*when)) for by, *when in carries]
    said = [one for one in told((held,), *rows) if "already" in one]
    assert len(said) == is_told


@pytest.mark.parametrize(
    ("by", "x", "told"),
    [
        ("tool", 0.1, "0.383 m away from all of what picks it up at 0 s (tool)"),
        ("tcp", 0.1, "0.383 m away"),
        ("bare", 0.1, "0.383 m away"),
        ("arm", 0.1, None),
        ("base", 0.1, None),
        ("tool", 0.6, None),
    ],
)
def test_a_part_is_far_from_what_grips_it_wherever_the_rest_of_the_arm_is(by, x, told):
    """A cube lies 0.02 m beside an arm, and (0.38, 0.05) m from the tool at the arm's end."""
    joints = (
        Joint("j1", JointKind.REVOLUTE, "base", "arm", np.eye(4)),
        Joint("j2", JointKind.REVOLUTE, "arm", "tool", at(0.5)),
        Joint("j3", JointKind.FIXED, "tool", "tcp", at(0.04)),
        Joint("j4", JointKind.REVOLUTE, "tool", "bare", at(0.04)),
    )
    bodies = (
        cl.Body("arm", cl.box((0.5, 0.1, 0.1)).transformed(at(0.25))),
        cl.Body("tool", cl.box((0.04, 0.04, 0.04)).transformed(at(0.02))),
    )
    robot = cl.Robot("own", ("base", "arm", "tool", "tcp", "bare"), joints, bodies)
    rows = np.zeros((2, 3))
    placed = cl.PlacedRobot(robot, cl.Trajectory(np.array([0.0, 2.0]), ("j1", "j2", "j4"), rows))
    obstacles = (box("part", (0.04, 0.04, 0.04), at(x, 0.09)), box("wall", (1, 1, 0.1), at(z=-1.0)))
    case = cl.Case("far", (placed,), obstacles, carries=(Carry("part", by, Window(0.0)),))
    warnings = [one for one in cl.check(case).verdict.warnings if "picks it up" in one]
    assert len(warnings) == (told is not None) and all(told in one for one in warnings)


WALL = box("wall", (1, 1, 0.1), at(z=-1.0))


@pytest.mark.parametrize(
    ("window", "tells"),
    [
        ((0.5, 1.5), ("picks up part 'a/0' at 0.5 s", "lets go of part 'a/0' at 1.5 s")),
        ((1.0, 1.5), ("lets go of part 'a/0' at 1.5 s",)),
        ((1.0,), ()),
    ],
)
def test_a_tool_that_grips_or_lets_go_without_stopping_is_warned_of(window, tells):
    """It turns back at 1 s."""
    said = told((PART, WALL), Carry("a/0", "left/tool", Window(*window)))
    said = [one for one in said if "in passing, at 1 m/s: check the times" in one]
    assert len(said) == len(tells) and all(map(str.__contains__, said, tells))


def test_a_part_that_changes_hands_or_comes_to_what_stands_is_not_taken_in_passing():
    hands = Carry("a/0", "left/tool", Window(1.0, 1.5)), Carry("a/0", "wall", Window(1.5))
    assert not [one for one in told((PART, WALL), *hands) if "in passing" in one]
    comes = table_of([(0, 3.1, 0, 0.5), (1, 1.1, 0, 0.5)])
    part = box("a/0", (0.1, 0.1, 0.1), moves=comes)
    said = told((part, WALL), Carry("a/0", "wall", Window(0.5)))
    assert not [one for one in said if "in passing" in one]


@pytest.mark.parametrize(("by", "n_told"), [("left/base", 1), ("left/tool", 0)])
def test_a_part_from_which_the_nearest_of_its_carrier_goes_away_is_warned_of(by, n_told):
    said = told((PART, WALL), Carry("a/0", by, Window(1.0)))
    text = f"1 m farther away from all of what picked it up ({by}) at 2 s: check who carries it"
    assert len(said) == n_told and all(text in one for one in said)


def test_a_part_that_leaves_with_a_robot_is_told_of_and_is_carried_until_then():
    left = sliding("left", [(0, 0), (1, 1), (2, 0)], timing=Timing(after="absent"))
    robots = left, sliding("right", [(0, 3), (4, 3.5)])
    result = cl.check(cell((), robots, (PART, WALL), (Carry("a/0", "left/tool", Window(1.0)),)))
    (said,) = [one for one in result.verdict.warnings if "[CL428]" in one]
    assert "part 'a/0' leaves the cell at 2 s with left/tool (after: absent)" in said
    assert [(row["from"], row["until"]) for row in result.summary["carries"]] == [(1.0, 2.0)]


@pytest.mark.parametrize(("x", "n_told"), [(1.2, 0), (1.6, 1)])
def test_shapes_of_an_object_do_not_hold_one_another(x, n_told):
    """One of them is to be near the tool, whose end is at 1.05 m; they touch."""
    shapes = [
        box("a/0", (0.1, 0.1, 0.1), at(x, 0, 0.5)),
        box("a/1", (0.3, 0.1, 0.1), at(x + 0.2, 0, 0.5)),
    ]
    said = told((*shapes, WALL), *(Carry(f"a/{i}", "left/tool", Window(1.0)) for i in range(2)))
    text = "part 'a/0' is 0.5 m away from all of what picks it up at 1 s (left/tool)"
    assert len(said) == n_told and all(text in one for one in said)


def test_a_part_far_away_is_told_of_though_another_is_gripped_at_once():
    near, far = (box(name, (0.1, 0.1, 0.1), at(1.1, y, 0.5)) for name, y in (("p", 0), ("q", 1.5)))
    (said,) = told((near, far, WALL), *(Carry(one, "left/tool", Window(1.0)) for one in "pq"))
    assert "part 'q' is" in said and "away from all of what picks it up at 1 s" in said
