"""RAPID: the moves that a procedure makes, by hand; a line for what the file does not decide."""

from __future__ import annotations

import math
import re

import numpy as np
import pytest

import clearance as cl
from clearance.formats.program.controller_program import AxisTarget
from tests.formats.program.reading import read
from tests.formats.refusal import refusal

NONE = "[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]"
P = f"[[0,0,0],[1,0,0,0],[0,0,0,0],{NONE}]"
CELL = f"""%%%
  VERSION:1
  LANGUAGE:ENGLISH
%%%
MODULE MainModule(NOSTEPIN)
  PERS tooldata gun:=[TRUE,[[0,0,100],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
  TASK PERS wobjdata table:=[FALSE,TRUE,"",[[350,0,100],[1,0,0,0]],[[50,20,0],[0.707107,0,0,0.707107]]];
  CONST jointtarget home:=[[0,10,-20,0,90,0],{NONE}];
  CONST robtarget p10_Table:=[[100,0,0],[0,1,0,0],[0,0,-1,1],{NONE}];
  CONST robtarget p20:=[p10_table.trans,[1,0,0,0],[0,0,0,0],{NONE}];
  VAR num n:=2;
  PROC main()
    VAR num heights{{2}}:=[30,20];
    MoveAbsJ home\\NoEOffs, v200, fine, gun;
    FOR i FROM 1 TO n DO
      place heights{{i}};
    ENDFOR
    IF DI1=1 TPWrite "ready";
    WaitTime 0.5;
    MoveC Offs(p10_Table,50,50,0), offs(p10_table,100,0,0), v100\\V:=50, z10, gun\\WObj:=table;
    movel RelTool(p10_Table,0,0,-100\\Rz:=90), v100, fine, gun\\WObj:=table;
    ! an end
  ENDPROC
  PROC place(num dz)
    MoveJ Offs(p10_Table,0,0,dz), v1000, z50, gun\\WObj:=table;
    MoveL p10_Table, v100, fine, gun\\WObj:=table;
    SetDO do1, 1;
  ERROR
    RETRY;
  ENDPROC
ENDMODULE
"""


def place(target):
    return (1e3 * target.pose[:3, 3]).tolist()


def moves_of(body, data="", **asked):
    """The moves of a procedure of these statements, from line 3 on, after data."""
    text = f"MODULE M {data}\nPROC main()\n{body}\nENDPROC ENDMODULE"
    return read("a.mod", text, **asked).moves


def test_calls_and_loops_become_moves_with_their_lines():
    found = read("a.mod", CELL)
    assert [one.line.number for one in found.moves] == [14, 25, 26, 25, 26, 19, 20, 21]
    home, over, on, over_low, _, wait, arc, last = found.moves
    axes = [math.radians(one) for one in (0, 10, -20, 0, 90, 0)]
    assert isinstance(home.to, AxisTarget) and list(home.to.axes) == axes and home.to.external == {}
    # the table is turned by a quarter: its x is the base's y
    assert place(on.to) == pytest.approx([400, 120, 100]) and on.kind == "lin" and on.speed == 0.1
    assert np.allclose(on.to.pose[:3, :3], [[0, 1, 0], [1, 0, 0], [0, 0, -1]], atol=1e-6)
    assert place(over.to) == pytest.approx([400, 120, 130]) and over.kind == "ptp"
    assert place(over_low.to) == pytest.approx([400, 120, 120])
    assert [one.to.name for one in (on, over, over_low, arc, last)] == [
        *("p10_Table", "Offs(p10_Table, 0, 0, 30)", "Offs(p10_Table, 0, 0, 20)"),
        *("Offs(p10_table, 100, 0, 0)", "RelTool(p10_Table, 0, 0, -100, \\Rz:=90)"),
    ]
    assert place(arc.via) == pytest.approx([350, 170, 100])
    assert place(arc.to) == pytest.approx([400, 220, 100]) and arc.speed == 0.05
    assert arc.turn_speed == pytest.approx(math.radians(500))
    assert place(last.to) == pytest.approx([400, 120, 200])
    assert wait.seconds == 0.5 and wait.reads_on
    (stands,) = moves_of("WaitTime \\InPos, 0.5;")
    assert not stands.reads_on
    # a quarter about the tool's z, which looks down
    assert np.allclose(last.to.pose[:3, :3], np.diag([1, -1, -1]), atol=1e-6)
    assert home.tool[2, 3] == 0.1
    told = "\n".join(found.notes)
    assert "in cycles the way from its end to its beginning is not measured" in told
    assert "SetDO (line 27)" in told and "without moves: line 18" in told and "PERS data" in told


def test_a_zone_is_that_of_the_point_unless_the_tool_turns():
    _, over, _, over_low, _, _, arc, _ = read("a.mod", CELL).moves
    assert over.zone == 0.075  # how the tool stands before is not known
    assert over_low.zone == 0.05 and arc.zone == 0.015  # the tool turns after the arc
    sizes = [
        one.zone
        for one in moves_of(
            "\n".join(
                f"MoveL [[{i},0,0],[1,0,0,0],[0,0,0,0],{NONE}],v5,{zone},tool0;"
                for i, zone in enumerate(
                    ("fine", "z0", "z1", "z200", "fine", "[FALSE,7,70,0,0,0,0]\\Z:=8", "fine")
                )
            )
        )
    ]
    assert sizes == [0.0, 0.0003, 0.001, 0.2, 0.0, 0.008, 0.0]
    turning = f"MoveL [[9,0,0],[0,1,0,0],[0,0,0,0],{NONE}],v5,[FALSE,0,30,0,0,0,0],tool0;"
    _, over, _ = moves_of(f"MoveL {P},v5,fine,tool0;\n{turning}\nMoveL {P},v5,fine,tool0;")
    assert over.zone == 0.03  # the tool turns earlier than its point
    lines = [f"MoveL [[{i},0,0],[1,0,0,0],[0,0,0,0],{NONE}],v5,z20,tool0;" for i in range(3)]
    _, _, after_wait, _ = moves_of("\n".join([lines[0], "WaitTime 1;", *lines[1:]]))
    assert after_wait.zone == 0.02  # the tool does not turn while it waits


def test_flags_of_a_configuration_are_ranges_of_axes():
    target = f"[[0,0,0],[1,0,0,0],[1,-2,0,1],{NONE}]"
    one, two = moves_of(
        f"MoveJ {target},v5,fine,tool0;\nConfJ\\Off;\nMoveJ {target},v5,fine,tool0;"
    )
    degrees = {
        axis: tuple(round(math.degrees(end)) for end in ends)
        for axis, ends in one.to.ranges.items()
    }
    assert degrees == {1: (90, 180), 4: (-180, -90), 6: (0, 90), 5: (-180, 0)}
    assert (one.to.is_behind, one.to.is_back) == (False, False)
    assert two.to.ranges == {} and two.to.is_behind is None
    (three,) = moves_of(f"MoveJ {target.replace('[9E+09', '[100')},v5,fine,tool0;")
    assert sorted(three.to.ranges) == [1, 4, 6] and three.to.external == {"E1": 100.0}


def test_data_of_other_modules_and_of_the_case_are_found():
    beside = {
        "data.sys": f"MODULE D(SYSMODULE)\nCONST robtarget p:=[[1,2,3],q,[0,0,0,0],{NONE}];\n"
        "CONST orient q:=[1,0,0,0];\nPROC go()\nMoveL p,v100,fine,pen\\WObj:=desk;\nENDPROC\nENDMODULE".encode()
    }
    (move,) = read(
        "a.mod",
        "MODULE M PROC main() go; ENDPROC ENDMODULE",
        beside,
        tools={"Pen": {"xyz": [0.0, 0.0, 0.2]}},
        frames={"desk": {"xyz": [0.5, 0.0, 0.0]}},
    ).moves
    assert (move.line.file, move.line.number) == ("data.sys", 5)
    assert place(move.to) == pytest.approx([501, 2, 3]) and move.tool[2, 3] == 0.2


def test_statements_that_the_file_decides():
    line = f"MoveL [[x,0,0],[1,0,0,0],[0,0,0,0],{NONE}],v100,fine,tool0;"
    body = f"""VAR num x:=3; VAR bool up; up:=TRUE;
    WHILE x > 1 DO x:=x-1; {line} ENDWHILE
    TEST x CASE 1,2: x:=10; DEFAULT: x:=20; ENDTEST
    IF NOT up THEN RETURN; ELSEIF x=10 THEN Incr x; ENDIF {line}
    FOR i FROM 3 TO 2 DO Add x, i; ENDFOR {line}
    double x; {line}
    IF x>30 THEN EXIT; ENDIF {line}
    ENDPROC PROC double(INOUT num a) a:=a*2;"""
    xs = [round(place(one.to)[0]) for one in moves_of(body)]
    assert xs == [2, 1, 11, 16, 32]


def test_functions_run_once_wherever_they_stand():
    line = 'MoveL next(),v100,fine,tool0;\nTPWrite "x" \\Num:=moved();\n'
    more = f"ENDPROC\nFUNC robtarget next()\nn:=n+1;\nRETURN Offs({P},n,0,0);\nENDFUNC\nFUNC num moved()\n"
    more += f"MoveL Offs({P},0,n,0),v100,fine,tool0;\nRETURN n;\nENDFUNC\nPROC last()"
    found = [place(one.to) for one in moves_of(2 * line + more, "VAR num n:=0;")]
    assert found == [pytest.approx(one) for one in ([1, 0, 0], [0, 1, 0], [2, 0, 0], [0, 2, 0])]


def test_arguments_without_a_name_are_those_that_a_call_needs():
    line = f"MoveL Offs({P},dx,0,h),v100,fine,tool0;"
    more = f"ENDPROC PROC go(\\num up | num down, num dx)\nVAR num h:=1;\nIF Present(up) h:=up;\n{line}"
    found = moves_of("go 50;\ngo \\up:=5, 60;\n" + more, "VAR num dx:=9;")
    assert [place(one.to) for one in found] == [
        pytest.approx(one) for one in ([50, 0, 1], [60, 0, 5])
    ]


def test_an_argument_is_passed_on_if_it_is_given():
    data = 'VAR wobjdata high:=[FALSE,TRUE,"",[[0,0,50],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];'
    line = f"MoveL {P},v100,fine,tool0\\WObj?on;"
    more = (
        f"ENDPROC PROC go(\\wobjdata on)\nover \\on?on;\nENDPROC PROC over(\\wobjdata on)\n{line}"
    )
    found = moves_of("go;\ngo \\on:=high;\n" + more, data)
    assert [place(one.to)[2] for one in found] == [0.0, 50.0]


def test_a_field_is_that_of_its_own_record():
    records = "RECORD part num id; num count; num z; num x; ENDRECORD RECORD point num z; num x; num y; ENDRECORD "
    body = f"VAR robtarget p;\np:={P};\np.trans.x:=7;\nMoveL p,v100,fine,tool0;"
    (move,) = moves_of(body, records.split("RECORD point")[0])
    assert place(move.to) == pytest.approx([7, 0, 0])
    with pytest.raises(cl.ClearanceError, match="line 5: there is no part 'x'"):
        moves_of(body, records)  # which of them is meant is not known


def test_numbers_are_cut_and_rounded_to_their_digits():
    at = r"[[Trunc(12.39\Dec:=1),Round(12.35\Dec:=1),Trunc(-1.9)]"
    (move,) = moves_of(f"MoveL {at},{P.partition('],')[2]},v5,fine,tool0;")
    assert move.to.pose[:3, 3] == pytest.approx([0.0123, 0.0124, -0.001])


FAULTS = {
    f"MoveL {P},v100,fine,tool0": "line 4: 'ENDPROC' is given; ',', or ';' is needed",
    f"MoveL {P},v100,fine;": "line 3: MoveL has 3 of its arguments",
    f"MoveL {P},v100,fine,tool0\\WObj:=desk;": "line 3: the work object is not known: 'desk'",
    "MoveL p10,v100,fine,tool0;": "line 3: the target is not known: 'p10'",
    f"MoveL {P},v100,fine,tool0\\Corr;": "line 3: \\corr changes the way",
    "MoveL [[0,0,0],[0.5,0,0,0],[0,0,0,0],[0,0,0,0,0,0]],v100,fine,tool0;": "0] has length 0.5; length 1, q1",
    f"MoveL {P},fine,v100,tool0;": "line 3: MoveL is given data of another kind",
    f"MoveJ {P},[0,500,0,0],fine,tool0;": "line 3: the speed is 0 m/s; more than 0",
    "IF di1=1 THEN\nMoveL p,v100,fine,tool0;\nENDIF": "line 3: if decides on MoveL at line 4",
    "IF di1=1 RETURN;": "line 3: if decides on RETURN at line 3",
    "WHILE di1=0 DO ENDWHILE": "line 3: while waits for what is not known",
    "WaitDI di1, 1;": "line 3: WaitDI waits for what only the controller knows; skip: [WaitDI]",
    "GOTO again;": "line 3: 'GOTO' is not understood",
    "IF di1=1 ExitCycle;": "line 3: if decides on ExitCycle at line 3",
    "g_GripIn;": "line 3: 'g_GripIn' is no known instruction",
    "SingArea\\Wrist;": "not read; SingArea\\Off, so that the tool keeps its orientation",
    "SearchL di1,p,p,v10,tool0;": "line 3: SearchL changes where the robot goes",
    "FOR i FROM 1 TO 5 STEP 0 DO ENDFOR": "line 3: a step of 0",
    "TEST 1\nRETURN;\nCASE 1: ENDTEST": "line 4: test begins with a statement; CASE",
    "IF Present() RETURN;": "line 3: Present is given data of another kind",
    "VAR num i{0};": "line 3: an array of 0 items; 1 to 1000",
    "ENDPROC PROC main()": "line 3: 'main' is there twice",
}  # fmt: skip


@pytest.mark.parametrize("body", FAULTS)
def test_what_the_file_does_not_decide_is_refused_with_its_line(body):
    told = refusal(moves_of, body)
    assert FAULTS[body] in told and told.startswith("a.mod: ")


GLUE = f"MoveL {P},v100,fine,tool0;"
SYNC = {
    'MoveLSync P,v100,fine,tool0,"x";': "line 3: procedure 'x' moves the robot, or may: it is in no file",
    'MoveJSync P,v100,fine,tool0,"M:Go";': "procedure 'go' moves the robot, or may: MoveL at line 5",
    'MoveCSync P,P,v100,fine,tool0,"own";': "procedure 'M.own' moves the robot, or may: MoveL at line",
    "MoveLSync P,v100,fine,tool0,found();": "line 3: the procedure is not known: ",
    "MoveLSync P,v100,fine,tool0;": "line 3: MoveLSync names no procedure",
    'MoveLSync P,v100,fine,tool0,"change";MoveL P,v100,fine,t0;': "'change' may change it at any time: 't0'",
    'MoveLSync P,v100,fine,tool0,"change";IF n=1 go;': "procedure 'change' may change it at any time: 'n'",
}  # fmt: skip


@pytest.mark.parametrize("body", SYNC)
def test_a_procedure_that_a_move_calls_moves_nothing_and_changes_what_is_then_not_known(body):
    data = "PERS tooldata t0:=[TRUE,[[0,0,1],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]]; VAR num n:=1;"
    more = f"\nENDPROC\nPROC go() {GLUE} ENDPROC LOCAL PROC own() {GLUE} ENDPROC\nPROC change() n:=2;\n"
    more += (
        "t0.tframe.trans.z:=5; ENDPROC FUNC string found() RETURN NumToStr(1); ENDFUNC PROC last()"
    )
    told = refusal(moves_of, body.replace("P,", f"{P},") + more, data)
    assert SYNC[body] in told and told.startswith("a.mod: ")


UNDECIDED = {
    "VAR num x:=1;\nIF di1=1 x:=2;": "'x' is given a value at line 4",
    "VAR num x:=1;\nIF di1=1 Incr x;": "'x' is given a value at line 4",
    'VAR num x:=1;\nTPReadNum x,"how far";': "'x' is given a value by TPReadNum at line 4",
    'VAR num x:=1;\nIF di1=1 TPReadNum x,"how far";': "'x' is given a value at line 4",
    "VAR num x:=1;\nIF di1=1 double x;": "'x' is given a value at line 4",
    "VAR num x:=1;\nVAR bool ok;\nok:=found(x);": "'a' is given a value by StrToVal at line 12",
    "VAR num x:=1;\nIF di1=1 ConfJ\\Off;": "decides on ConfJ",
    "CONNECT i WITH t;\nx:=2;": "trap 't' may change it at any time: 'x' at line 13",
}


@pytest.mark.parametrize("body", UNDECIDED)
def test_what_only_the_controller_decides_is_never_taken_for_known(body):
    line = f"\nMoveL [[x,0,0],[1,0,0,0],[0,0,0,0],{NONE}],v100,fine,tool0;"
    more = "\nENDPROC\nPROC double(INOUT num a)\na:=a*2;\nENDPROC\nFUNC bool found(INOUT num a)\n"
    more += 'RETURN StrToVal("1",a);\nENDFUNC\nTRAP t x:=5; ENDTRAP PROC last()'
    assert UNDECIDED[body] in refusal(moves_of, body + line + more)


def test_modules_have_data_and_procedures_of_their_own():
    module = """MODULE {0}
    LOCAL CONST robtarget p:=[[{1},0,0],[1,0,0,0],[0,0,0,0],{2}];
    LOCAL VAR num x:={1};
    PROC {0}_go() go; over p; ENDPROC
    LOCAL PROC go() MoveL Offs(p,p.trans.x,x,0),v100,fine,tool0; ENDPROC
    LOCAL PROC over(robtarget on) MoveL on,v100,fine,tool0; ENDPROC
    ENDMODULE
    """
    text = "MODULE M PROC main() a_go; B_go; ENDPROC ENDMODULE "
    text += module.format("a", 1, NONE) + module.format("B", 2, NONE)
    found = read("a.mod", text).moves
    ends = [[2, 1, 0], [1, 0, 0], [4, 2, 0], [2, 0, 0]]
    assert [place(one.to) for one in found] == [pytest.approx(end) for end in ends]
    assert [one.to.name for one in found] == ["Offs(p, 1, 1, 0)", "on", "Offs(p, 2, 2, 0)", "on"]


def test_what_a_procedure_has_of_its_own_stays_there():
    line = f"MoveL [[x,0,0],[1,0,0,0],[0,0,0,0],{NONE}],v100,fine,tool0;"
    body = f"VAR num x:=7;\nFOR i FROM 1 TO 2 DO ENDFOR\nx:=x+i;\n{line}\ngo;\nENDPROC\nPROC go()\n{line}"
    found = moves_of(body, "VAR num x:=5; VAR num i:=3;")
    assert [round(place(one.to)[0]) for one in found] == [10, 5]


STANDS = {
    "tooldata t:=[FALSE,[[0,0,0],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]]": ("t", "wobj0", "the tool stands"),
    'wobjdata w:=[TRUE,TRUE,"",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]]': ("tool0", "w", "the robot holds"),
    'wobjdata w:=[FALSE,FALSE,"S",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]]': ("tool0", "w", "unit 'S' moves"),
}  # fmt: skip


@pytest.mark.parametrize("data", STANDS)
def test_tools_that_stand_and_work_that_moves_are_refused(data):
    tool, work, told = STANDS[data]
    with pytest.raises(cl.ClearanceError, match=f"line 3: .*{told}"):
        moves_of(f"MoveL {P},v100,fine,{tool}\\WObj:={work};", f"PERS {data};")


def test_what_moves_nothing_is_left_out_by_name():
    body = f"WaitDI di1,1;\nGRIP_IN;\nWHILE di1=0 DO ENDWHILE\nMoveL {P},v100,fine,tool0;"
    assert len(moves_of(body, skip=["WAITDI", "Grip_In", "while"])) == 1
    assert "skip: MoveL moves the robot" in refusal(moves_of, body, skip=["movel"])
    for word in ("GOTO", "EXITCYCLE"):  # it decides which lines run
        assert "decides which lines run; a copy of" in refusal(moves_of, f"{word} a;", skip=[word])


def test_a_trap_that_stops_the_robot_and_lets_it_go_on_moves_nothing():
    body = (
        f"CONNECT i WITH t;\nMoveL {P},v5,fine,tool0;\nENDPROC\nTRAP t\nStopMove;\n%sStartMove;\n"
    )
    text = f"MODULE M\nVAR intnum i;\nPROC main()\n{body}ENDTRAP ENDMODULE"
    found = read("a.mod", text % "")
    (told,) = found.doubts
    assert (
        told.startswith("StopMove (line 8) of trap t may stop the robot") and len(found.moves) == 1
    )
    assert found.left_out == ("StopMove (line 8) in trap t",)
    for more in ("ClearPath;\n", f"MoveL {P},v5,fine,tool0;\n"):
        assert re.search(
            r"trap 't' moves the robot, or may: \w+ at line 9", refusal(read, "a.mod", text % more)
        )


def test_orientations_are_multiplied():
    data, turn = f"VAR robtarget p:={P}; VAR orient o;", "OrientZYX(90,0,0)*OrientZYX(0,0,90)"
    (found,) = moves_of(f"o:={turn};\np.rot:=o;\nMoveL p,v100,fine,tool0;", data)
    assert found.to.pose[:3, :3] == pytest.approx(
        np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]]), abs=1e-12
    )


def test_a_procedure_is_left_out_only_if_it_moves_nothing():
    data = f"VAR robtarget p:={P};"
    body = "sub;\nMoveL p,v100,fine,tool0;\nENDPROC\nPROC sub()\nsub2;\nENDPROC\nPROC sub2()\n"
    told = "skip: sub moves the robot, .*: MoveL at line 10; skip only what moves nothing"
    assert re.search(told, refusal(moves_of, f"{body}MoveL p,v100,fine,tool0;", data, skip=["sub"]))
    with pytest.raises(cl.ClearanceError, match=r"line 4: the target is not known: .* at line 10"):
        moves_of(f"{body}p:=here;", data, skip=["sub"])
    assert len(moves_of(f"{body}SetDO do1,1;\nWorldAccLim\\On:=3;", data, skip=["sub"])) == 1


@pytest.mark.parametrize("call", ["find p;", "n:=find(p);", "find 1\\at:=p;", "find p.trans;"])
def test_what_a_procedure_in_no_file_may_have_changed_is_unknown(call):
    data, body = "%s robtarget p:=%s; VAR num n;", f"{call}\nMoveL p,v100,fine,tool0;"
    assert "line 4: the target is not known: 'p' is given a value by find" in refusal(
        moves_of, body, data % ("PERS", P), skip=["find"]
    )
    assert len(moves_of(body, data % ("CONST", P), skip=["find"])) == 1


def test_a_branch_that_persistent_data_decide_is_doubted():
    body = f"IF isup() THEN MoveL {P},v5,fine,tool0; ENDIF\nMoveL {P},v5,fine,tool0;\nENDPROC\n"
    body += "FUNC bool isup() RETURN up>1; ENDFUNC PROC last()"
    text = f"MODULE M %s num up:=2;\nPROC main()\n{body}\nENDPROC ENDMODULE"
    (told,) = read("a.mod", text % "TASK PERS").doubts
    assert told.startswith("line 3: the way not taken is not measured; up (line 1) decides")
    assert not read("a.mod", text % "CONST").doubts
