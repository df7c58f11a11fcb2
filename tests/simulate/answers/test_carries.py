"""Carries that may not be meant are warned of: from afar, of what is held already, and of half an object."""

from __future__ import annotations

import numpy as np
import pytest

import clearance as cl
from clearance.world.body import Mount
from clearance.world.carry import Carry
from clearance.world.robot import Joint, JointKind
from clearance.world.timing import Timing, Window
from tests.made_cases import at
from tests.report.cells import box, cell, sliding, table_of


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
