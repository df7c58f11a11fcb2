"""KRL: the moves that a program makes, by hand; a line for what its files do not decide."""

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

HEAD = """&ACCESS RVP
DEF weld( )
;FOLD INI;%{PE}
GLOBAL INTERRUPT DECL 3 WHEN $STOPMESS==TRUE DO IR_STOPM ( )
BAS (#INITMOV,0 )
;ENDFOLD (INI)
"""
POINTS = """DEFDAT weld PUBLIC
DECL E6AXIS XHOME={A1 0.0,A2 -90.0,A3 90.0,A4 0.0,A5 45.0,A6 0.0,E1 0.0}
DECL E6POS XP1={X 100.0,Y 0.0,Z 50.0,A 90.0,B 0.0,C 180.0,S 2,T 10,E1 0.0}
DECL FDAT FP1={TOOL_NO 2,BASE_NO 1,IPO_FRAME #BASE,POINT2[] " ",TQ_STATE FALSE}
DECL LDAT LCPDAT1={VEL 2.0,ACC 100.0,APO_DIST 8.0,APO_MODE #CDIS,ORI_TYP #VAR}
DECL FRAME GRID[2]
GRID[1]={X 0.0,Y 10.0,Z 0.0,A 0.0,B 0.0,C 0.0}
TOOL_DATA[2]={X 0.0,Y 0.0,Z 200.0,A 0.0,B 0.0,C 0.0}
BASE_DATA[1]={X 500.0,Y 0.0,Z 300.0,A 90.0,B 0.0,C 0.0}
ENDDAT
"""
FRAMES = "$TOOL={X 0,Y 0,Z 100,A 0,B 0,C 0}\n$BASE={X 500,Y 0,Z 300,A 90,B 0,C 0}\n"
DOWN = "A 0, B 0, C 180"


def program(body: str, points: str = POINTS, head: str = HEAD, **asked):
    """The program whose lines begin behind `HEAD`, of seven lines."""
    return read("weld.src", f"{head}{body}\nEND\n", {"weld.dat": points.encode()}, **asked)


def moves_of(body: str, **asked):
    return program(body, **asked).moves


def place(move) -> list[float]:
    return move.to.pose[:3, 3].tolist()


def test_an_inline_form_takes_tool_base_speed_and_corner_from_its_data():
    body = """PTP XHOME
;FOLD LIN P1 CONT Vel=0.5 m/s CPDAT1 Tool[2] Base[1];%{PE}
$BWDSTART=FALSE
LDAT_ACT=LCPDAT1
FDAT_ACT=FP1
BAS(#CP_PARAMS,0.5)
LIN XP1 C_DIS
;ENDFOLD
SLIN XP1 WITH $VEL = SVEL_CP(0.1, , LCPDAT1), $TOOL = STOOL2(FP1), $LOAD = SLOAD(FP1.TOOL_NO)
LIN XP1:GRID[1]"""
    found = program(body)
    home, line, slow, after = found.moves
    quarter = math.pi / 2
    assert home.to.axes == pytest.approx((0.0, -quarter, quarter, 0.0, quarter / 2, 0.0))
    assert (home.line.number, home.kind, home.share, home.to.name) == (7, "ptp", 1.0, "XHOME")
    # the base is turned by 90 degrees about z: its x is the robot's y
    assert place(line) == pytest.approx([0.5, 0.1, 0.35]) and line.tool[2, 3] == 0.2
    # A 90 in it makes 180 about z, then C 180 about the new x: x goes back, y stays, z looks down
    turned = np.array([[-1, 0, 0], [0, 1, 0], [0, 0, -1]])
    assert np.abs(line.to.pose[:3, :3] - turned).max() < 1e-12
    assert (line.line.number, line.zone, line.speed) == (13, 0.008, 0.5)
    assert (slow.speed, after.speed) == (0.1, 0.5)
    # 10 mm along y of XP1, which is the robot's y
    assert place(after) == pytest.approx([0.5, 0.11, 0.35])
    assert any("interrupts and triggers" in note and "line 4" in note for note in found.notes)


def test_calls_loops_and_what_stays_become_moves_with_their_lines():
    body = """$VEL.CP=0.2
LIN {X 0, Y 0, Z 100, A 0, B 0, C 180}
FOR I=0 TO 2 STEP 2
  stitch(I*10.0, 5)
ENDFOR
LIN_REL {Z 20} #TOOL
WAIT SEC 0.5
LIN {Y 7}
END
DEF stitch(at:IN, deep:IN)
  REAL at
  INT deep
  LIN {X at}
  LIN_REL {Z -deep}
"""
    first, one, _, two, down, back, wait, last = moves_of(FRAMES + body)
    numbers = [move.line.number for move in (first, one, two, down, back, last)]
    assert numbers == [10, 21, 21, 22, 14, 16]
    # x of the base is y of the robot
    assert place(one) == pytest.approx([0.5, 0.0, 0.4])
    assert place(two)[1:] == pytest.approx([0.02, 0.395])
    assert place(down) == pytest.approx([0.5, 0.02, 0.39])
    # the tool looks down: its z is the robot's -z; y of the base is -x of the robot
    assert place(back) == pytest.approx([0.5, 0.02, 0.37])
    assert place(last) == pytest.approx([0.493, 0.02, 0.37])
    assert np.array_equal(last.to.pose[:3, :3], back.to.pose[:3, :3]) and last.speed == 0.2
    assert wait == ControllerWait(Line(15), 0.5)


def test_arcs_turn_as_their_types_say_and_a_line_may_keep_the_tool():
    arc = f"CIRC {{X 10, Y 10, Z 0}}, {{X 20, Y 0, Z 0, {DOWN}}}\n"
    start = f"LIN {{X 0, Y 0, Z 0, {DOWN}}}\n"
    types = f"$ORI_TYPE=#CONSTANT\n{arc}$CIRC_TYPE=#PATH\n{arc}LIN {{X 0, Y 0, Z 0, {DOWN}}}"
    _, plain, constant, tangent, line = moves_of(FRAMES + start + arc + types)
    found = [move.orientation for move in (plain, constant, tangent, line)]
    assert found == ["to", "constant", "tangent", "constant"]
    assert plain.via.pose[:3, 3] == pytest.approx([0.49, 0.01, 0.3])


def test_a_spline_circle_whose_auxiliary_point_turns_the_tool_is_in_the_headline():
    start = f"SLIN {{X 0, Y 0, Z 0, {DOWN}}}\n"
    circle = "SCIRC {X 10, Y 10, Z 0, %s}, {X 20, Y 0, Z 0, " + DOWN + "}"
    assert program(FRAMES + start + circle % DOWN).doubts == ()
    (told,) = program(FRAMES + start + circle % "A -95, B 90, C 0").doubts
    assert "auxiliary point's orientation is not read" in told
    assert program(FRAMES + start + "$ORI_TYPE=#CONSTANT\n" + circle % "A -95").doubts == ()


def test_a_move_after_a_kept_rotation_counts_from_the_tool_as_it_is():
    body = f"""LIN {{X 0, Y 0, Z 0, {DOWN}}}
$ORI_TYPE=#CONSTANT
LIN {{X 9, Y 0, Z 0, A 0, B 90, C 0}}
LIN_REL {{Z 10}} #TOOL"""
    # the tool still looks down, along the robot's -z
    assert place(moves_of(FRAMES + body)[-1]) == pytest.approx([0.5, 0.009, 0.29])
    circle = f"$CIRC_TYPE=#PATH\nCIRC {{X 4, Y 4, Z 0}}, {{X 8, Y 0, Z 0, {DOWN}}}"
    with pytest.raises(cl.ClearanceError, match="the tool's pose before this move is not known"):
        moves_of(FRAMES + body.replace("LIN {X 9, Y 0, Z 0, A 0, B 90, C 0}", circle))


def test_whole_numbers_round_and_divide_as_such():
    points = POINTS.replace("ENDDAT", "DECL INT n=7\nDECL REAL half=2.0\nENDDAT")
    body = f"""INT m
E6POS p
m = 2.5
FOR i=1 TO 1
p = {{X 0, Y n/half, Z m, {DOWN}}}
p.X = 9
LIN {{X p.X/2, Y p.Y, Z n/m-i/2, {DOWN}}}
ENDFOR"""
    (move,) = program(FRAMES + body, points).moves
    # m is 3; of integers 7/3 is 2 and 1/2 is 0; parts of positions are real: 9/2 is 4.5, 7/2.0 is 3.5
    assert place(move) == pytest.approx([0.5 - 0.0035, 0.0045, 0.302])


COUNTED = "IF i==3 THEN\nPTP XHOME\nENDIF"
LOOPS = {
    "INT i\ni=0\nFOR i=3 TO 1\nPTP XHOME\nENDFOR\n": "'I' counted the loop at line 9",
    "INT i\nFOR i=1 TO 3\nENDFOR\n": "'I' counted the loop at line 8",
    "INT i\nFOR i=1 TO 3\ni=i+1\nENDFOR\n": "'I' counts the passes of a loop, and one of them changes it",
    "INT i\nFOR i=1 TO 3\nIF $IN[1] THEN\ni=2\nENDIF\nENDFOR\n": "the counter 'I' is not known",
}


@pytest.mark.parametrize("loop", LOOPS)
def test_the_counter_of_a_loop_that_has_ended_decides_nothing(loop):
    told = refusal(moves_of, loop + COUNTED)
    assert LOOPS[loop] in told and told.startswith("weld.src: ")
    assert len(moves_of("INT i\nFOR i=1 TO 9\nIF i==3 THEN\nEXIT\nENDIF\nENDFOR\n" + COUNTED)) == 1


def test_turns_of_a_joint_move_become_ranges_of_axes():
    body = (
        FRAMES
        + f"PTP {{X 0, Y 0, Z 0, {DOWN}, S 6, T 18}}\nLIN {{X 9, Y 0, Z 0, {DOWN}, S 0, T 18}}"
    )
    ptp, line = moves_of(body)
    below = [axis for axis, (low, high) in ptp.to.ranges.items() if high < 0.1 and low < -6.0]
    above = [axis for axis, (low, high) in ptp.to.ranges.items() if low > -0.1 and high > 6.0]
    assert (below, above) == ([2, 5], [1, 3, 4, 6])
    assert (ptp.to.is_behind, ptp.to.is_back, ptp.to.unchecked) == (False, False, "")
    assert not line.to.ranges and line.to.is_behind is None
    found = program(
        FRAMES + f"PTP {{X 0, Y 0, Z 0, {DOWN}, S 2, T 51}}"
    )  # of a palletiser of five axes
    assert found.doubts == (
        "line 9: S 2 and T 51 do not agree on the sign of A5: that of T is taken",
    )
    assert found.moves[0].to.ranges[5][0] < -1.0
    (over,) = moves_of(FRAMES + f"PTP {{X 0, Y 0, Z 0, {DOWN}, S 1, T 0}}")
    assert (over.to.is_behind, over.to.is_back, over.to.unchecked) == (True, None, "bit 1 of S 1")


def test_the_case_says_what_the_files_name_only():
    moves = "BAS(#TOOL,3)\n$BASE=BASE_DATA[9]\nLIN XP1 C_DIS\nPTP XP1 C_PTP\nPTP XP1 C_PTP C_DIS\n"
    body = moves + "IF $IN[1] THEN\n$OUT[2]=TRUE\nmsg[]=text[]\nENDIF\ngrip()"
    found = program(
        body,
        tools={"TOOL_DATA[3]": {"xyz": [0.0, 0.0, 0.05]}},
        frames={"BASE_DATA[9]": {"xyz": [1.0, 0.0, 0.0]}},
        zones={"C_DIS": 0.01, "C_PTP": 0.02},
        skip=["grip"],
    )
    line, ptp, both = found.moves
    assert place(line) == pytest.approx([1.1, 0.0, 0.05]) and line.tool[2, 3] == 0.05
    assert (line.zone, ptp.zone, both.zone) == (0.01, 0.02, 0.02)  # the larger one where both are
    assert any("GRIP (line 16)" in note for note in found.notes)


LINE = f"LIN {{X 0, Y 0, Z 0, {DOWN}}}"


@pytest.mark.parametrize(
    ("body", "told"),
    [
        ("PTP XP9", "line 7: the target is not known: 'XP9' is in no file that is given"),
        ("BAS(#TOOL,0)\n$BASE=BASE_DATA[7]\nLIN XP1", 'program: {frames: {"BASE_DATA[7]": {'),
        (FRAMES + "CIRC XP1,XP1,CA 90", "line 9: CA is not read; C_DIS, C_PTP, WITH, or nothing"),
        (FRAMES + "LIN XP1 C_DIS", "line 9: C_DIS: $APO.CDIS, its length, is not in the files"),
        (FRAMES + "$VEL.CP=0\nLIN XP1", "line 10: $VEL.CP is 0; more than 0"),
        (FRAMES + "PTP XHOME\nLIN {Z 500}", "line 10: the tool's pose before this move is not known"),
        (FRAMES + LINE + "\nLIN_REL {A 10}", "line 10: a relative move that turns the tool is not read"),
        (FRAMES + "$IPO_MODE=#TCP\nLIN XP1", "line 10: $IPO_MODE is #TCP: the tool may stand"),
        (FRAMES + "$TECH[1].MODE=#CYCLE\nLIN XP1", "line 10: $TECH[1] is on: it moves the tool beside its path"),
        (
            FRAMES + "$TECH=wave\nLIN XP1",
            "line 10: $TECH is not known: 'WAVE' is in no file that is given; set $TECH",
        ),
        (FRAMES + "$WORLD.X=1.0\nPTP XP1", "line 10: $WORLD is set"),
        (FRAMES + "PTP XP1\n$ROBROOT.Z=1.0\nPTP XP1", "line 11: $ROBROOT changes between moves"),
        (FRAMES + "$ROBROOT.Z=8E2\nPTP XP1", "base: {on: base, xyz: [0, 0, -0.8], rpy: [0, 0, 0]}"),
        (FRAMES + "$ORI_TYPE=#JOINT\nLIN XP1", "line 10: $ORI_TYPE is #JOINT"),
        (FRAMES + "LIN XHOME", "line 9: axes are given; X, Y, Z, A, B and C"),
        (FRAMES + LINE + "\nLIN_REL {X 1,E1 5}", "line 10: a relative move of external axes"),
        (
            FRAMES + "PTP XHOME\nLIN_REL {Z 100}",
            "line 10: the tool's pose before this move is not known: the one before ends at axes",
        ),
        (
            FRAMES + LINE + "\nPTP_REL {A6 15}",
            "line 10: the axes before this move are not known: the one before ends at a pose",
        ),
        (FRAMES + LINE + "\nPTP {A1 15}", "A6, and where it is before is not known: the one before"),
        ("PTP {A1 ATAN2(1,1)}", "line 7: a position is not known: ATAN2 is not read"),
        (FRAMES + f"CIRC $POS_ACT,{{X 0,Y 9,Z 0,{DOWN}}}", "line 9: the target is not known"),
        (
            "INTERRUPT DECL 4 WHEN $IN[1] DO off()\nEND\nDEF off()\nPTP XHOME",
            "INTERRUPT 'OFF' moves the robot, or may",
        ),
        (FRAMES + "SPLINE\nSPL XP1\nENDSPLINE", "line 9: a spline is not read"),
        ("n=RSI_MOVECORR()", "line 7: RSI_MOVECORR moves the robot, and its value is not read"),
        (
            "SIGNAL open $IN[7]\nIF open THEN\nPTP XHOME\nENDIF",
            "line 8: IF decides on PTP at line 9, and is not known: only the controller knows $IN[7]",
        ),
        ("WAIT FOR $IN[3]", "line 7: WAIT FOR waits for what is not known: only the controller knows $IN[3];"),
        (
            "grip()",
            "line 7: 'GRIP' is no known instruction, and may move the robot; program: {beside: [GRIP.src]}",
        ),
        ("BRAKE", "line 7: BRAKE stands outside of what an interrupt calls"),
        ("n=ACOS(2)", "line 7: ACOS is given data of another kind"),
        ("n=1\nIF n==1 AND TRUE THEN\nPTP XHOME\nENDIF", "line 8: 'AND' has no value for 1 and True"),
        ("FOR n={X 1} TO 3\nENDFOR", "line 7: the range of 'N' is {'X': 1.0}; a number"),
        ("SWITCH 1\nPTP XHOME\nCASE 1\nENDSWITCH", "line 8: SWITCH begins with a statement"),
        ("PTP XHOME WITH $ORI_TYPE.X.Y = 1", "line 7: '.' has no value for '#VAR' and 'X'"),
        ("n=3\nm=n\nLOOP\nn=n*n\nENDLOOP", "line 10: '*' has no value for"),
        ("n='B12'\nPTP {A1 n}", "line 8: a position is not known: N is given what is not read"),
        ("PTP {A1 0, A2 -90", "line 7: the line ends; ',' or '}' is needed"),
        ("FOR I=1 TO 3\nPTP XHOME", "line 7: FOR has no ENDFOR before 'END' at line 9"),
    ],
)  # fmt: skip
def test_what_the_files_do_not_decide_is_refused_with_its_line(body, told):
    text = f"{HEAD}{body}\n" + ("" if body.endswith("EN") else "END\n")
    said = refusal(read, "weld.src", text, {"weld.dat": POINTS.encode()})
    assert said.startswith("weld.src: ") and told in said


def test_what_changes_a_tool_or_a_base_in_force_leaves_their_data():
    change = "BAS(#TOOL,2)\nBAS(#BASE,1)\n$BASE.X=600\n$TOOL.Z=50\nBAS(#TOOL,0)\n$TOOL.X=9\n"
    body = f"{change}BAS(#TOOL,2)\nBAS(#BASE,1)\nLIN XP1\nBAS(#TOOL,0)\nLIN XP1"
    with_tool, without = moves_of(body)
    assert place(with_tool)[0] == pytest.approx(0.5) and with_tool.tool[2, 3] == 0.2
    assert np.array_equal(without.tool, np.eye(4))


def test_a_base_on_another_machine_is_refused():
    on = "DECL MACHINE_DAT MACHINE_DEF[2]\nMACHINE_DEF[2]={MECH_TYPE #EASYS}\nDECL X MACHINE_FRAME_DAT[2]\n"
    points = POINTS.replace("ENDDAT", on + "MACHINE_FRAME_DAT[1]={MACH_DEF_INDEX 2}\nENDDAT")
    body = "BAS(#TOOL,2)\nBAS(#BASE,1)\nLIN XP1"
    assert "line 8: base 1 is on machine 2" in refusal(program, body, points)
    assert program(body, points.replace("#EASYS", "#ROBOT")).moves
    units = {"units": {"MACHINE_DEF[2]": {"on": "turntable/plate"}}}
    more = f"{body}\nLIN_REL {{Z 10}}\nBAS(#BASE,0)\nLIN XP1"
    one, two, last = program(more, points, **units).moves
    assert (one.to.unit, two.to.unit, last.to.unit) == ("MACHINE_DEF[2]", "MACHINE_DEF[2]", "")
    stands = program(
        more, **{}
    ).moves  # BASE_DATA is seen from the plate as it is from the robot's foot
    for move, other in zip((one, two, last), stands, strict=True):
        assert np.array_equal(move.to.pose, other.to.pose)
    assert re.search(
        r"^weld\.src: line 9: ':' has no value for data of 7 parts and",
        refusal(program, f"{body.replace('LIN XP1', 'XP1=$BASE:XP1')}\nLIN XP1", points, **units),
    )
    assert "line 11: the tool's pose before this move is not known" in refusal(
        program, f"{body}\nBAS(#BASE,0)\nLIN_REL {{Z 10}}", points, **units
    )


KEPT = "DEFDAT CELL PUBLIC\nDECL GLOBAL BOOL high=TRUE\nDECL GLOBAL INT times=2\nENDDAT"
"""Values that the controller keeps between runs, in lines 2 and 3."""


@pytest.mark.parametrize(
    ("body", "line"),
    [
        ("b=high\nSWITCH b\nCASE TRUE\nPTP XHOME\nENDSWITCH\nPTP XHOME", 8),
        ("IF high THEN\nn=2\nELSE\nn=1\nENDIF\nIF n==2 THEN\nPTP XHOME\nENDIF\n", 12),
        ("up(high,n)\nIF n THEN\nPTP XHOME\nENDIF\n", 8),
        ("high=FALSE\nIF high THEN\nPTP XHOME\nENDIF\nPTP XHOME", 0),
        ("IF high THEN\n$OUT[1]=TRUE\nENDIF\nPTP XHOME", 0),
    ],
)
def test_a_branch_that_a_kept_value_decides_is_doubted(body, line):
    more = "END\nDEF up(a:IN,c:OUT)\nc=NOT a\nc=NOT c\n"
    beside = {"weld.dat": POINTS.encode(), "cell.dat": KEPT.encode()}
    found = read("weld.src", f"{HEAD}{body}\n{more}END\n", beside)
    told = f"line {line}: the way not taken is not measured; HIGH (cell.dat line 2) decides"
    assert [one.split(",")[0] for one in found.doubts] == [told] * bool(line)


@pytest.mark.parametrize(
    ("body", "line"),
    [
        ("n=1\nWHILE n<times\nPTP XHOME\nn=n+1\nENDWHILE", 8),
        ("n=1\nREPEAT\nPTP XHOME\nn=n+1\nUNTIL n>times", 8),
        ("times=2\nFOR n=1 TO times\nPTP XHOME\nENDFOR", 0),
        ("FOR n=1 TO times\n$OUT[1]=TRUE\nENDFOR\nPTP XHOME", 0),
    ],
)
def test_a_loop_whose_passes_a_kept_value_counts_is_doubted(body, line):
    beside = {"weld.dat": POINTS.encode(), "cell.dat": KEPT.encode()}
    found = read("weld.src", f"{HEAD}{body}\nEND\n", beside)
    told = f"line {line}: other numbers of passes are not measured; TIMES (cell.dat line 3) decides"
    assert [one.split(",")[0] for one in found.doubts] == [told] * bool(line)


@pytest.mark.parametrize(
    ("condition", "is_true"),
    [
        ("b==FALSE OR TRUE", False),  # as (FALSE == (FALSE OR TRUE)): comparisons bind least
        ("(b==FALSE) OR TRUE", True),
        ("NOT b==TRUE EXOR b", True),
        ("TRUE OR b AND b", True),
        ("6 B_AND 3 == 2", True),
        ("5 B_OR 3 B_EXOR 1 == 7", True),
        ("B_NOT 5 == -6", True),
    ],
)
def test_operators_bind_as_the_controller_has_it(condition, is_true):
    body = f"b=FALSE\nIF {condition} THEN\nPTP XHOME\nENDIF\nLIN XP1\n"
    assert len(program(f"{FRAMES}PTP XHOME\n{body}").moves) == 2 + is_true


def test_a_parameter_may_be_an_array_of_several_indices():
    body = "double(GRID[])\nPTP XHOME\nEND\nDEF double(a[,], b[], n:IN)\nn=1"
    assert len(program(body).moves) == 1


MACHINE = """DEFDAT $MACHINE PUBLIC
$ROBROOT={X 0.0,Y 0.0,Z 800.0,A 0.0,B 0.0,C 0.0}
$SERVO_MODE=1
ENDDAT
"""


def test_system_variables_that_are_not_followed_are_doubted():
    quiet = "$ADVANCE=3\n$TECH[1].MODE=#OFF\n$TECH[2].CLASS=#PATH\n$OUT[1]=TRUE\nPTP XHOME"
    assert program(quiet).doubts == ()
    (told,) = program("$SEN_PINT[1]=2\nPTP XHOME").doubts
    assert told == "system variables that are set, and not followed: $SEN_PINT (line 7)"
    world = {"base": {"on": "base", "xyz": [0, 0, -0.8]}}
    beside = {"weld.dat": POINTS.encode(), "machine.dat": MACHINE.encode()}
    (told,) = read("weld.src", f"{HEAD}{FRAMES}PTP XP1\nEND\n", beside, **world).doubts
    assert told.endswith("base in the program is taken for $WORLD")
