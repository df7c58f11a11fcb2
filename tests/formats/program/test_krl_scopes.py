"""Scopes of KRL: which subprogram and which variable a name means in each file, by hand."""

from __future__ import annotations

import re

import pytest

import clearance as cl
from tests.formats.program.reading import read
from tests.formats.refusal import refusal

FRAMES = "$TOOL=$NULLFRAME\n$BASE=$NULLFRAME\n"
HOME = "PTP {A1 0,A2 -90,A3 90,A4 0,A5 45,A6 0}"


def at(y: object) -> str:
    return f"{{X 0,Y {y},Z 0,A 0,B 0,C 0}}"


def heights(body: str, more: str = "", **asked: str) -> list[float]:
    """Y [mm] of the moves of a.src; other files are given by their names, `_` for the dot."""
    beside = {name.replace("_", "."): text.encode() for name, text in asked.items()}
    found = read("a.src", f"DEF a()\n{body}\nEND\n{more}\n", beside).moves
    return [round(move.to.pose[1, 3] * 1e3, 6) for move in found]


def data(name: str, *rows: str) -> str:
    return "\n".join([f"DEFDAT {name}", *rows, "ENDDAT"])


@pytest.mark.parametrize("place", ["a_dat", "config_dat"])
def test_a_variable_of_a_procedure_is_not_known_in_those_that_it_calls(place):
    beside = {place: data("$CONFIG", "DECL INT m=300")}
    sub = f"DEF sub()\nLIN {at('m')}\nm=150\nEND"
    body = f"DECL INT m\n{FRAMES}m=20\nsub()\nLIN {at('m')}\nsub()"
    assert heights(body, sub, **beside) == [300, 20, 150]
    assert "line 11: Y of the target is not known: 'M' is in" in refusal(
        heights, body, sub.replace("m=150\n", "")
    )


B = f"DEF b()\nLIN {at(0)}\nc()\nEND\n"
C = f"DEF c()\nLIN {at(300)}\nEND\n"
OWN = f"DEF c()\nLIN {at(11)}\nEND"


def test_a_subprogram_is_known_in_its_own_file_only_unless_it_is_global():
    body = f"{FRAMES}c()\nb()"
    assert heights(body, OWN, b_src=B, c_src=C) == [11, 0, 300]
    assert heights(f"{FRAMES}b()\nc()", f"GLOBAL {OWN}", b_src=B) == [0, 11, 11]
    assert re.search(r"b.src line 3: 'C' .*beside: \[C.src\]", refusal(heights, body, OWN, b_src=B))
    what = "INTERRUPT DECL 9 WHEN $IN[1] DO c()\n"
    with pytest.raises(cl.ClearanceError, match="'C' moves the robot, or may"):
        heights(f"{FRAMES}{what}b()", OWN, b_src=B, c_src=C.replace("LIN", ";LIN"))


def test_data_are_known_in_their_own_file_only_unless_they_are_global():
    own, of_all = (f"DECL E6POS PT={at(y)}" for y in (10, 300))
    a, config = data("a", own), data("$CONFIG", of_all)
    b = "DEF b()\nPT.Y=PT.Y+1\nLIN PT\nEND"
    body = f"{FRAMES}LIN PT\nb()\nLIN PT\nLIN {{FRAME: X 0,Y PT.Y,Z 0,A 0,B 0,C 0}}"
    assert heights(body, a_dat=a, b_src=b, config_dat=config) == [10, 301, 10, 10]
    assert heights(body, config_dat=config, b_src=b, a_dat=a) == [10, 301, 10, 10]
    public = a.replace("DECL E6POS", "DECL GLOBAL E6POS")
    assert heights(body, b_src=b, a_dat=public) == [10, 11, 11, 11]
    with pytest.raises(cl.ClearanceError, match=r"b.src line 2: .*'PT' is in no file"):
        heights(body, a_dat=a, b_src=b.replace("PT.Y=PT.Y+1", "LIN PT"))
    far = {"a_dat": a.replace("PT", "PICKPOSITION"), "b_src": "DEF b()\nLIN PICKPOSITION\nEND"}
    assert "'PICKPOSITION' is in no file that is given; a target" in refusal(
        heights, f"{FRAMES}b()", **far
    )
    tool = "DECL FRAME T1={X 0,Y 0,Z %d,A 0,B 0,C 0}"
    more = {"a_dat": data("a", tool % 100), "config_dat": data("$CONFIG", tool % 300)}
    beside = {name.replace("_", "."): text.encode() for name, text in more.items()}
    text = f"DEF a()\n{FRAMES}$TOOL=T1\nLIN {at(0)}\nb()\nLIN {at(0)}\nEND\n"
    found = read("a.src", text, {**beside, "b.src": b"DEF b()\n$TOOL=T1\nEND"}).moves
    assert [move.tool[2, 3] for move in found] == [0.1, 0.3]


@pytest.mark.parametrize("name", ["Y", "I", "PT"])
def test_names_in_brackets_within_an_aggregate_are_no_parts_of_it(name):
    own = data("b", f"DECL REAL {name}=1.0", "DECL INT n=2", "DECL INT list[2]", "list[2]=7")
    b = f"DEF b()\nLIN {{E6POS: X 0,Y list[n]+two(0,n),Z {name},A 0,B 0,C 0}}\nEND\n"
    b += "DEFFCT INT two(p:IN,q:IN)\nINT p,q\nRETURN q\nENDFCT"
    other = data("$CONFIG", "DECL INT n=1", f"DECL REAL {name}=5.0")
    assert heights(f"{FRAMES}b()", b_src=b, b_dat=own, config_dat=other) == [9]


def test_two_subprograms_of_a_name_that_one_file_would_know_are_refused():
    body = f"{FRAMES}c()"
    for more, beside, line in (
        ("", {"c_src": C, "d_src": "DEF d()\nEND\nGLOBAL " + OWN}, "d.src line 3"),
        (f"{OWN}\n{OWN}", {}, "line 9"),
        (f"GLOBAL {OWN}", {"c_src": C}, "line 6"),
    ):
        with pytest.raises(cl.ClearanceError, match=rf"^a.src: {line}: 'C' is there twice"):
            heights(body, more, **beside)


def test_data_of_a_name_that_two_files_give_to_all_are_not_known():
    points = (data(name, f"DECL GLOBAL E6POS PT={at(y)}") for name, y in (("b", 7), ("c", 300)))
    beside = dict(zip(("b_dat", "c_dat"), points, strict=True))
    told = "line 4: the target is not known: PT is declared at b.dat line 2 and at c.dat line 2"
    assert re.search(told, refusal(heights, f"{FRAMES}LIN PT", **beside))
    assert heights(f"{FRAMES}LIN {at(5)}", **beside) == [5]
    assert heights(f"{FRAMES}LIN PT", a_dat=data("a", f"DECL E6POS PT={at(3)}"), **beside) == [3]


def test_a_variable_that_is_imported_is_not_known():
    of_all, own = data("$CONFIG", "DECL INT m=300"), data("b", "IMPORT INT m IS /R1/c..m", "IMPORT")
    b = f"DEF b()\nLIN {at('m')}\nEND"
    assert re.search(
        r"b.src line 2: .* is not known: IMPORT is not read",
        refusal(heights, f"{FRAMES}b()", b_src=b, b_dat=own, config_dat=of_all),
    )
    assert heights(f"{FRAMES}b()\nLIN {at('m')}", b_src=b, config_dat=of_all) == [300, 300]


WHEN = "INTERRUPT DECL 9 WHEN $IN[2] DO "


def test_an_interrupt_in_a_branch_that_only_the_controller_decides_is_followed():
    """Its routine moves nothing, changes variables at any time, and is asked in what is left out too."""
    routine = "DEF c()\nPTP {A1 9}\nEND\nDEF d()\nINTERRUPT DECL 8 WHEN $IN[3] DO c()\nEND\n"
    for declared in (WHEN + "c()", f"GLOBAL {WHEN}d()"):
        branch = f"DEF a()\nIF $IN[1] THEN\n{declared}\nENDIF\n{HOME}\nEND\n{routine}"
        assert "line 2: IF decides on INTERRUPT at line 3" in refusal(read, "a.src", branch)
        skipped = f"DEF a()\nb()\n{HOME}\nEND\nDEF b()\n{declared}\nEND\n{routine}"
        told = refusal(read, "a.src", skipped, skip=["b"])
        assert re.search(r"line 2: INTERRUPT '[CD]' moves the robot, or may", told)
    text = f"DEF a()\nIF $IN[1] THEN\n{declared}\nENDIF\nn=1\n{HOME}\nPTP {{A1 n}}\nEND\n"
    text += "DEF d()\nn=2\nEND\n"
    assert "INTERRUPT 'D' may change it at any time" in refusal(read, "a.src", text)
    assert len(read("a.src", text.replace("\nn=2", "\nm=2")).moves) == 2
    itself = f"DEF a()\n{declared}\n{HOME}\nEND\nDEF d()\n{declared}\nEND\n"
    assert len(read("a.src", itself).moves) == 1


INI = """IF ARC20==TRUE THEN
A20 (ARC_INI)
INTERRUPT DECL 6 WHEN $CYCFLAG[3]==FALSE DO A20(TECH_STOP2)
ENDIF
IF A10_OPTION==#ACTIVE THEN
INTERRUPT DECL 4 WHEN $CYCFLAG[2]==FALSE DO A10 (#APPL_ERROR)
A10_INI ( )
ENDIF
IF H70_OPTION THEN
INTERRUPT DECL 15 WHEN $MEAS_PULSE[TOUCH_I[TOUCH_ACTIVE].IN_NR] DO H70 (6,CD0 )
H70 (1,CD0 )
ENDIF
"""


def test_packages_that_an_ini_initialises_are_taken_to_move_nothing_and_told():
    text = f"DEF a()\n{INI}{HOME}\nEND\n"
    (told,) = read("a.src", text).doubts
    assert told == (
        "packages that are in no file are taken to move nothing, and to set neither tool nor base: "
        "A20 (line 3), A10 (line 7), A10_INI (line 8), H70 (line 11)"
    )
    known = read("a.src", text, {"$config.dat": b"DEFDAT $CONFIG\nBOOL ARC20=TRUE\nENDDAT\n"})
    assert known.doubts == (told,)
    for name in ("A20", "H70"):
        moving = {f"{name}.src": f"DEF {name}(n,m)\n{HOME}\nEND\n".encode()}
        with pytest.raises(cl.ClearanceError, match=rf"IF decides on (PTP at {name}|INTERRUPT)"):
            read("a.src", text, moving)
    for call in ("A20(ARC_ON)", "H70(2,CD0)", "A10(#APPL_ERROR)", "A20()", "USER_GRP(0)"):
        name = call.partition("(")[0]
        with pytest.raises(cl.ClearanceError, match=rf"'{name}' is no known .* skip: \[{name}\]"):
            read("a.src", text.replace(HOME, f"{call}\n{HOME}"))


def test_a_branch_of_unknown_routines_says_what_gets_past_it():
    text = f"DEF a()\nIF n==1 THEN\nb(1)\nc()\nENDIF\n{HOME}\nEND\n"
    with pytest.raises(cl.ClearanceError) as caught:
        read("a.src", text)
    assert str(caught.value).endswith(
        "line 2: IF decides on B at line 3, and is not known: 'N' is in no file that is given; let the file "
        'decide it, or program: {variables: {"N": …}}, if it holds that until these files change it, or program: '
        "{beside: [B.src, C.src]}, or skip: [B, C] if they neither move nor set tool, "
        "frame or variables"
    )
    assert len(read("a.src", text, skip=["b", "C"]).moves) == 1
    assert re.search(
        r"let the file decide it, or program: {variables: {\"N\": …}}, if it holds .* it$",
        refusal(read, "a.src", text.replace("c()", HOME)),
    )
