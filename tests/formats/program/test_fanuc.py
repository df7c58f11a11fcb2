"""FANUC's listings: the moves that a program makes, by hand; a line for what the file does not decide."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import clearance as cl
from clearance.formats.program.controller_program import ControllerWait
from clearance.formats.program.tokens import Line
from tests.formats.program.reading import read
from tests.formats.refusal import refusal

HEAD = "/PROG  CELL\n/ATTR\nOWNER\t\t= MNEDITOR;\nDEFAULT_GROUP\t= 1,*,*,*,*;\n/MN\n"
FRAMES = "UFRAME_NUM=1 ;\nUTOOL_NUM=1 ;\n"


def point(number: int, x: float, y: float, frame: int = 1, more: str = "") -> str:
    """A point that looks down, taught in a frame."""
    return (
        f"P[{number}:\"A\"]{{\n   GP1:\n\tUF : {frame}, UT : 1,\t\tCONFIG : 'N U T, 0, 0, 0',\n"
        f"\tX = {x:9.3f}  mm,\tY = {y:9.3f}  mm,\tZ =    50.000  mm,\n"
        f"\tW =   180.000 deg,\tP =     0.000 deg,\tR =    90.000 deg{more}\n}};\n"
    )


HOME = """P[1]{
   GP1:
	UF : 0, UT : 2,	
	J1=    10.000 deg,	J2=    20.000 deg,	J3=    -5.000 deg,
	J4=     0.000 deg,	J5=   -45.000 deg,	J6=    30.000 deg
};
"""
POINTS = HOME + point(2, 100.0, 0.0) + point(3, 200.0, 0.0) + point(4, 200.0, 100.0)
CASE = {
    "tools": {"UTOOL[1]": {"xyz": [0.0, 0.0, 0.1]}},
    "frames": {"UFRAME[1]": {"xyz": [0.5, 0.0, 0.2], "rpy": [0.0, 0.0, math.pi / 2]}},
}


def listing(body: str, points: str = POINTS) -> str:
    """A program whose lines begin at the sixth of the file."""
    lines = enumerate(body.strip("\n").split("\n"), 1)
    rows = [f"    {row}" if row.startswith(":") else f"{i:4d}:{row}" for i, row in lines]
    return f"{HEAD}{chr(10).join(rows)}\n/POS\n{points}/END\n"


def program(body: str, points: str = POINTS, **asked):
    return read("CELL.LS", listing(body, points), **{**CASE, **asked})


def place(move) -> list[float]:
    return move.to.pose[:3, 3].tolist()


def test_a_tool_that_only_the_controller_knows_is_that_of_the_point_and_told():
    body = FRAMES + "J P[1] 50% FINE ;\nIF DI[1]=ON,UTOOL_NUM=2 ;\nL P[2] 200mm/sec FINE ;"
    (told,) = (one for one in program(body).doubts if "UTOOL" in one)
    assert "P[2] is taken in the UTOOL that it was taught in: 'UTOOL_NUM' is given a value" in told
    assert not [
        one for one in program(body.replace("UTOOL_NUM=2", "DO[1]=ON")).doubts if "UTOOL" in one
    ]


def test_motions_in_frames_and_by_axes_become_moves_with_their_lines():
    body = """  !a remark ;
J P[1:HOME] 50% FINE    ;
L P[2] 250mm/sec CNT50 ACC100    ;
L P[3] 300cm/min CNT100 TB .10sec,CALL GRIP ;
DO[1:gun]=ON ;
C P[2]
: P[4] 100mm/sec FINE    ;
WAIT   1.50(sec) ;
"""
    found = program(FRAMES + body, zones={"CNT50": 0.02, "CNT": 0.01}, skip=["GRIP"])
    home, line, next_, arc, wait = found.moves
    degrees = [10.0, 20.0, -5.0, 0.0, -45.0, 30.0]
    assert np.degrees(home.to.axes) == pytest.approx(degrees) and home.share == 0.5
    assert [move.line.number for move in found.moves] == [9, 10, 11, 13, 15]
    assert [move.line.own for move in found.moves] == [4, 5, 6, 8, 10]
    # x of the frame is the robot's y
    assert place(line) == pytest.approx([0.5, 0.1, 0.25]) and line.tool[2, 3] == 0.1
    # R 90 in a frame turned by 90 degrees about z, after W 180: x back, y along, z down
    turned = np.array([[-1, 0, 0], [0, 1, 0], [0, 0, -1]])
    assert np.abs(line.to.pose[:3, :3] - turned).max() < 1e-12
    assert (line.speed, line.zone, line.to.name) == (0.25, 0.02, "P[2]")
    assert next_.speed == pytest.approx(0.05) and next_.zone == 0.01
    assert arc.via.pose[:3, 3] == pytest.approx([0.5, 0.1, 0.25])
    assert place(arc) == pytest.approx([0.4, 0.2, 0.25]) and wait == ControllerWait(
        Line(15, own=10), 1.5, reads_on=True
    )
    told = "\n".join(found.notes)
    assert "DO (line 12)" in told and "TB, TA, DB" in told


def test_loops_calls_and_registers_are_resolved():
    body = """R[2:speed]=100 ;
FOR R[1]=1 TO 2 ;
IF (R[1]=2) THEN ;
L P[3] R[2]mm/sec FINE ;
ELSE ;
L P[2] R[2]mm/sec FINE ;
ENDIF ;
ENDFOR ;
CALL SUB ;
L P[4] R[9]mm/sec FINE ;
"""
    sub = listing("L P[2] R[2]mm/sec FINE ;\nR[2]=50 ;", point(2, 0.0, 0.0)).replace("CELL", "SUB")
    found = read("CELL.LS", listing(FRAMES + body), {"SUB.LS": sub.encode()}, **CASE)
    assert [(move.line.file, move.line.number) for move in found.moves] == [
        *(("", 13), ("", 11), ("SUB.LS", 6), ("", 17))
    ]
    assert [move.speed for move in found.moves] == [0.1, 0.1, 0.1, None]
    assert place(found.moves[2]) == pytest.approx([0.5, 0.0, 0.25])
    assert any("assumed: line 17" in note for note in found.notes)


@pytest.mark.parametrize(
    ("loop", "ends"),
    [
        ("FOR R[1]=3 TO 1 ;\nL P[2] 9mm/sec FINE ;\nENDFOR ;", 3),
        ("FOR R[1]=1 TO 3 ;\nENDFOR ;", 3),
        ("FOR R[1]=1 TO 3 ;\nR[1]=3 ;\nENDFOR ;", 3),
        ("FOR R[1]=1 TO 3 ;\nR[1]=R[1]+4 ;\nENDFOR ;", 5),
        ("FOR R[1]=4 DOWNTO 2 ;\nR[1]=R[1]-1 ;\nENDFOR ;", 1),
    ],
)
def test_a_loop_counts_by_its_register_and_leaves_it_at_its_last_value(loop, ends):
    """It is set before the first pass, whether there is one or not."""
    decides = f"IF (R[1]={ends}) THEN ;\nL P[3] 9mm/sec FINE ;\nENDIF ;\n"
    (move,) = program(f"{FRAMES}R[1]=0 ;\n{loop}\n{decides}").moves
    assert move.to.name == "P[3]"


def test_a_register_may_hold_the_number_of_a_point():
    body = f"""{FRAMES}FOR R[1:row]=2 TO 4 ;
L P[R[1:row]] 100mm/sec FINE ;
ENDFOR ;
C P[R[1]:end] P[2] 100mm/sec FINE ;
CALL SUB(3) ;
"""
    sub = listing("L P[AR[1]] 100mm/sec FINE ;", point(3, 0.0, 0.0)).replace("CELL", "SUB")
    found = read("CELL.LS", listing(body), {"SUB.LS": sub.encode()}, **CASE).moves
    assert [one.to.name for one in found] == ["P[2]", "P[3]", "P[4]", "P[2]", "P[3]"]
    assert place(found[1]) == pytest.approx(
        place(program(FRAMES + "L P[3] 9mm/sec FINE ;").moves[0])
    )
    assert place(found[4]) == pytest.approx([0.5, 0.0, 0.25]) and found[3].via.name == "P[4]"


@pytest.mark.parametrize(
    ("before", "motion", "told"),
    [
        ("", "L P[R[1]] 9mm/sec FINE ;", "the number of P[…] is not known: 'R[1]' is in no file"),
        ("R[1]=2.5 ;", "L P[R[1]] 9mm/sec FINE ;", "P[2.5]: no position of it under /POS"),
        ("R[1]=2 ;", "L PR[R[1]] 9mm/sec FINE ;", "PR[2]: a position register"),
        ("R[1]=2 ;\nP[2]=P[3] ;", "L P[R[1]] 9mm/sec FINE ;", "P[2] is given a value before"),
        ("", "L P[R[3]+1] 9mm/sec FINE ;", "the number of P[…] is not known: 'R[3]+1' is not read"),
        ("", "L P[2 9mm/sec FINE ;", "'L' is not understood"),
        ("R[2]=2 ;", "L P[R[R[2]]] 9mm/sec FINE ;", "the number of P[…] is not known: 'R[R[2]]'"),
    ],
)  # fmt: skip
def test_a_point_whose_number_is_not_known_or_has_no_position_is_refused(before, motion, told):
    said = refusal(program, f"{FRAMES}{before}\n{motion}\n")
    assert told in said and said.startswith("CELL.LS: ")


def test_other_groups_and_axes_are_external():
    turned = "\n   GP2:\n\tUF : 1, UT : 1,\t\n\tJ1=    30.000 deg"
    rail = ",\n\tE1=   250.000  mm"
    (move,) = program(
        FRAMES + "L P[2] 100mm/sec FINE ;", point(2, 0.0, 0.0, more=rail + turned)
    ).moves
    assert move.to.external == {"E1": 250.0, "GP2J1": 30.0}


SKIP = ["JMP", "LBL", "IF", "TIMEOUT"]
"""No statement that decides which lines run is left out, even if asked."""

ON_THE_WAY = FRAMES + "R[1]=1 ;\nL P[2] 100mm/sec FINE TB .10sec,CALL SUB ;\n"
DECIDES = "IF (R[1]=1) THEN ;\nL P[3] 100mm/sec FINE ;\nENDIF ;\n"


def on_the_way(sub: str, after: str, points: str = POINTS, **asked):
    beside = {"SUB.LS": listing(sub, points).replace("CELL", "SUB").encode()}
    return read("CELL.LS", listing(ON_THE_WAY + after), beside, **{**CASE, **asked})


def test_a_program_that_a_motion_calls_on_its_way_runs_beside_the_others():
    """TA, TB and DB: it moves nothing, and what it changes is not known behind the motion."""
    found = on_the_way("WAIT 0.50(sec) ;\nOVERRIDE=50% ;\nR[2]=5 ;", DECIDES)
    assert len(found.moves) == 2
    assert "they move nothing: SUB (line 9)" in " ".join(found.notes)
    left_out = " ".join(found.left_out)
    assert "WAIT sec (SUB.LS line 6)" in left_out and "OVERRIDE (SUB.LS line 7)" in left_out
    refused = "IF decides on L at line 11.*program 'SUB' may change it at any time: 'R.1.' at SUB"
    assert re.search(refused, refusal(on_the_way, "R[1]=5 ;", DECIDES))
    assert "line 9: program 'SUB' moves the robot, or may" in refusal(on_the_way, L2 + " ;", "")
    for changed in ("P[2]=P[3] ;", "UTOOL[1]=PR[1] ;"):
        assert re.search(
            r"(given a value before|is set in the program)", refusal(on_the_way, changed, L2 + " ;")
        )


def test_what_a_motion_sets_on_its_way_is_not_known_behind_it():
    output = ON_THE_WAY.replace("CALL SUB", "DO[1]=ON")
    assert len(program(output + DECIDES).moves) == 2
    refused = r"'R\[1\]' is given a value on the way of a motion at line 9"
    assert re.search(refused, refusal(program, ON_THE_WAY.replace("CALL SUB", "R[1]=5") + DECIDES))


COUNT = "FOR R[1]=1 TO 2 ;\nENDFOR ;\n"

L2 = FRAMES + "L P[2] 100mm/sec FINE"


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (FRAMES + "L P[9] 100mm/sec FINE ;", "line 8: P[9]: no position of it under /POS"),
        (
            FRAMES + "L PR[1] 9mm/sec FINE ;",
            '{"PR[1]": {xyz: […], rpy: […]}}} in m and rad, as seen from the user frame in force',
        ),
        ("!pick\n 2:" + L2 + " ;", "line 6: '!pick' has no end; ';'"),
        (L2 + " TB .1sec,CALL X(1) Offset,PR[1] ;", "line 8: PR[1]: a position register is not in"),
        (L2 + " Offset ;", "line 8: OFFSET is not read, and may move the target or the way"),
        (
            FRAMES + "L P[2] 100mm/sec CNT100 ;",
            "line 8: CNT100 does not say where the corner begins; program: {zones: {CNT100: 0.05}}",
        ),
        (FRAMES + "L P[1] 100mm/sec FINE ;", "line 8: P[1] was taught in UTOOL 2, and UTOOL_NUM is 1"),
        (FRAMES + "L P[2] 0mm/sec FINE ;", "line 8: a speed of 0 mm/sec; more than 0"),
        ("UFRAME[1]=PR[5] ;\n" + L2 + " ;", "line 9: P[2]: UFRAME[1] is set in the program"),
        (
            "UFRAME_NUM=7 ;\nL P[5] 100mm/sec FINE ;",
            'line 7: P[5]: UFRAME[7] is not in a listing; program: {frames: {"UF',
        ),
        (FRAMES + "L P[6] 100mm/sec FINE ;", "line 8: P[6] has no X; a taught position"),
        (FRAMES + "A P[2] 100mm/sec FINE ;", "line 8: A with 1 points is not read"),
        ("WAIT DI[1]=ON ;", "line 6: WAIT waits for what is not known: only the controller knows DI[1]"),
        ("IF DI[1]=ON,JMP LBL[1] ;", "line 6: IF decides on JMP at line 6"),
        ("P[2]=P[5] ;\n" + L2 + " ;", "line 9: P[2] is given a value before"),
        ("JMP LBL[1] ;", "line 6: JMP goes to label 1, which is in no block around it"),
        (
            "WAIT DI[1]=ON TIMEOUT,LBL[1] ;",
            "TIMEOUT at line 6, and is not known: only the controller knows whether DI[1]=ON comes in time",
        ),
        (
            "CALL GRIP ;",
            "line 6: 'GRIP' is no known instruction, and may move the robot; program: {beside: [GRIP.LS]}",
        ),
        (" Weave Sine[5] ;", "line 6: 'WEAVE' is not understood"),
        (FRAMES + "L P[2] 100mm/sec ;", "line 8: 'L P[2] 100mm/sec' has no speed and end"),
        ("FOR R[1]=1 TO 2 ;\n" + L2 + " ;", "line 6: FOR has no ENDFOR; a whole file"),
        (
            f"R[1]=5 ;\nIF (DI[1]=ON) THEN ;\n{COUNT}ENDIF ;\nIF (R[1]=5) THEN ;\n{L2} ;\nENDIF ;",
            "line 11: IF decides on L at line 14, and is not known: 'R[1]' is given a value at line 8",
        ),
    ],
)  # fmt: skip
def test_what_a_listing_does_not_decide_is_refused_with_its_line(body, told):
    untaught = point(6, 0.0, 0.0).replace("    0.000  mm,\tY", " ********  mm,\tY")
    said = refusal(program, body, POINTS + point(5, 0.0, 0.0, 7) + untaught, skip=SKIP)
    assert said.startswith("CELL.LS: ") and told in said


def test_a_listing_that_is_cut_off_within_its_points_is_refused():
    text = listing(L2 + " ;")
    assert "no /END is in it" in refusal(read, "CELL.LS", text[: text.index("P[4:") + 40], **CASE)
    with pytest.raises(cl.ClearanceError, match=r"P\[2\] has no X"):
        read("CELL.LS", text.replace("  100.000  mm,", "  1e5  mm,"), **CASE)
    with pytest.raises(cl.ClearanceError, match="under /POS is no position"):
        read("CELL.LS", text.replace("};\n/END", "/END"), **CASE)


def names(body: str, beside=(), **asked) -> list[str]:
    """The points that a program goes to, with the frames of the case."""
    found = read("CELL.LS", listing(FRAMES + body), beside, **{**CASE, **asked})
    return [one.to.name for one in found.moves]


def go(number: int) -> str:
    return f"L P[{number}] 9mm/sec FINE ;\n"


@pytest.mark.parametrize(
    ("body", "points"),
    [
        (f"R[1]=0 ;\nLBL[1] ;\n{go(2)}{go(3)}R[1]=R[1]+1 ;\nIF R[1]<3,JMP LBL[1] ;\n{go(4)}", "2323234"),
        (f"R[1]=7 ;\nSELECT R[1]=1,JMP LBL[1] ;\n=7,JMP LBL[2] ;\nELSE,JMP LBL[3] ;\nLBL[1] ;\n{go(2)}"
         f"LBL[2] ;\n{go(3)}LBL[3] ;\n{go(4)}", "34"),
        (f"FOR R[1]=1 TO 3 ;\n{go(2)}IF R[1]=2,JMP LBL[9] ;\n{go(3)}ENDFOR ;\nLBL[9] ;\n{go(4)}", "2324"),
        (f"R[1]=1 ;\nIF (R[1]=1) THEN ;\nJMP LBL[9] ;\nENDIF ;\n{go(2)}LBL[9] ;\n{go(4)}", "4"),
        # a loop with the way out at its top
    ],
)  # fmt: skip
def test_a_jump_that_the_file_decides_is_followed(body, points):
    assert names(body) == [f"P[{one}]" for one in points]


@pytest.mark.parametrize(
    ("body", "told"),
    [
        (f"JMP LBL[1] ;\nFOR R[1]=1 TO 2 ;\nLBL[1] ;\n{go(2)}ENDFOR ;\n",
         "line 8: JMP goes to label 1, which is in no block around it; a label of"),
        (f"{go(2)}LBL[1] ;\n{go(3)}LBL[1] ;\nJMP LBL[1] ;", 
         "line 11: label 1 is there twice; one of them: the other is at line 9"),
        (f"IF DI[1]=ON,JMP LBL[1] ;\n{go(2)}LBL[1] ;\n",
         "IF decides on JMP at line 8, and is not known: only the controller knows DI[1]"),
        (f"IF R[1]=2,JMP LBL[1] ;\n{go(2)}LBL[1] ;\n",
         "IF decides on JMP at line 8, and is not known: 'R[1]' is in no file"),
        (f"JMP LBL[R[1]] ;\n{go(2)}LBL[1] ;\n", "the label of JMP is not known: 'R[1]' is in no file"),
        (f"LBL[1] ;\n{go(2)}R[1]=R[1]+DI[1] ;\nIF R[1]<3,JMP LBL[1] ;\n",
         "IF decides on JMP at line 11, and is not known"),
        (f"R[1]=0 ;\nLBL[1] ;\n{go(2)}R[1]=R[1]+1 ;\nR[2]=R[1] ;\nJMP LBL[1] ;\n",
         "a loop by JMP that repeats none of its first 1,000 passes; write a loop that ends, or set 'R[1]'"),
        ("LBL[R[1]] ;\n" + go(2), "'LBL' is not understood, and decides which lines run; a copy"),
    ],
)  # fmt: skip
def test_a_jump_that_the_file_does_not_decide_is_refused(body, told):
    assert told in refusal(names, body, skip=["JMP", "IF", "LBL"])


def test_a_program_that_jumps_back_to_its_top_is_measured_until_a_pass_repeats_one():
    """The way from the last point to the first is measured, and the turn at either."""
    found = program(f"{FRAMES}J P[2] 9% FINE ;\nLBL[1:main] ;\n{go(3)}{go(4)}JMP LBL[1] ;\n{go(2)}")
    assert [one.to.name for one in found.moves] == ["P[2]", "P[3]", "P[4]", "P[3]", "P[4]"]
    assert "repeats one that is: JMP (line 12), of which 2 are measured" in "\n".join(found.notes)
    assert found.left_out == (
        "further passes of an endless loop JMP (line 12), of which 2 are measured",
    )
    # a way that only the first pass goes, and one to and fro
    once = f"R[1]=0 ;\nLBL[1] ;\nIF R[1]>0,JMP LBL[2] ;\n{go(2)}LBL[2] ;\nR[1]=1 ;\n{go(3)}{go(4)}JMP LBL[1] ;\n"
    assert names(once) == ["P[2]", "P[3]", "P[4]", "P[3]", "P[4]"]
    turns = "R[1]=2 ;\nLBL[1] ;\nL P[R[1]] 9mm/sec FINE ;\nR[1]=5-R[1] ;\nJMP LBL[1] ;\n"
    assert names(turns) == ["P[2]", "P[3]", "P[2]"]


def test_a_corner_between_two_passes_is_measured_by_each_way_that_leads_there():
    """Both passes end at P[3]; only the second comes there from P[2], through the corner to P[4]."""
    body = f"R[1]=0 ;\nLBL[1] ;\n{go(4)}IF R[1]>0,JMP LBL[2] ;\n{go(3)}R[1]=1 ;\nJMP LBL[1] ;\nLBL[2] ;\n"
    body += f"{go(2)}L P[3] 9mm/sec CNT50 ;\nJMP LBL[1] ;\n"
    passes = ["P[4]", "P[3]", *["P[4]", "P[2]", "P[3]"] * 2]
    assert names(body, zones={"CNT50": 0.02}) == passes
    assert names(body.replace("CNT50", "FINE")) == passes[:5]


@pytest.mark.parametrize("changed", ["UFRAME[1]=PR[5]", "UTOOL[1]=PR[5]", "P[2]=P[3]"])
def test_what_a_called_program_may_change_is_not_known_in_it_nor_behind_it(changed):
    sub = f"IF (DI[1]=ON) THEN ;\n{changed} ;\nENDIF ;\n"
    for body, after in ((sub, go(2)), (sub + go(2), "")):
        beside = {"SUB.LS": listing(body).replace("CELL", "SUB").encode()}
        assert re.search(
            r"(given a value before|is set in the program)",
            refusal(names, f"CALL SUB ;\n{after}{go(4)}", beside),
        )


def at_point(*block: str) -> str:
    """A motion with lines that run at its end, as a listing shows them below it."""
    return "".join(
        f"{one} ;\n" for one in ("L P[2] 9mm/sec FINE TB .10sec,P-SPS", *block, "------")
    )


def test_lines_that_run_at_the_end_of_a_motion_move_nothing():
    lines = ("DO[15]=ON", "!a remark", "WAIT (DI[9])", "IF (DI[1]) THEN", "DO[2]=ON", "ENDIF")
    block = at_point(*lines, "WAIT .10(sec)", "OVERRIDE=50%")
    assert names(block + go(3)) == ["P[2]", "P[3]"]
    left_out = " ".join(program(FRAMES + block).left_out)
    assert "WAIT (line 11)" in left_out and "OVERRIDE (line 16)" in left_out
    for line in (go(3)[:-3], "END", "JMP LBL[1]", "CALL GRIP", "IF DI[1]=ON,CALL GRIP"):
        told = (
            r"program 'P-SPS of line 8' moves the robot, or may: (L|END|'END'|JMP|GRIP) at line 10"
        )
        assert re.search(told, refusal(names, f"{at_point('DO[1]=ON', line)}LBL[1] ;\n"))
    assert names(at_point("CALL GRIP") + go(3), skip=["GRIP"]) == ["P[2]", "P[3]"]
    with pytest.raises(cl.ClearanceError, match="line 8: P-SPS has no end; a line of dashes"):
        names(at_point("DO[1]=ON").replace("------ ;", ""))


@pytest.mark.parametrize("changed", ["UFRAME_NUM=2", "R[1]=3", "P[3]=P[2]", "UFRAME[1]=PR[1]"])
def test_what_lines_at_the_end_of_a_motion_change_is_not_known_behind_it(changed):
    body = f"R[1]=3 ;\n{at_point(changed)}L P[R[1]] 9mm/sec FINE ;\n"
    told = "may change it at any time|was taught|is given a value before|is set in the program"
    if changed == "UFRAME_NUM=2":  # the point says its own, and no controller accepts another
        assert names(body) == ["P[2]", "P[3]"]
    else:
        with pytest.raises(cl.ClearanceError, match=told):
            names(body)
