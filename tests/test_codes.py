"""Codes: one for each kind of notice and class of errors, whose meaning never changes, wherever a line is said."""

from __future__ import annotations

import ast
import importlib
import inspect
import pkgutil
from pathlib import Path

import pytest
from ruamel.yaml import YAML

import clearance
from clearance import codes
from clearance.batch.answer import STATUSES
from clearance.cli import run
from clearance.errors import BadInput, ClearanceError
from clearance.findings import doubts, finding
from clearance.formats.schema import case as schema
from clearance.formats.schema.strict_model import validated
from clearance.run import CheckOptions
from clearance.world import notice
from tests.formats.making import CASE

GIVEN = {
    "CL001": "BadCurve", "CL002": "UnknownMethod", "CL003": "Undecided", "CL011": "UnknownEntity",
    "CL012": "BadConstraint", "CL013": "DegenerateSketch", "CL014": "NoFreeDimension", "CL015": "NoFit",
    "CL101": "MissingFile", "CL102": "BadSyntax", "CL103": "UnknownKey", "CL104": "MissingKey",
    "CL105": "BadInput", "CL106": "Contradiction", "CL107": "NotFinite", "CL108": "BadShape",
    "CL109": "DuplicateName", "CL110": "BadDimension", "CL120": "units", "CL121": "package",
    "CL122": "SuspectInput", "CL130": "note", "CL201": "BadRobot", "CL202": "UnknownLink",
    "CL203": "UnknownJoint", "CL204": "UnknownState", "CL205": "UnknownRobot", "CL220": "axis",
    "CL221": "geometry", "CL222": "equality", "CL301": "BadScene", "CL302": "UnknownObstacle",
    "CL303": "EmptyMesh", "CL304": "BadPolygon", "CL305": "BadPose", "CL306": "NotSolid",
    "CL307": "Unbounded", "CL320": "inside", "CL321": "frame", "CL322": "scene", "CL323": "padding",
    "CL324": "reach", "CL325": "scan", "CL326": "plane",
    "CL401": "NoTrajectory", "CL402": "BadMotion", "CL403": "BadTime", "CL404": "NotSimulated",
    "CL420": "start", "CL421": "gaps", "CL422": "clocks", "CL423": "wrap", "CL424": "limits",
    "CL425": "joint limits", "CL426": "recorded run", "CL427": "program", "CL428": "carry", "CL429": "rest",
    "CL430": "neighbours", "CL431": "columns", "CL432": "simulated", "CL433": "limbs", "CL434": "never",
    "CL435": "srdf",
    "CL501": "clearance", "CL502": "profile",
    "CL510": "unused waiver", "CL511": "BadWaiver", "CL512": "waivers", "CL520": "NothingToMeasure",
    "CL521": "pairs", "CL522": "paper", "CL523": "rules", "CL524": "profiles", "CL525": "sketch",
    "CL530": "surroundings", "CL531": "self-collision", "CL532": "floor and walls", "CL601": "unproven",
    "CL602": "tolerances", "CL603": "tolerances of waived", "CL604": "BadTolerance",
    "CL605": "unproven motion", "CL610": "certificate", "CL611": "contact",
    "CL620": "disputed", "CL621": "cross-check", "CL630": "NoReceipt",
    "CL631": "TooManyProofs", "CL701": "Unwritable", "CL702": "Unavailable", "CL703": "Incomplete",
    "CL704": "BadReport", "CL705": "BadPack", "CL710": "ClickException", "CL711": "UnknownOption",
    "CL712": "OSError", "CL713": "Exception", "CL801": "BadProgram", "CL802": "UnknownPlace",
    "CL810": "BadChange", "CL901": "BadBatch",
}  # fmt: skip
"""Codes that were given, for good: none of them is changed, taken away, or given to something else."""

NOT_CHECKED = ("surroundings", "self-collision", "floor and walls")
BEYOND_OURS = {"ClickException", "OSError", "Exception"}


def test_a_code_that_was_given_once_keeps_its_meaning():
    table = {code: entry.of for code, entry in codes.entries().items()}
    assert table == GIVEN
    assert codes.codes() == {of: code for code, of in table.items()}
    assert list(table) == sorted(table)
    for entry in codes.entries().values():
        told = (entry.title, entry.means, entry.matters, entry.remedy, entry.example)
        assert entry.group and all(told) and "[CL" not in entry.example


@pytest.mark.slow
def test_each_class_of_errors_and_each_kind_has_its_own_code():
    kinds = {finding.JOINT_LIMITS, doubts.DISPUTED, doubts.UNUSED_WAIVER, doubts.NOTE, *NOT_CHECKED}
    kinds |= {*notice.KINDS, *finding.KINDS, *kinds_of_notices()}
    assert {*classes_of_errors(), *kinds, *BEYOND_OURS} == set(codes.codes())


def classes_of_errors() -> set[str]:
    """All classes that the package can raise on purpose, once all of it is imported."""
    for module in pkgutil.walk_packages(clearance.__path__, "clearance."):
        if not module.name.startswith(("clearance.kernels", "clearance.__main__")):
            importlib.import_module(module.name)
    found, left = set(), [ClearanceError]
    while left:
        below = [one for one in left.pop().__subclasses__() if one.__name__[0] != "_"]
        found |= {one.__name__ for one in below}
        left += below
    return found


def kinds_of_notices() -> set[str]:
    """The kinds that the package makes notices of: a text, or one of the names in `world.notice`."""
    found = set()
    for path in Path(inspect.getfile(clearance)).parent.rglob("*.py"):
        text = path.read_text(encoding="utf-8")
        for node in ast.walk(ast.parse(text)) if "Notice(" in text else ():
            if isinstance(node, ast.Call) and getattr(node.func, "id", "") == "Notice":
                kind = node.args[1]
                found.add(getattr(notice, kind.id) if isinstance(kind, ast.Name) else kind.value)
    return found


def test_what_is_not_checked_has_the_code_of_its_subject():
    for name, code in (
        (doubts.SURROUNDINGS, "CL530"),
        (f"{doubts.SELF_COLLISION} of left", "CL531"),
        (f"{doubts.OWN_FLOOR} (left)", "CL532"),
    ):
        assert doubts.Doubt(doubts.NOT_CHECKED, "", name).code == code


def test_explain_prints_what_the_table_has_and_names_the_nearest_code(capsys):
    assert run(["explain", "cl120"]) == 0
    told, entry = capsys.readouterr().out, codes.entries()["CL120"]
    assert all(text in told for text in (entry.title, entry.means, entry.remedy, entry.example))
    assert run(["explain"]) == 0
    codes_told, words_told = capsys.readouterr().out.split("\n\n")
    assert [line[:5] for line in codes_told.splitlines()] == list(GIVEN)
    for word in (*STATUSES, "FAIL", "certified", "at the samples only"):
        assert run(["explain", *word.split()]) == 0
        assert capsys.readouterr().out.startswith(word.lower())
        assert f"\n{word.lower()} " in f"\n{words_told}"
    assert run(["explain", "contact"]) == 0 and "CL611" in capsys.readouterr().out
    assert run(["explain", "CL121x"]) == 2
    assert "did you mean 'CL121'? [CL105]" in capsys.readouterr().err
    for kind, code in (("inside", "CL320"), ("MissingKey", "CL104")):
        assert run(["explain", kind]) == 0
        assert capsys.readouterr().out.startswith(code)
    assert run(["explain", "qqq"]) == 2
    assert "`clearance explain` lists all" in capsys.readouterr().err


def test_suspect_input_is_accepted_by_the_code_of_its_kind_where_no_warning_has_that():
    assert CheckOptions(accept=["CL120", "gaps", "CL320"]).accept == ("CL120", "gaps", "inside")
    case = YAML(typ="safe").load(CASE) | {"accept": ["CL320", "axis"]}
    assert validated(schema.Case, case, "case.yaml").accept == ["inside", "axis"]
    for other in ("CL101", "CL425", "CL999"):  # an error, a rule that is broken, nothing
        with pytest.raises(BadInput, match=r"their codes, or the code of a warning"):
            CheckOptions(accept=[other])


@pytest.mark.parametrize(
    "arguments, code",
    [(["check", "none.yaml"], "CL101"), (["check", "--none"], "CL710"), (["none"], "CL710")],
)
def test_an_error_ends_with_its_code(arguments, code, capsys):
    assert run(arguments) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert line.startswith("error: ") and line.endswith(f"[{code}]")
