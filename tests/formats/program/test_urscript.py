"""URScript: the moves that a script makes, by hand; a line for what the file does not decide."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import clearance as cl
from clearance.formats.program.controller_program import AxisTarget, PoseTarget
from tests.formats.program.reading import read
from tests.formats.refusal import refusal

TOOL = "set_tcp(p[0, 0, 0.1, 0, 0, 0])\n"
CELL = """# -*- begin: made by hand
def Program():
  set_tcp(p[0, 0, 0.1, 0, 0, 0])
  set_payload(1.2)
  global home = [0, d2r(-90), 1.5, -1.5, -1.5, 0]
  global P1 = p[0.4, 0.1, 0.3, 0, 3.141592653589793, 0]
  def pick(at, up=0.1):
    movel(pose_trans(at, p[0, 0, -up, 0, 0, 0]), a=1.0, v=0.25, r=0.01)
    movel(at, v=0.1)
    set_digital_out(0, True)
    sleep(0.5)
  end
  while (True):
    $ 1 "Robot Program"
    movej(home, a=1.4, v=0.8)
    i = 0
    while i < 2:
      pick(pose_trans(P1, p[0.1 * i, 0, 0, 0, 0, 0]))
      i = i + 1
    end
    if get_digital_in(1): textmsg("ready") end
  end
end
"""


def moves_of(text, **asked):
    return read("a.script", text, **asked).moves


def place(move):
    return move.to.pose[:3, 3].tolist()


def test_calls_and_loops_become_moves_with_their_lines():
    found = read("a.script", CELL)
    one, two = found.moves[:7], found.moves[7:]
    assert (
        [move.line.number for move in one]
        == [15, 8, 9, 11, 8, 9, 11]
        == [move.line.number for move in two]
    )
    home, over, on, wait, _, next_, _ = one
    assert home.to == AxisTarget((0.0, -math.pi / 2, 1.5, -1.5, -1.5, 0.0), name="home")
    assert (home.kind, home.axis_speed, home.zone) == ("ptp", 0.8, 0.0)
    # a tool that looks down (half a turn about y): its -z is up, its x is back
    assert place(over) == pytest.approx([0.4, 0.1, 0.4]) and over.zone == 0.01
    assert place(on) == pytest.approx([0.4, 0.1, 0.3]) and on.speed == 0.1
    assert place(next_) == pytest.approx([0.3, 0.1, 0.3])
    assert np.allclose(on.to.pose[:3, :3], np.diag([-1.0, 1.0, -1.0]), atol=1e-15)
    assert wait.seconds == 0.5 and over.tool[2, 3] == 0.1
    told = "\n".join(found.notes)
    for what in (
        "set_payload (line 4)",
        "without moves: line 21",
        "endless loop",
        "2 are measured",
    ):
        assert what in told


def test_arcs_blends_and_joint_targets():
    text = TOOL + "movec(p[1,0,0,0,0,0], p[1,1,0,0,0,0], mode=1, r=0.02)\nmovep([0,0,0,0,0,0])"
    arc, line = moves_of(text)
    assert (arc.kind, arc.orientation, arc.zone, place(arc)) == ("circ", "tangent", 0.02, [1, 1, 0])
    assert arc.via.pose[:3, 3].tolist() == [1.0, 0.0, 0.0]
    assert line.kind == "lin" and line.to == AxisTarget((0.0,) * 6)


def test_joints_beside_a_pose_say_which_are_meant():
    text = TOOL + "W_p = p[1,0,0,0,0,0]\nmovej(get_inverse_kin(W_p, qnear=[1,2,3,4,5,6]))"
    (move,) = moves_of(text)
    assert isinstance(move.to, PoseTarget) and move.to.near == (1, 2, 3, 4, 5, 6)
    assert move.to.name == "W_p" and move.kind == "ptp"


def test_where_the_tool_is_is_known_after_a_move_that_stops():
    text = (
        TOOL + "movel(p[1,0,0,0,0,0])\nmovel(pose_trans(get_actual_tcp_pose(), p[0,0,0.1,0,0,0]))"
    )
    assert place(moves_of(text)[1]) == pytest.approx([1.0, 0.0, 0.1])
    with pytest.raises(cl.ClearanceError, match=r"line 3: the target is not known: get_actual_tcp"):
        moves_of(text.replace("0,0])\n", "0,0], r=0.01)\n"))


def test_the_installations_tool_is_asked_for():
    with pytest.raises(cl.ClearanceError, match=r"line 1: no set_tcp .*tools: \{tcp"):
        moves_of("movel(p[1,0,0,0,0,0])")
    (move,) = moves_of("movel(p[1,0,0,0,0,0])", tools={"tcp": {"xyz": [0.0, 0.0, 0.2]}})
    assert move.tool[2, 3] == 0.2
    assert moves_of("movej([0,0,0,0,0,0])")[0].tool[2, 3] == 0.0
    with pytest.raises(cl.ClearanceError, match=r"line 1: no set_tcp"):
        moves_of("movej([0,0,0,0,0,0], r=0.05)")  # the blend is of the tool


def test_encodings_are_read():
    text = "# Stück\nmovej([0,0,0,0,0,0]) # für\n"
    for data in (text.encode("latin-1"), b"\xef\xbb\xbf" + text.encode(), text.encode("utf-8")):
        assert [move.line.number for move in moves_of(data.replace(b"\n", b"\r\n"))] == [2]
    with pytest.raises(cl.ClearanceError, match=r"^a\.script: this is no text of single bytes"):
        moves_of(text.encode("utf-16"))


Q = "movej([0,0,0,0,0,0])"

FAULTS = {
    "if get_digital_in(1):\n"
    + Q
    + "\nend": "line 1: if decides on movej at line 2, and is not known",
    "while not get_digital_in(1):\nsync()\nend": "line 1: while waits for what is not known",
    "i = 0\nwhile True:\n"
    + Q
    + "\nj = i\ni = i + 1\nend": "repeats none of its first 100 passes; write a loop that ends, or set 'i'",
    "servoj([0,0,0,0,0,0])": "line 1: servoj moves the robot on a way",
    TOOL + "movel(p[0,0,0,1e200,0,0])": "line 2: rotation vector: a turn by inf rad",
    "movej(home)": "line 1: the target is not known: 'home' is in no file",
    "movej([0,0,0])": "six numbers",
    "movej([0,0,0,0,0,0], v=0)": "line 1: v is 0; more than 0",
    "movej([0,0,0,0,0,0], speed=1)": "movej has no 'speed'",
    "movej([0,0,0,0,0,0": "line 1: the file ends; ',', or ']' is needed",
    "def f():\n" + Q: "line 1: def has no end; a whole file",
    "def f():\n"
    + Q
    + "\nend\ndef g():\n"
    + Q
    + "\nend": "entry: several functions are there: f, g",
    "def f():\nf()\nend\nf()": "more than 40 routines call one another",
    "x = "
    + Q: "line 1: movej moves the robot, and its value is not read; write the move as a statement",
    TOOL + "q=get_inverse_kin(p[0.4,0.2,0.3,3,0,0],[1,2,3,4,5,6])\nq[5]=q[5]+1": (
        "line 3: one axis of get_inverse_kin is asked for, and they are not worked out; six numbers"
    ),
    "a=[[1,2,3,4,5,6],[1,2,3,4,5,6],[1,2,3,4,5,6]]*0.5": "'*' has no value for a list of 3 and 0.5",
    TOOL + Q + "\nmovel(pose_trans(get_actual_tcp_pose(), p[0,0,0.1,0,0,0]))": (
        "get_actual_tcp_pose() at line 3 (the move before ends at joints; joints and poses are not converted)"
    ),
    "a=[get_actual_tcp_pose()]+0": "'+' has no value for [what is not known] and 0",
    "thread t():\n" + Q + "\nend\nrun t()": "thread 't' moves the robot",
    "RPC = rpc_factory(1)\nRPC.grip(20)": "line 2: 'RPC.grip' is no known instruction",
    "while 1 == 1:\nx = [1]\nx[3] = 2\nend": "line 3: there is no part 3",
    "movej([0,0,0,0,0,1e999])": "a number of this earth",
    "a b": "line 1: 'b' is given; the end of the line is needed",
}


def test_angles_about_fixed_axes_become_a_rotation_vector():
    """A quarter turn about x, then one about z, is a third of a turn about (1, 1, 1)."""
    (move,) = moves_of(TOOL + "r=rpy2rotvec([pi/2,0,pi/2])\nmovel(p[0,0,0,r[0],r[1],r[2]])")
    unknown = "r=rpy2rotvec([0,0,get_analog_in(1)])\n"
    assert len(moves_of(f"{unknown}{Q}")) == 1
    with pytest.raises(cl.ClearanceError, match="target is not known: get_analog_in"):
        moves_of(f"{TOOL}{unknown}movel(p[0,0,0,r[0],r[1],r[2]])")
    turn = move.to.pose[:3, :3]
    assert turn == pytest.approx(np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), abs=1e-12)


@pytest.mark.parametrize("text", FAULTS)
def test_what_the_file_does_not_decide_is_refused_with_its_line(text):
    told = refusal(moves_of, text)
    assert FAULTS[text] in told and told.startswith("a.script: ")


@pytest.mark.parametrize(
    "name",
    "set_tool get_part read_force write_log is_ready enable_gripper socket_ask rpc_ask request_part".split(),
)
def test_a_function_that_no_file_has_is_refused_however_it_begins(name):
    for text in (f"{name}(2)", f"x = {name}(2)"):
        with pytest.raises(cl.ClearanceError, match=f"line 2: '{name}' is no known instruction"):
            moves_of(f"{Q}\n{text}\n{Q}")
    assert len(moves_of(f"def {name}(n):\n{Q}\nend\n{name}(2)\n{Q}")) == 2


LINE = "movel(p[x, 0, 0, 0, 0, 0])"
UNDECIDED = {
    "a variable": "x = 1\nif get_digital_in(1):\nx = 2\nend\n" + LINE,
    "by a function": "global x = 1\ndef f():\nx = 2\nend\nif get_digital_in(1):\nf()\nend\n" + LINE,
    "a thread": "global x = 1\nthread f():\nx = 2\nend\nrun f()\nx = 3\n" + LINE,
    "the tool": "x = 1\nif get_digital_in(1):\nset_tcp(p[1,0,0,0,0,0])\nend\n" + LINE,
}  # fmt: skip


@pytest.mark.parametrize("case", UNDECIDED)
def test_what_only_the_controller_decides_is_never_taken_for_known(case):
    told = "is not known: ('x' is given a value at|thread 'f' may change it)|decides on set_tcp"
    assert re.search(told, refusal(moves_of, TOOL + UNDECIDED[case]))


def test_a_move_within_what_is_passed_over_is_made():
    found = moves_of("def f():\n" + Q + "\nreturn True\nend\nset_digital_out(1, f())\ntextmsg(f())")
    assert [one.line.number for one in found] == [2, 2]


def test_solved_axes_are_of_the_tool_that_they_are_solved_for():
    """The flange is at z = 0.3 - 0.1; another tool of 0.5 is then at 0.7, and so for the tool of the function."""
    solve = "q = get_inverse_kin(p[0.4,0,0.3,0,0,0], [0,0,0,0,0,0]{})\n" + TOOL.replace(
        "0.1", "0.5"
    )
    for own in ("", ", tcp=p[0,0,0.1,0,0,0]"):
        before = TOOL if not own else TOOL.replace("0.1", "9")
        (move,) = moves_of(before + solve.format(own) + "movej(q)")
        assert place(move) == pytest.approx([0.4, 0.0, 0.7])


def test_a_tool_that_is_set_outside_of_the_function_holds():
    text = TOOL + "def f():\nmovel(p[0.4,0,0.3,0,0,0])\nend\nf()"
    (move,) = moves_of(text, entry="f", tools={"tcp": {"xyz": [0.0, 0.0, 0.9]}})
    assert move.tool[2, 3] == 0.1


def test_a_function_is_chosen_and_files_stand_beside():
    main = "def f():\nhelp()\nend\ndef g():\nend"
    beside = {"more.script": b"def help():\n\nmovej([0,0,0,0,0,0])\nend"}
    (move,) = read("a.script", main, beside, entry="f").moves
    assert (move.line.file, move.line.number) == ("more.script", 3)
    assert "there is no function 'h'" in refusal(moves_of, main, entry="h")
    with pytest.raises(cl.ClearanceError, match=r"more\.script: 'help' is defined twice"):
        read("a.script", main + "\ndef help():\nend", beside, entry="f")


PASSES = {
    # a pallet of three places: the way from the last back to the first is measured
    "i = 0\nwhile True:\nmovel(p[i,0,0,0,0,0])\ni = i + 1\nif i == 3:\ni = 0\nend\nend": [
        0,
        1,
        2,
        0,
    ],
    # the way from 2 to 1 comes with the second pass after the first
    "a = True\nwhile True:\nif a:\nmovel(p[9,0,0,0,0,0])\na = False\nelse:\nmovel(p[1,0,0,0,0,0])\n"
    "movel(p[2,0,0,0,0,0])\nend\nend": [9, 1, 2, 1, 2],
    # solved anew in each pass
    "while True:\nq = get_inverse_kin(p[4,0,0.1,0,0,0])\nmovej(q)\nend": [4, 4],
}


@pytest.mark.parametrize("body", PASSES)
def test_an_endless_loop_is_measured_until_it_repeats_itself(body):
    assert [round(place(one)[0]) for one in moves_of(TOOL + body)] == PASSES[body]


def test_labels_of_nodes_name_the_moves_that_stand_below_them():
    nodes = '$ 2 "MoveL"\n  $ 3 "approach" "breakAfter"\n\nmovel(p[1,0,0,0,0,0])\nmovel(p[2,0,0,0,0,0])\n'
    nodes += 'P = p[3,0,0,0,0,0]\n$ 4 "weld"\nmovel(P)\n$ 5 "home"\nmovej([0,0,0,0,0,0])\n'
    assert [one.to.name for one in moves_of(TOOL + nodes)] == ["approach", "", "P", "home"]
