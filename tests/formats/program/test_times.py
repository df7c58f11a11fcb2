"""Times and speeds that programs state are followed; what takes a time that no file says is named."""

import pytest

from clearance.formats.program.controller_program import ControllerMove
from tests.formats.program.reading import read

UR_POSE = "p[0.5, 0, 0.5, 0, 3.1, 0]"
NONE = "[9E9,9E9,9E9,9E9,9E9,9E9]"
FANUC = """/PROG  TIMES
/MN
{body}
/POS
P[1]{{
   GP1:
\tUF : 0, UT : 0,
\tJ1= 0.0 deg, J2= 0.0 deg, J3= 0.0 deg, J4= 0.0 deg, J5= 0.0 deg, J6= 0.0 deg
}};
P[2]{{
   GP1:
\tUF : 0, UT : 0, CONFIG : 'N U T, 0, 0, 0',
\tX = 500.0 mm, Y = 0.0 mm, Z = 500.0 mm, W = 180.0 deg, P = 0.0 deg, R = 0.0 deg
}};
/END
"""


def ur(*lines: str, **asked):
    text = "\n".join(["set_tcp(p[0,0,0,0,0,0])", *lines])
    return read("a.script", text + "\n", **asked)


def rapid(*lines: str, **asked):
    data = f"CONST robtarget p1:=[[500,0,500],[0,1,0,0],[0,0,0,0],{NONE}];"
    joints = f"CONST jointtarget j1:=[[0,0,0,0,0,0],{NONE}];"
    body = "\n".join(lines)
    return read(
        "a.mod", f"MODULE A\n{data}\n{joints}\nPROC main()\n{body}\nENDPROC\nENDMODULE\n", **asked
    )


def fanuc(*lines: str, **asked):
    body = "\n".join(f"{i:4d}:{line} ;" for i, line in enumerate(lines, 1))
    return read("a.ls", FANUC.format(body=body), **asked)


def krl(*lines: str, **asked):
    body = "\n".join(["BAS(#INITMOV,0)", "$TOOL=$NULLFRAME", "$BASE=$NULLFRAME", *lines])
    return read("a.src", f"DEF a()\n{body}\nEND\n", **asked)


def moves(program) -> list[ControllerMove]:
    return [one for one in program.moves if isinstance(one, ControllerMove)]


AWAY = "{X 500, Y 0, Z 500, A 0, B 0, C 180}"


@pytest.mark.parametrize(
    ("program", "seconds"),
    [
        (lambda: ur(f"movel({UR_POSE}, a=1.2, v=0.1, t=20.6)"), 20.6),
        (lambda: ur("movej([0,0,0,0,0,0], a=1.4, v=1.05, t=18.6)"), 18.6),
        (lambda: ur("set_speed(0.5)", "movej([0,0,0,0,0,0], t=2)"), 4.0),
        (lambda: rapid("MoveL p1,v100\\T:=20.6,fine,tool0;"), 20.6),
        (lambda: rapid("VelSet 50,5000;", "MoveAbsJ j1,v100\\T:=2,fine,tool0;"), 4.0),
        (lambda: fanuc("L P[2] 20.6sec FINE"), 20.6),
        (lambda: fanuc("OVERRIDE=40%", "J P[1] 500msec FINE"), 1.25),
    ],
)  # fmt: skip
def test_a_time_that_a_move_states_is_its_time(program, seconds):
    (move,), left_out = moves(found := program()), found.left_out
    assert move.time == pytest.approx(seconds, rel=1e-12) and not left_out


@pytest.mark.parametrize(
    ("program", "speed"),
    [
        (lambda: ur("set_speed(0.5)", f"movel({UR_POSE}, v=0.1)"), 0.05),
        (lambda: rapid("MoveL p1,v100,fine,tool0;"), 0.1),
        (lambda: rapid("VelSet 50,5000;", "MoveL p1,v100\\V:=80,fine,tool0;"), 0.04),
        (lambda: rapid("VelSet 100,11;", "MoveL p1,v100,fine,tool0;"), 0.011),
        (lambda: fanuc("OVERRIDE=40%", "L P[2] 100mm/sec FINE"), 0.04),
        (lambda: fanuc("R[1]=40", "OVERRIDE=R[1]", "L P[2] 100mm/sec FINE"), 0.04),
        (lambda: krl("$OV_PRO=50", "$VEL.CP=0.1", f"LIN {AWAY}"), 0.05),
    ],
)  # fmt: skip
def test_a_share_of_all_speeds_counts(program, speed):
    (move,), left_out = moves(found := program()), found.left_out
    assert move.speed == pytest.approx(speed, rel=1e-12) and not left_out


def test_shares_of_all_speeds_count_for_joint_moves():
    (move,) = moves(ur("set_speed(0.5)", "movej([0,0,0,0,0,0], a=1.2, v=0.8)"))
    assert (move.axis_speed, move.axis_acceleration) == (0.4, 0.3)
    (move,) = moves(found := fanuc("OVERRIDE=40%", "J P[1] 50% FINE"))
    assert move.share == pytest.approx(0.2)
    assert "shares of all speeds are followed: OVERRIDE 40 (line 3)" in found.notes
    (move,) = moves(krl("$OV_PRO=50", "BAS(#VEL_PTP,60)", "PTP {A1 0,A2 0,A3 0,A4 0,A5 0,A6 0}"))
    assert move.share == pytest.approx(0.3)


UR_MOVE, RAPID_MOVE, FANUC_MOVE = (
    f"movel({UR_POSE})",
    "MoveL p1,v100,fine,tool0;",
    "L P[2] 9mm/sec FINE",
)


@pytest.mark.parametrize(
    ("program", "lacks"),
    [
        (lambda: ur(UR_MOVE, 'popup("go?", blocking=True)'), ["popup (line 3)"]),
        (lambda: ur(UR_MOVE, 'popup("go?", "a", False, False, True)'), ["popup (line 3)"]),
        (lambda: ur(UR_MOVE, 'popup("done")', "textmsg(1)"), []),
        (lambda: ur(UR_MOVE, "sync()"), ["sync (line 3)"]),
        (lambda: ur("while True:", UR_MOVE, "end"),
         ["further passes of an endless loop while (line 2), of which 2 are measured"]),
        (lambda: ur("thread t():", "set_speed(0.05)", "sleep(1)", "end", "run t()", UR_MOVE),
         ["the speed of set_speed (line 3) in thread t"]),
        (lambda: ur(UR_MOVE, 'x = request_boolean_from_primary_client("go?")'),
         ["request_boolean_from_primary_client (line 3)"]),
        (lambda: ur(UR_MOVE, "x = socket_read_string()"), ["socket_read_string (line 3)"]),
        (lambda: ur(UR_MOVE, "if get_standard_digital_in(1):", "sleep(3)", "end"), ["sleep (line 4)"]),
        (lambda: ur(UR_MOVE, "set_speed(read_input_float_register(1))"), ["the speed of set_speed (line 3)"]),
        (lambda: ur(UR_MOVE, "grip()", skip=["grip"]), ["grip (line 3)"]),
        (lambda: rapid(RAPID_MOVE, "Stop;", 'UIMsgBox "go";'), ["Stop (line 6)", "UIMsgBox (line 7)"]),
        (lambda: rapid("VAR num a;", RAPID_MOVE, "a:=UINumEntry();"), ["UINumEntry (line 7)"]),
        (lambda: rapid(RAPID_MOVE, "SetDO d,1;", "TPWrite t;"), []),
        (lambda: rapid("VelSet CSpeedOverride(),5000;", RAPID_MOVE), ["the speed of VelSet (line 5)"]),
        (lambda: rapid("AccSet 20,20;", RAPID_MOVE), ["what AccSet (line 5) sets"]),
        (lambda: rapid("SpeedLimAxis STN_1,1,30;", RAPID_MOVE), ["what SpeedLimAxis (line 5) sets"]),
        (lambda: rapid("MoveL\\Conc,p1,v100,fine,tool0;"), ["\\Conc (line 5)"]),
        (lambda: rapid('MoveLSync p1,v100,fine,tool0,"foo";', "ENDPROC", "PROC foo()"), ["MoveLSync (line 5)"]),
        (lambda: rapid('MoveLSync p1,v100,fine,tool0,"foo";', skip=["foo"]),
         ["foo (line 5)", "MoveLSync (line 5)"]),
        (lambda: rapid("ArcL p1,v100,s,w,fine,tool0;"), ["the speed of ArcL (line 5)"]),
        (lambda: fanuc(FANUC_MOVE, "UALM[1]"), ["UALM (line 4)"]),
        (lambda: fanuc(FANUC_MOVE, "DO[1]=ON"), []),
        (lambda: fanuc("LINEAR_MAX_SPEED=200", FANUC_MOVE), ["the speed of LINEAR_MAX_SPEED (line 3)"]),
        (lambda: fanuc("L P[2] R[1]mm/sec FINE"), ["the speed of line 3"]),
        (lambda: fanuc("IF DI[1]=ON,OVERRIDE=10%", FANUC_MOVE), ["the speed of OVERRIDE (line 3)"]),
        (lambda: rapid("IF DI1=1 THEN", "VelSet 10,5000;", "ENDIF", RAPID_MOVE), ["the speed of VelSet (line 6)"]),
        (lambda: fanuc("L P[2] R[1]sec FINE"), ["the speed of line 3"]),
        (lambda: fanuc(FANUC_MOVE + " PSPD50"), ["the speed of line 3"]),
        (lambda: fanuc(FANUC_MOVE + " ACC20"), ["what ACC20 (line 3) sets"]),
        (lambda: fanuc(FANUC_MOVE + " ACC100"), []),
        (lambda: krl("$RED_VEL=10", f"LIN {AWAY} WITH $VEL.CP=1.0"), ["what $RED_VEL (line 5) sets"]),
        (lambda: krl("$OV_APPL=20", f"LIN {AWAY} WITH $VEL.CP=1.0"), ["what $OV_APPL (line 5) sets"]),
        (lambda: krl(f"LIN {AWAY}"), ["the speed of line 5"]),
        (lambda: krl(f"LIN {AWAY} WITH $VEL.CP=1.0", "HALT", skip=["HALT"]), ["HALT (line 6)"]),
        (lambda: krl(f"LIN {AWAY} WITH $VEL.CP=1.0", "HALT"), ["HALT (line 6)"]),
    ],
)  # fmt: skip
def test_what_takes_a_time_that_no_file_says_is_named(program, lacks):
    assert list(program().left_out) == lacks
