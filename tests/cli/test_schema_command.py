"""`clearance schema` says of a case file what loading it says, as far as a schema can."""

import re
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from clearance.cli import run
from clearance.errors import BadInput
from clearance.formats.schema import case as schema
from clearance.formats.schema.strict_model import validated
from tests.formats.making import CASE
from tests.report.schemas import printed_schema

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def errors():
    """Asks the printed schema whether it objects to YAML text."""
    _, validator = printed_schema()
    return lambda text: [
        error.message for error in validator.iter_errors(YAML(typ="safe").load(text))
    ]


def assert_taken(errors, case, old, new):
    text = case.replace(old, new)
    assert text != case and errors(text) == []
    assert validated(schema.Case, YAML(typ="safe").load(text), "case.yaml")


def assert_refused(errors, case, old, new):
    text = case.replace(old, new)
    assert text != case and errors(text)
    with pytest.raises(BadInput):
        validated(schema.Case, YAML(typ="safe").load(text), "case.yaml")


CASES = [
    path
    for path in sorted(ROOT.glob("scenes/**/*.yaml"))
    if re.search(r"^(trajectory|robots?):", path.read_text(), re.MULTILINE)
]


@pytest.mark.slow
def test_our_cases_follow_it(errors):
    assert len(CASES) > 10
    assert {path: errors(path.read_text()) for path in CASES} == {path: [] for path in CASES}


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("name: small\n", ""),
        ("trajectory: {file: path.csv}", "trajectory: path.csv"),
        ("box: {size: [0.1, 0.1, 1]}", "mesh: {file: a.stl, scale: 0.001}"),
        ("box: {size: [0.1, 0.1, 1]}", "mesh: {file: a.stl, scale: [1, 1, -1]}"),
        ("warn: 0.02", "warn: 0.02, joints: fail"),
        ("urdf: arm.urdf", "urdf: arm.urdf, geometry: collision_or_visual, collada_up_axis: file"),
        ("limits:", "accept: [units, axis]\nlimits:"),
        ("{file: path.csv}", "{program: weld.mod, start_state: home}"),
        ("{file: path.csv}", "{program: {file: weld.mod, axes: {upper: {offset: -90deg}}}}"),
        ("{file: path.csv}", "{program: {tool: {link: upper}, moves: [{wait: 1.0}]}}"),
    ],
)
def test_what_it_takes_is_taken(errors, old, new):
    assert_taken(errors, CASE, old, new)


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("robot:", "robbot:"),
        ("trajectory: {file: path.csv}", ""),
        ("box: {size: [0.1, 0.1, 1]}", ""),
        ("box: {size: [0.1, 0.1, 1]}", "box: {size: [0.1, 1]}"),
        ("box: {size: [0.1, 0.1, 1]}", "box: {size: [0.1, 0.1, 1]}\n    sphere: {radius: 1}"),
        ("box: {size: [0.1, 0.1, 1]}", "sphere: {radius: 0}"),
        ("xyz: [1.2, 0, 0]", "rpy: [0, 0, 0], quat_xyzw: [0, 0, 0, 1]"),
        ("warn: 0.02", "warn: 0.02, joints: stop"),
        ("limits:", "accept: [unit]\nlimits:"),
        ("limits:", "tolerance: {joints: {all: -0.1}}\nlimits:"),
        ("limits:", "tolerance: {base: {arm: 0.1}}\nlimits:"),
        ("limits:", "tolerance: {presets: [none]}\nlimits:"),
        ("urdf: arm.urdf", "urdf: arm.urdf, geometry: hull"),
        ("file: path.csv", "program: {file: weld.mod, axes: {upper: {sign: 2}}}"),
        ("file: path.csv", "program: {file: weld.mod, axes: {upper: {offset: 90mm}}}"),
    ],
)
def test_what_it_marks_is_refused(errors, old, new):
    assert_refused(errors, CASE, old, new)


def test_a_shell_is_told_how_a_command_line_may_go_on(monkeypatch, capsys):
    monkeypatch.setenv("_CLEARANCE_COMPLETE", "zsh_complete")
    for words, told in (("clearance wor", "workspace"), ("clearance check --watc", "--watch")):
        monkeypatch.setenv("COMP_WORDS", words)
        monkeypatch.setenv("COMP_CWORD", str(words.count(" ")))
        assert run([]) == 0
        assert told in capsys.readouterr().out.splitlines()
