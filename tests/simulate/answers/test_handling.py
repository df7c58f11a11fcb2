"""A part that touches what it stood on, or fingers, as it changes hands: a hint with the line that excuses it."""

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
from clearance.world.timing import Window
from tests.formats.making import CASE, write_case
from tests.made_cases import at
from tests.report.cells import box, cell, sliding

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


def test_a_part_far_from_what_picks_it_up_stands_in_the_headline():
    """At 0.5 s the tool's lower side is at 0.75 - 0.05 m, and the part's upper one at 0.14 + 0.05 m."""
    case = lifting()
    early = replace(case, carries=(Carry("part", "left/tool", Window(0.5, 4.0)),))
    (warning,) = [one for one in cl.check(early).verdict.warnings if "picks it up" in one]
    assert warning.startswith("part 'part' is 0.51 m away") and warning.endswith(
        "of its carry [CL428]"
    )
    assert not any("picks it up" in one for one in cl.check(case).verdict.warnings)


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
