"""What may be changed, checked as it is asked, with each fault in one line; the amounts of a change in words."""

from __future__ import annotations

import math

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

import clearance as cl
from clearance.errors import BadDimension, BadInput, UnknownKey
from clearance.gains.change_parts import ChangePart
from clearance.gains.request import Request
from clearance.gains.sentences import signed_text
from clearance.gains.tool_poses import ToolKeep
from clearance.gains.turn import Turn
from clearance.options import made, options_in
from clearance.simulate.measure import inside
from tests.gains.gantries import slot


def asked(kind, **given):
    return made(Request, given, kind=kind)


@pytest.mark.parametrize(
    ("option", "text", "value"),
    [
        ("margin", "3", 0.003),
        ("keep", "0.9:1.1", (0.9, 1.1)),
        ("keep_tool", "12.0s=2mm,1deg", ToolKeep(12.0, 0.002, math.radians(1.0))),
        ("within", "50,0:100,0", ((-0.05, 0.05), (0.0, 0.1), (0.0, 0.0))),
        ("about", "1,-2,3", (0.001, -0.002, 0.003)),
        ("most_turn", "90", math.pi / 2),
        ("turn", "z", Turn("z")),
    ],
)
def test_a_text_of_the_command_line_is_read_in_its_unit(option, text, value):
    assert options_in(Request)[option].sort.read(text) == value


@pytest.mark.parametrize(
    ("option", "text"),
    [
        ("margin", "-1"),
        ("keep", "2:1"),
        ("keep", "1"),
        ("keep_tool", "1=2,1"),
        ("within", "5,5"),
        ("within", "0,-5,0"),
        ("about", "1,2"),
        ("most_turn", "nan"),
    ],
)
def test_a_text_that_is_none_is_told_with_what_would_be(option, text):
    sort = options_in(Request)[option].sort
    with pytest.raises(BadInput) as caught:
        sort.read(text)
    assert str(caught.value).startswith(f"{text!r} is given; {sort.valid}")


REFUSED = [
    ("shape", {}, BadInput, "unknown kind 'shape'; one of waypoints"),
    ("base", {"margin": -1.0}, BadDimension, "margin: -1.0 is given; a length, 0 or more"),
    ("base", {"margin": "a"}, BadInput, "margin: 'a' is given; a length"),
    ("base", {"margin": None}, BadInput, "margin: None is given; a length"),
    ("base", {"robot": 3}, BadInput, "robot: 3 is given; a list; each: a name"),
    ("base", {"robot": ("a", "b")}, BadInput, "2 robots are named, and only one can be changed"),
    ("waypoints", {"robot": ("a", "a")}, BadInput, "a robot is named twice"),
    ("obstacle", {"obstacle": 3}, BadInput, "obstacle: 3 is given; a name"),
    ("obstacle", {"robot": "a"}, BadInput, "robot says nothing with kind obstacle; kind waypoints or base"),
    ("base", {"keep": [(1, 2)]}, BadInput, "keep says nothing with kind base; kind waypoints"),
    ("waypoints", {"keep": [1]}, BadInput, "keep: 1 is given; start and end of a stretch"),
    ("waypoints", {"keep": [(1.0, 0.0)]}, BadInput, "keep: (1.0, 0.0) is given; start and end"),
    ("waypoints", {"keep_tool": 5}, BadInput, "keep_tool: 5 is given; a list"),
    ("waypoints", {"keep_tool": [(0.5, "a")]}, BadInput, "keep_tool: (0.5, 'a') is given; time [s]"),
    ("waypoints", {"keep_ends": "no"}, BadInput, "keep_ends: 'no' is given; True or False"),
    ("waypoints", {"turn": "z"}, BadInput, "turn says nothing with kind waypoints"),
    ("base", {"turn": 3}, BadInput, "turn: 3 is given; 'x', 'y', 'z' or a Turn"),
    ("base", {"about": (1, 2, 3)}, BadInput, "about says nothing without turn"),
    ("base", {"turn": "z", "most_turn": 0.0}, BadInput, "a turn of at most 0 deg is asked for"),
    ("base", {"tool": "hand"}, BadInput, "a tool is named, and nothing says that it is kept"),
    ("base", {"tool_path": "gone"}, BadInput, "tool_path: 'gone' is given; one of moved, kept"),
    ("base", {"within": (0, 0, 0)}, BadInput, "a box of zero leaves nothing to move"),
    ("base", {"within": (1, 1)}, BadDimension, "within: (1, 1) is given; ranges of x, y and z"),
    ("base", {"within": (1, 1, (3, 9))}, BadDimension, "a shift along z from 3000 to 9000 mm"),
    ("timing", {"most_delay": -1.0}, BadInput, "most_delay: -1.0 is given; a time, 0 or more"),
    ("timing", {"slow": True}, UnknownKey, "there is no option 'slow'; did you mean 'slow_down'?"),
]  # fmt: skip


@pytest.mark.parametrize(("kind", "given", "fault", "told"), REFUSED)
def test_each_fault_is_one_line_with_its_option(kind, given, fault, told):
    with pytest.raises(fault) as caught:
        asked(kind, **given)
    assert str(caught.value).startswith(told)


def test_what_is_said_of_a_turn_is_part_of_it():
    turn = asked("base", turn="z", about=(1, 0, 0), most_turn=0.5).turn
    assert turn == Turn("z", (1.0, 0.0, 0.0), 0.5)
    assert asked("base", turn=Turn("x", most=0.1), about=(1, 0, 0)).turn == Turn(
        "x", (1, 0, 0), 0.1
    )


def test_one_robot_or_several_are_names():
    assert asked("base", robot="left").one_robot == "left" and asked("base").one_robot is None
    assert asked("waypoints", robot=["left", "right"]).robot == ("left", "right")


def test_what_is_proposed_tells_whether_an_open_body_may_hold_another_though_no_search_asks(
    monkeypatch,
):
    asked = []
    told = inside.notices
    monkeypatch.setattr(inside, "notices", lambda plan: asked.append(plan) or told(plan))
    found = cl.gain(slot(fail=0.04, off=0.03), "base")
    assert found.kept and found.n_measured > 1 and len(asked) == 2


FACTORS = {"m": 1e3, "rad": math.degrees(1.0), "s": 1.0, "share": 100.0}
"""What an amount is multiplied by to be told."""

ROUNDING = 1e-11
"""[-] What counts as rounding of an amount."""


@given(st.floats(1e-9, 10.0), st.sampled_from([-1.0, 1.0]), st.sampled_from([*FACTORS]))
@example(0.1200434, 1.0, "m")
@example(1.4700434, -1.0, "m")
@example(1e-8, 1.0, "m")
@example(0.05000000000000001, 1.0, "m")
def test_an_amount_as_it_is_told_is_enough_and_hardly_more(size, sign, unit):
    told, needed = signed_text(ChangePart("x", sign * size, unit)).split()[0], size * FACTORS[unit]
    assert math.copysign(1.0, float(told)) == sign
    assert needed * (1.0 - ROUNDING) <= abs(float(told)) < needed + 1e-3


@pytest.mark.parametrize(
    ("size", "told"),
    [(0.02, "+20.000 mm"), (-0.005, "-5.000 mm"), (1e-8, "+0.0001 mm"), (1e-13, "0 mm")],
)
def test_what_is_round_stays_round_and_rounding_is_nothing(size, told):
    assert signed_text(ChangePart("x", size, "m")) == told
