"""What a case gives beside a program: all of it counts, or is refused with the nearest name."""

from __future__ import annotations

import pytest

from clearance.errors import MissingKey
from clearance.formats.program.given import used
from tests.formats.program import test_fanuc, test_krl, test_rapid
from tests.formats.program.reading import reader_and_request
from tests.formats.refusal import refusal

SCRIPT = "movej([0,0,0,0,0,0])\nset_tcp(p[0,0,0.1,0,0,0])\nmovel(p[0.4,0,0.3,0,0,0])\n"
NO_TCP = "movej([0,0,0,0,0,0])\nmovel(p[0.4,0,0.3,0,0,0])\n"
RAPID = f"""MODULE M
PERS tooldata tWeld:=[TRUE,[[0,0,315],[1,0,0,0]],[1,[0,0,1],[1,0,0,0],0,0,0]];
PROC main() WaitDI di1,1; MoveL [[9,0,0],[1,0,0,0],[0,0,0,0],{test_rapid.NONE}],v100,z10,tWeld; ENDPROC
ENDMODULE"""
LISTING = test_fanuc.listing(
    test_fanuc.FRAMES + "L P[2] 100mm/sec CNT50 ;\nL P[3] 100mm/sec CNT20 ;"
)
KRL = f"{test_krl.HEAD}BAS(#TOOL,1)\nBAS(#BASE,0)\n$APO.CDIS=10\nLIN XP1 C_DIS\nPTP XP1 C_PTP\nEND"
CONFIG = {
    "weld.dat": test_krl.POINTS.encode(),
    "$config.dat": b"DEFDAT $CONFIG\nTOOL_DATA[1]={X 0,Y 0,Z 300,A 0,B 0,C 0}\nENDDAT\n",
}
AT = {"xyz": [0.0, 0.0, 0.4]}
WAIT, PTP = {"skip": ["waitdi"]}, {"zones": {"C_PTP": 0.05}}
IDLE = "it changes no move: the program does not use it, or says it itself; "


def check(name, text, beside=(), **asked):
    read, request = reader_and_request(name, text, beside, **asked)
    return used(request, read, read(request))


@pytest.mark.parametrize(
    ("name", "text", "beside", "asked", "told"),
    [
        ("a.script", SCRIPT, (), {"tools": {"tcp": AT}}, f"tools.tcp: {IDLE}without it"),
        ("a.mod", RAPID, (), {"skip": ["WaitDI", "WaitDO"]}, "'WaitDO' is in no file of it; did you mean 'WaitDI"),
        ("a.mod", RAPID, (), {**WAIT, "tools": {"tWled": AT}}, f"tools.tWled: {IDLE}did you mean 'tWeld'?"),
        ("a.mod", RAPID, (), {**WAIT, "zones": {"z10": 0.3}}, f"zones.z10: {IDLE}without it"),
        ("a.mod", RAPID, (), {**WAIT, "units": {"STN_1": {"on": "base"}}}, f"units.STN_1: {IDLE}without it"),
        ("weld.src", KRL, CONFIG, {**PTP, "tools": {"TOOL_DATA[1]": AT}}, f"tools.TOOL_DATA[1]: {IDLE}"),
        ("CELL.LS", LISTING, (), {"zones": {"CNT": 0.05}, "variables": {"R[1]": 3}}, f"variables.R[1]: {IDLE}"),
        ("weld.src", KRL, CONFIG, {**PTP, "variables": {"N": 3}}, f"variables.N: {IDLE}without it"),
        ("CELL.LS", LISTING, (), {"entry": "MAIN"}, "entry: there is no program 'MAIN'; valid: CELL"),
    ],
)  # fmt: skip
def test_a_value_that_changes_nothing_is_refused(name, text, beside, asked, told):
    given = test_fanuc.CASE if name == "CELL.LS" else {}
    assert told in refusal(check, name, text, beside, **given, **asked)


def test_values_that_the_program_uses_are_taken():
    check("a.script", NO_TCP, tools={"tcp": AT})
    check("weld.src", KRL, CONFIG, **PTP, frames={})
    check("CELL.LS", LISTING, **test_fanuc.CASE, zones={"CNT50": 0.05, "CNT": 0.02}, entry="cell")


def test_a_tool_of_the_case_that_replaces_the_files_stands_in_the_headline():
    found = check("a.mod", RAPID, **WAIT, tools={"TWELD": AT})
    (told,) = found.doubts
    assert found.moves[0].tool[2, 3] == 0.4
    assert told == "tools.TWELD of the case replaces tWeld at line 2, which the file gives"


@pytest.mark.parametrize(
    ("name", "text", "asked"),
    [
        ("CELL.LS", LISTING, '{frames: {"UFRAME[1]": {xyz: […], rpy: […]}}, zones: {CNT50: 0.05, CNT20: 0.05}}'),
        ("weld.src", KRL, '{tools: {"TOOL_DATA[1]": {xyz: […], rpy: […]}}, zones: {C_PTP: 0.05}}'),
    ],
)  # fmt: skip
def test_all_values_that_the_files_lack_are_asked_for_at_once(name, text, asked):
    beside = {"weld.dat": CONFIG["weld.dat"]} if name == "weld.src" else ()
    given = {"tools": test_fanuc.CASE["tools"]} if name == "CELL.LS" else {}
    reader, request = reader_and_request(name, text, beside, **given)
    said = refusal(reader, request, of=MissingKey)
    assert said.endswith(f"; program: {asked} in m and rad") and "line" in said
    reader, request = reader_and_request("a.script", NO_TCP)
    assert "tools: {tcp: {xyz: […]}}}, its pose on the flange" in refusal(
        reader, request, of=MissingKey
    )


HOLDS = "of the case, which is taken to hold that all the time, unless a wait needs another"
WAY = "the way not taken is not measured;"
INPUT = f"DI[1] {HOLDS}"
NEXT = "LBL[1] ;\nL P[3] 9mm/sec FINE ;"


@pytest.mark.parametrize(
    ("body", "given", "told"),
    [
        ("PR[1]=P[2] ;\nR[5]=0 ;\nIF DI[1]=ON,R[5]=9 ;\nPR[1,1]=R[5] ;\nL PR[1] 9mm/sec FINE ;", {"DI[1:]": False},
         [INPUT]),
        ("IF DI[1]=ON,UFRAME_NUM=2 ;\nPR[1]=P[2] ;\nL PR[1] 9mm/sec FINE ;", {"DI[1]": False}, [INPUT]),
        ("L P[R[1]] 9mm/sec FINE ;", {"R[1]": 3}, ["R[1] of the case"]),
        (f"IF DI[1]=ON OR DI[2]=ON,JMP LBL[1] ;\nL P[2] 9mm/sec FINE ;\n{NEXT}", {"DI[2]": False, "DI[1]": False},
         [f"DI[2] {HOLDS}"]),
        (f"F[1]=DI[2] ;\nIF F[1]=ON,JMP LBL[1] ;\nL P[2] 9mm/sec FINE ;\n{NEXT}", {"F[1]": False, "DI[2]": True},
         [f"DI[2] {HOLDS}"]),
    ],
)  # fmt: skip
def test_each_variable_of_the_case_that_moves_rest_on_stands_in_the_headline(body, given, told):
    text = test_fanuc.listing(test_fanuc.FRAMES + body, test_fanuc.POINTS)
    found = check("CELL.LS", text, variables=given, **test_fanuc.CASE)
    rest = [one for one in found.doubts if one.startswith("the moves rest on ")]
    assert rest == [f"the moves rest on {one}" for one in told]


def test_a_kept_value_that_decides_where_moves_go_stands_in_the_headline():
    data = "MODULE M\nPERS num held:=0;\nPERS num made:=0;\nPROC main()\nVAR num n:=1; VAR num m;\n"
    move = f"MoveAbsJ [[m,0,0,0,0,0],{test_rapid.NONE}],v100,fine,tool0;"
    counts = "IF made>9 THEN\nmade:=0;\nENDIF\n"
    branch = f"{counts}IF held=1 THEN\nn:=7;\nENDIF\nm:=2*n;\n{move}"
    (told,) = check("a.mod", f"{data}{branch} ENDPROC\nENDMODULE").doubts
    assert told == f"line 9: {WAY} held (line 2) decides, which the controller keeps between runs"
