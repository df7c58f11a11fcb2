"""KRL: what runs beside the program or by a jump, and what is left out."""

from __future__ import annotations

import math
import re

import pytest

import clearance as cl
from tests.formats.program.reading import read
from tests.formats.program.test_krl import FRAMES, HEAD, POINTS, program
from tests.formats.refusal import refusal

WHEN = "TRIGGER WHEN DISTANCE=0 DELAY=0 DO"


@pytest.mark.parametrize(
    "body", ["INTERRUPT DECL 10 WHEN $IN[1] DO", "GLOBAL INTERRUPT DECL 9 WHEN $IN[1] DO", WHEN]
)
def test_what_runs_beside_the_program_moves_nothing(body):
    beside = "END\nDEF away()\nBRAKE\nLIN XP1\nEND\nDEF lamp()\n$OUT[1]=TRUE\n"
    for name, told in (("away", "LIN at line 12"), ("off", "it is in no file that is given")):
        said = refusal(program, f"{body} {name}()\nPTP XHOME\n{beside}")
        assert "line 7: " in said and f" or may: {told}" in said
    found = program(f"{body} lamp()\n{body} IR_STOPM()\nPTP XHOME\n{beside}")
    assert len(found.moves) == 1
    assert any("LAMP (line 7), IR_STOPM (line 8)" in note for note in found.notes)


def angles(body: str, **asked) -> list[float]:
    """A1 [degrees] at the ends of moves; `go(1)` in a body is a move."""
    text = re.sub(r"go\((\w+)\)", r"PTP {A1 \1,A2 0,A3 0,A4 0,A5 0,A6 0}", body)
    return [round(math.degrees(one.to.axes[0]), 6) for one in program(text, **asked).moves]


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("go(1)\nGOTO over\ngo(2)\nOver:\ngo(3)", [1, 3]),
        ("n=0\nagain:\nn=n+1\ngo(n)\nIF n<3 THEN\ngoto again\nENDIF", [1, 2, 3]),
        ("FOR n=1 TO 5\ngo(n)\nIF n==2 THEN\nGOTO out\nENDIF\nENDFOR\nout:\ngo(9)", [1, 2, 9]),
        ("again:\ngo(1)\ngo(2)\nGOTO again", [1, 2, 1, 2]),
        ("s()\ngo(3)\nEND\nDEF s()\nGOTO l\ngo(1)\nl:", [3]),
    ],
)
def test_jumps_go_to_the_labels_of_their_subprogram(body, found):
    assert angles(body) == found


def test_functions_of_angles_are_in_degrees():
    assert angles("n=ACOS(0.5)\ngo(n)\nn=TAN(45)\ngo(n)") == [60, 1]


def test_an_output_that_a_procedure_gives_back_is_one_that_other_lines_may_set():
    data = POINTS.replace("ENDDAT", "SIGNAL lamp $OUT[3]\nENDDAT")
    body = "lampset(lamp)\n$OUT[3]=FALSE\nIF lamp THEN\ngo(1)\nENDIF\ngo(2)\n"
    body += "END\nDEF lampset(o:OUT)\nDECL BOOL o\no=TRUE"
    assert "'$OUT[3]' is given a value by LAMPSET at line 7" in refusal(angles, body, points=data)
    assert angles(body, points=data, variables={"$OUT[3]": False}) == [2]
    taken = body.replace("$OUT[3]=FALSE\n", "")
    assert angles(taken, points=data, variables={"$OUT[3]": False}) == [1, 2]


LAMP = "SIGNAL lamp $OUT[3]\n%s\nIF lamp THEN\ngo(1)\nENDIF\ngo(2)"


@pytest.mark.parametrize(
    ("body", "ends"),
    [
        ("SIGNAL other $OUT[3]\nother=NOT lamp", [1, 2]),
        ("lamp=TRUE", [1, 2]),
        ("$OUT[4]=TRUE", [2]),
        ("IF $IN[1] THEN\nlamp=TRUE\nENDIF", r"'\$OUT\[3\]' is given a value at line 9"),
        (f"{WHEN} lamp=TRUE", "may change it at any time"),
        ("PULSE(lamp,TRUE,0.5)", "PULSE sets it at line 8"),
        ("SIGNAL all $OUT[1] TO $OUT[8]\nall=255", "may set it by a number that is not read"),
        ("n=3\ngrip($OUT[n])", r"\$OUT at line 9 may set it by a number that is not read"),
    ],
)  # fmt: skip
def test_an_output_of_the_case_holds_until_the_lines_change_it(body, ends):
    asked = {"variables": {"$OUT[3]": False}}
    if isinstance(ends, str):
        assert re.search(ends, refusal(angles, LAMP % body, **asked))
    else:
        assert angles(LAMP % body, **asked) == ends


@pytest.mark.parametrize("more", ["", "GOTO again\n"])
def test_a_loop_that_waits_for_another_value_than_the_case_has_is_refused(more):
    loop = "WAIT SEC 0.1\nIF $IN[1] THEN\n%s\nENDIF"
    body = (
        f"again:\n{loop % 'GOTO over'}\n{more}over:" if more else f"LOOP\n{loop % 'EXIT'}\nENDLOOP"
    )
    body += "\nPTP XHOME"
    told = r"(LOOP|GOTO) repeats itself without a move, and what lies behind it is not measured: \$IN\[1\]"
    assert re.search(rf"line \d+: {told}", refusal(program, body, variables={"$IN[1]": False}))
    assert len(program(body, variables={"$IN[1]": True}).moves) == 2
    moving = "LOOP\ngo(2)\ngo(1)\nIF $IN[1] THEN\nEXIT\nENDIF\nENDLOOP"
    assert angles(moving, variables={"$IN[1]": False}) == [2, 1, 2, 1]


def test_a_case_gives_inputs_and_variables_that_no_file_has():
    body = "IF NOT $IN[2] THEN\ngo(1)\nENDIF\nWAIT FOR $IN[2]==FALSE\n"
    body += "IF $IN[2] THEN\ngo(2)\nENDIF\nIF missing==3 THEN\ngo(3)\nENDIF\n"
    body += "IF unset THEN\ngo(4)\nENDIF\nIF $TIMER_FLAG[1] THEN\ngo(5)\nENDIF"
    data = POINTS.replace("ENDDAT", "DECL BOOL unset\nENDDAT")
    given = {"$in[2]": True, "missing": 3, "unset": True, "$TIMER_FLAG[1]": True}
    asked = {"points": data, "skip": ["WAIT FOR"]}
    assert angles(body, variables=given, **asked) == [3, 4, 5]
    for name in given:
        with pytest.raises(cl.ClearanceError, match=f"(?i)variables: {{{{0,1}}.{re.escape(name)}"):
            angles(body, variables={key: one for key, one in given.items() if key != name}, **asked)
    assert "1 is given; true or false" in refusal(angles, body, variables={"$IN[2]": 1})


def test_what_the_submit_interpreter_sets_may_change_at_any_time():
    body = f"{HEAD}IF $OUT[1] THEN\nPTP XHOME\nENDIF\nPTP XHOME\nEND\n"
    submit = b"DEF sps()\nLOOP\n$OUT[1]=TRUE\nENDLOOP\nEND\n"
    beside = {"weld.dat": POINTS.encode(), "sps.sub": submit}
    told = "sps.sub 'SPS' may change it at any time: '$OUT[1]' at sps.sub line 3"
    assert told in refusal(read, "weld.src", body, beside, variables={"$OUT[1]": False})


@pytest.mark.parametrize("word", ["ANIN", "DIGIN"])
def test_what_an_input_gives_a_value_again_and_again_may_change_at_any_time(word):
    body = f"REAL n\nn=0\n{word} ON n=1.0*$ANIN[1]+0\nIF n>3 THEN\ngo(2)\nENDIF\ngo(3)"
    assert re.search(f"{word} 'N at line 9' may change it at any time", refusal(angles, body))
    assert angles(f"n=3\n{word} OFF $ANIN[1]\ngo(n)") == [3]


def test_what_a_trigger_gives_a_value_may_change_at_any_time():
    for body in (f"go(1)\nn=1\n\n{WHEN} n=90", f"IF $IN[1] THEN\n{WHEN} n=90 PRIO=-1\nENDIF\nn=1"):
        told = r"line 11: .* TRIGGER 'N at line \d+' may change it at any time"
        assert re.search(told, refusal(angles, f"{body}\ngo(n)"))
    called = (
        "INTERRUPT DECL 4 WHEN $IN[2] DO c(n,2)\nn=1\ngo(n)\nEND\nDEF c(x:{}, y)\nINT x\nx=90\n"
    )
    assert angles(called.format("IN")) == [1]
    assert "may change it at any time" in refusal(angles, called.format("OUT"))
    assert angles(f"n=1\n{WHEN} $OUT[3]=TRUE\n{WHEN} m=2\ngo(n)") == [1]


def test_an_interrupt_that_brakes_stops_the_robot_on_its_way_and_is_told():
    body = "INTERRUPT DECL 20 WHEN $IN[20]==FALSE DO paro()\nPTP XHOME\nEND\nDEF paro()\n"
    stop = (
        "BRAKE (line 11) of INTERRUPT PARO may stop the robot: it is taken to go on along its way"
    )
    found = program(f"{body}BRAKE F\nHALT\nINTERRUPT ON 20")
    assert len(found.moves) == 1 and found.doubts == (stop,)
    within = "in INTERRUPT PARO"
    assert found.left_out == (f"BRAKE (line 11) {within}", f"HALT (line 12) {within}")
    unknown = f"{body}BRAKE\nlights()"
    told = refusal(program, unknown)
    assert re.search(r"INTERRUPT 'PARO' .*LIGHTS at line 12; .*skip: \[LIGHTS\]", told)
    for name in ("PARO", "lights"):
        found = program(unknown, skip=[name])
        assert len(found.moves) == 1 and found.doubts == (stop,)
    assert "PARO (line 7)" in program(unknown, skip=["PARO"]).left_out
    for last, told in (("RESUME", "or may: RESUME at line 12"), ("LIN XP1", "skip: PARO moves")):
        assert re.search(told, refusal(program, f"{body}BRAKE\n{last}", skip=["PARO"]))


@pytest.mark.parametrize("line", ["FIND(XP1)", "N=FIND(1,XP1)", "XP1=A(1) WHATEVER"])
def test_what_a_line_that_is_left_out_may_have_changed_is_unknown(line):
    body = f"{FRAMES}{line}\nLIN XP1"
    assert "'XP1' is given a value" in refusal(program, body, skip=["FIND", "XP1"])
