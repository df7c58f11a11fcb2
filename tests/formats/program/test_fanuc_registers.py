"""FANUC's registers and position registers: what the file, or the case, says that they hold."""

from __future__ import annotations

import math
import re

import pytest

import clearance as cl
from tests.formats.program.test_fanuc import (
    CASE,
    FRAMES,
    POINTS,
    go,
    listing,
    names,
    place,
    point,
    program,
)
from tests.formats.refusal import refusal


def places(body: str, points: str = POINTS, **asked) -> list[list[float]]:
    """Where the tool is after each move [m], seen from the robot."""
    frames = {**CASE["frames"], **asked.pop("frames", {})}
    moves = program(FRAMES + body, points, frames=frames, **asked).moves
    return [[round(one, 9) for one in place(move)] for move in moves]


SHIFT = (
    point(5, 10.0, 0.0)
    .replace("50.000  mm", "-20.000  mm")
    .replace("180.000", "  0.000")
    .replace("90.000", "0.000")
)


L5, N5 = "L PR[5] 9mm/sec FINE ;", "PR[5], a position register, is not known: "
AWAY = "OFFSET,PR[5] is read for lengths along X, Y and Z alone"


@pytest.mark.parametrize(
    ("body", "ends"),
    [
        # x of the frame is the robot's y, from y = 0; the frame is at x 0.5 and z 0.2
        ("PR[5]=P[2] ;\n" + L5, [[0.5, 0.1, 0.25]]),
        ("PR[5]=P[2] ;\nPR[6:x]=PR[5:y] ;\nPR[6,1:x]=PR[6,1:x]+30 ;\nL PR[6] 9mm/sec FINE ;\n" + L5,
         [[0.5, 0.13, 0.25], [0.5, 0.1, 0.25]]),
        ("PR[5]=P[2] ;\nR[1]=4 ;\nPR[5,3]=(R[1]*10) ;\nR[2]=5 ;\nL PR[R[2:n]] 9mm/sec FINE ;", [[0.5, 0.1, 0.24]]),
        ("PR[5]=P[5] ;\nL P[2] 9mm/sec FINE Offset,PR[5:by it] ;", [[0.5, 0.11, 0.23]]),
        # the tool looks down, and its x goes against the frame's y: both turns by hand
        ("PR[5]=P[5] ;\nL P[2] 9mm/sec FINE Tool_Offset,PR[5] ;", [[0.49, 0.1, 0.27]]),
        ("PR[5]=P[5] ;\nL P[2] 9mm/sec FINE Tool_Offset,PR[5] Offset,PR[5] ;", [[0.49, 0.11, 0.25]]),
        ("PR[5]=P[5] ;\nUFRAME[1]=PR[5] ;\nL P[2] 9mm/sec FINE ;", [[0.11, 0.0, 0.03]]),
        ("PR[5]=P[2] ;\nR[1]=PR[5,1]/50 ;\nL P[R[1]] 9mm/sec FINE ;", [[0.5, 0.1, 0.25]]),
    ],
)  # fmt: skip
def test_position_registers_that_the_file_decides_are_followed(body, ends):
    assert places(body, POINTS + SHIFT) == ends


def test_a_position_register_of_the_case_is_seen_from_the_frame_in_force():
    given = {"PR[299]": {"xyz": [0.1, 0.0, 0.05], "rpy": [math.pi, 0.0, 0.0]}}
    body = "L PR[299:zero] 9mm/sec FINE ;\nPR[299,2]=-40 ;\nL PR[299] 9mm/sec FINE ;\n"
    assert places(body, frames=given) == [[0.5, 0.1, 0.25], [0.54, 0.1, 0.25]]
    given = {"PR[1]": {"xyz": [0.0, 0.003, 0.0]}}
    assert places("L P[2] 9mm/sec FINE Offset,PR[1] ;", frames=given) == [[0.497, 0.1, 0.25]]
    (move,) = program(f"{FRAMES}J PR[1] 9% FINE ;", frames={**CASE["frames"], **given}).moves
    assert move.to.unchecked == "the configuration of PR[1]"


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("PR[1]=LPOS ;\n" + L5.replace("5", "1"), N5.replace("5", "1") + "'LPOS' is not read"),
        ("PR[5]=P[2] ;\nPR[R[1]]=P[3] ;\n" + L5, N5 + "'PR[R[1]]=P[3]' is not read"),
        ("PR[5]=P[2] ;\nIF (DI[1]=ON) THEN ;\nPR[5,1]=3 ;\nENDIF ;\n" + L5,
         "'PR[5]' is given a value at line 10"),
        ("PR[5]=P[5] ;\nJ P[1] 9% FINE Offset,PR[5] ;", AWAY),
        ("PR[5]=P[2] ;\nUFRAME_NUM=2 ;\n" + L5, "PR[5] was taught in UFRAME 1, and UFRAME_NUM is 2"),
        ("PR[5]=P[1] ;\nUFRAME[1]=PR[5] ;\nL P[2] 9mm/sec FINE ;",
         "UFRAME[1] is set in the program, and is not known: it is no pose"),
        ("UFRAME[1]=PR[5] ;\nL P[2] 9mm/sec FINE ;",
         'not known: PR[5] is in no listing; a frame that the file decides, or program: {frames: {"PR[5]'),
        ("P[2,1]=P[3] ;\nL P[2] 9mm/sec FINE ;", "'P' is not understood"),
        ("PR[5]=P[6] ;\nL P[2] 9mm/sec FINE Offset,PR[5] ;", "L is given data of another kind"),
    ],
)  # fmt: skip
def test_a_position_register_that_the_file_does_not_decide_is_refused(body, told):
    untaught = SHIFT.replace("P[5:", "P[6:").replace("   10.000  mm", " ********  mm")
    assert told in refusal(places, body, POINTS + SHIFT + untaught)


def test_a_position_register_needs_the_frame_and_the_tool_in_force():
    """A point has numbers of both, a register has none."""
    assert re.search(
        r"PR\[5\]: no UTOOL_NUM is set before; write UTOOL_NUM=1 .*variables: {\"UTOOL",
        refusal(program, "UFRAME_NUM=1 ;\nPR[5]=P[2] ;\n" + L5),
    )


WAY = f"IF R[1]=2,JMP LBL[1] ;\n{go(2)}LBL[1] ;\n{go(3)}"


def test_a_case_says_what_registers_and_inputs_hold_and_the_headline_names_those_that_decide():
    found = program(FRAMES + WAY, variables={"R[1]": 2})
    assert [one.to.name for one in found.moves] == ["P[3]"]
    assert found.doubts == ("line 8: the way not taken is not measured; R[1] of the case decides",)
    assert names(WAY, variables={"R[1:kind]": 1.5}) == ["P[2]", "P[3]"]
    assert names(WAY.replace("R[1]", "R[ 01:kind]"), variables={"R[001]": 2}) == ["P[3]"]
    assert names(f"R[01]=2 ;\n{WAY}") == ["P[3]"]
    # a line gives it another value
    assert program(f"{FRAMES}R[1]=R[1]+1 ;\nR[1]=2 ;\n{WAY}", variables={"R[1]": 7}).doubts == ()
    found = program(FRAMES + WAY.replace("R[1]=2", "DI[5]=ON"), variables={"DI[5]": True})
    assert len(found.moves) == 1
    (told,) = found.doubts
    assert told.endswith(
        "DI[5] of the case decides, which is taken to hold that all the time, unless a wait needs another"
    )
    assert names("UFRAME_NUM=UFRAME_NUM ;\n" + go(2), variables={"UFRAME_NUM": 1}) == ["P[2]"]


@pytest.mark.parametrize(
    ("body", "asked", "told"),
    [
        (WAY, {}, 'let the file decide it, or program: {variables: {"R[1]": 0}}, if it holds that at the start'),
        ("DO[5]=ON ;\n" + WAY.replace("R[1]=2", "DO[5]"), {}, "only the controller knows DO[5]; let"),
        (go(2), {"variables": {"DO[1]": 1}}, "variables: DO[1]: 1 is given; true or false"),
        (go(2), {"variables": {"R[1]": True}}, "variables: R[1]: True is given; a number"),
        (go(2), {"variables": {"SO[1]": True}}, "variables: 'SO[1]' is given; a register or a signal, as R[1]"),
        ("DO[R[1]]=ON ;\n" + WAY.replace("R[1]=2", "DO[5]"), {"variables": {"DO[5]": True}},
         "variables: DO[5]: DO at line 8 may set it by a number that is not read"),
        ("WAIT DI[5]=OFF ;\n" + go(2), {"variables": {"DI[5]": True}},
         "WAIT waits for what is not known: it does not come true before others change it; let"),
    ],
)  # fmt: skip
def test_a_register_that_decides_is_asked_for(body, asked, told):
    assert told in refusal(names, body, **asked)


@pytest.mark.parametrize(
    ("given", "line"), [({"DO[5]": False}, "GO[1]=255"), ({"GO[5]": 0}, "DO[1]=ON")]
)
def test_a_group_of_outputs_may_have_one_that_the_case_gives(given, line):
    """Only the controller knows which outputs a group has."""
    (name,) = given
    way = WAY.replace("R[1]=2", f"{name}=5" if name == "GO[5]" else name)
    (told, _) = program(f"{FRAMES}{line} ;\n{way}", variables=given).doubts
    changed = line.partition("=")[0]
    assert (
        told == f"line 8: {name} of the case is taken to be none of the outputs that {changed} sets"
    )


def test_a_program_that_runs_beside_may_change_registers_though_its_start_is_left_out():
    body, grip = f"R[1]=0 ;\nRUN GRIP ;\n{WAY}", listing("R[1]=2 ;").replace("CELL", "GRIP")
    found = program(FRAMES + body, skip=["RUN"])
    assert len(found.moves) == 2 and "left out as asked: RUN (line 9)" in found.notes
    with pytest.raises(cl.ClearanceError, match=r"RUN 'GRIP' may change it at any time: 'R\[1\]'"):
        program(FRAMES + body, beside={"GRIP.LS": grip.encode()}, skip=["RUN"])
    moving = listing("J P[1] 9% FINE ;").replace("CELL", "GRIP").encode()
    with pytest.raises(cl.ClearanceError, match="RUN 'GRIP' moves the robot, or may: J at"):
        program(FRAMES + body, beside={"GRIP.LS": moving}, skip=["RUN"])
    assert re.search(r"line 9: 'RUN' is .*skip: \[RUN\]", refusal(program, FRAMES + body))


def test_a_wait_for_another_value_than_the_case_says_gives_the_input_that_value():
    body = f"WAIT DI[5]=OFF ;\n{WAY.replace('R[1]=2', 'DI[5]=ON')}"
    asked = {"variables": {"DI[5]": True}, "skip": ["WAIT"]}
    assert names(body, **asked) == ["P[2]", "P[3]"]
    body = body.replace("WAIT DI[5]=OFF", "WAIT DI[5]=OFF AND DI[6]=ON")
    asked["variables"]["DI[6]"] = True
    assert "given a value by what WAIT waits for at line 8" in refusal(names, body, **asked)
    select = f"SELECT GI[1]=1,JMP LBL[1] ;\n=2,JMP LBL[2] ;\nLBL[1] ;\n{go(2)}LBL[2] ;\n{go(3)}"
    with pytest.raises(cl.ClearanceError, match="given a value by what WAIT waits for at line 8"):
        names(f"WAIT GI[1]<>0 ;\n{select}", variables={"GI[1]": 0}, skip=["WAIT"])


def test_a_counter_that_decides_nothing_does_not_hide_that_an_endless_loop_repeats():
    body = f"R[1]=0 ;\nLBL[1] ;\n{go(2)}{go(3)}R[1:pieces]=R[1]+1 ;\nJMP LBL[1] ;\n"
    assert names(body) == ["P[2]", "P[3]", "P[2]", "P[3]"]


def test_a_joint_move_to_axes_needs_the_tool_where_it_ends_in_a_corner():
    """The corner begins where the tool's point is so far away; the tool is the one in force."""
    body, two = "J P[1] 9% {} ;\nL P[2] 9mm/sec FINE ;", {"UTOOL[2]": {"xyz": [0.0, 0.0, 0.3]}}
    lacks = r'P\[1\]: UTOOL\[2\] is not in a listing; program: {tools: {"UTOOL\[2\]"'
    corner = {"zones": {"CNT50": 0.02}}
    assert re.search(lacks, refusal(program, f"UFRAME_NUM=1 ;\n{body.format('CNT50')}", **corner))
    assert len(program(f"UFRAME_NUM=1 ;\n{body.format('FINE')}").moves) == 2
    (move, _) = program(FRAMES + body.format("CNT50"), **corner).moves
    assert move.tool[2, 3] == 0.1
    (move, _) = program(
        f"UFRAME_NUM=1 ;\n{body.format('CNT50')}", tools={**CASE["tools"], **two}, **corner
    ).moves
    assert move.tool[2, 3] == 0.3


def test_a_program_that_is_left_out_may_change_position_registers():
    body = f"{FRAMES}PR[5]=P[2] ;\nCALL FOLGE(5) ;\n{L5}"
    (told,) = program(body, skip=["FOLGE"]).doubts
    assert told == "PR[5] is taken not to be changed by what is left out: FOLGE (line 9)"
    assert program(f"{FRAMES}PR[5]=P[2] ;\nWAIT DI[1]=ON ;\n{L5}", skip=["WAIT"]).doubts == ()


@pytest.mark.parametrize("word", ["P", "R", "UFRAME_NUM", "UTOOL", "$MNUFRAMENUM"])
def test_what_changes_points_and_frames_is_never_left_out(word):
    with pytest.raises(
        cl.ClearanceError, match=f"skip: .*{word[1:]} moves the robot, or changes how"
    ):
        program(FRAMES + "P[R[1]]=P[5] ;\nL P[2] 100mm/sec FINE ;", skip=[word])
