"""`clearance schema` says of a case file what loading it says, as far as a schema can."""

import json
from pathlib import Path

import pytest
from ruamel.yaml import YAML

from clearance.cli import run
from clearance.errors import BadInput
from clearance.load import schema
from clearance.load.schema_errors import validated
from tests.load.making import CASE

ROOT = Path(__file__).resolve().parents[2]

jsonschema = pytest.importorskip("jsonschema")


@pytest.fixture
def errors(capsys):
    """Asks the printed schema whether it objects to YAML text."""
    assert run(["schema"]) == 0
    printed = json.loads(capsys.readouterr().out)
    jsonschema.Draft202012Validator.check_schema(printed)
    validator = jsonschema.Draft202012Validator(printed)
    return lambda text: [
        error.message for error in validator.iter_errors(YAML(typ="safe").load(text))
    ]


CASES = [
    path for path in sorted(ROOT.glob("scenes/**/*.yaml")) if "trajectory:" in path.read_text()
]


@pytest.mark.parametrize("path", CASES, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_our_cases_follow_it(errors, path):
    assert errors(path.read_text()) == []


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
    ],
)
def test_what_it_takes_is_taken(errors, old, new):
    text = CASE.replace(old, new)
    assert text != CASE and errors(text) == []
    assert validated(schema.Case, YAML(typ="safe").load(text), "case.yaml")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("robot:", "robbot:"),
        ("trajectory: {file: path.csv}", ""),
        ("trajectory: {file: path.csv}", "trajectory: ['path.csv']"),
        ("box: {size: [0.1, 0.1, 1]}", ""),
        ("box: {size: [0.1, 0.1, 1]}", "box: {size: [0.1, 1]}"),
        ("box: {size: [0.1, 0.1, 1]}", "box: {size: [0.1, 0.1, 1]}\n    sphere: {radius: 1}"),
        ("box: {size: [0.1, 0.1, 1]}", "sphere: {radius: 0}"),
        ("xyz: [2, 0, 0]", "rpy: [0, 0, 0], quat_xyzw: [0, 0, 0, 1]"),
        ("warn: 0.02", "warn: 0.02, joints: stop"),
        ("limits:", "accept: [unit]\nlimits:"),
        ("urdf: arm.urdf", "urdf: arm.urdf, geometry: hull"),
    ],
)
def test_what_it_marks_is_refused(errors, old, new):
    text = CASE.replace(old, new)
    assert text != CASE and errors(text)
    with pytest.raises(BadInput):
        validated(schema.Case, YAML(typ="safe").load(text), "case.yaml")
