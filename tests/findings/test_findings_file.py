"""findings.json reads back as it was written and gives the same bytes; a damaged one is refused in one line."""

from __future__ import annotations

import functools
import json
from pathlib import Path

import pytest

import clearance as cl
from clearance.errors import BadInput, BadSyntax, MissingFile
from clearance.findings.findings_file import (
    FORMAT,
    FindingList,
    findings_text,
    read_findings,
)
from clearance.world.case import Limits

SCENES = Path(__file__).parents[2] / "scenes"


@functools.cache
def found() -> FindingList:
    case = cl.load_case(SCENES / "box_box" / "case.yaml")
    return cl.check(case, limits=Limits(0.04, 0.06)).finding_list


def test_a_list_reads_back_as_it_was_written(tmp_path):
    (tmp_path / "findings.json").write_text(findings_text(found()))
    assert found().findings[0].broken
    assert read_findings(tmp_path) == read_findings(tmp_path / "findings.json") == found()
    assert findings_text(read_findings(tmp_path)) == findings_text(found())


def changed(**changes: object) -> str:
    return json.dumps(json.loads(findings_text(found())) | changes)


@pytest.mark.parametrize(
    ("damaged", "fault", "told"),
    [
        (lambda text: text[:-40], BadSyntax, "not JSON"),
        (lambda text: "[" * 100_000, BadSyntax, "not JSON"),
        (lambda text: text.replace("0.06", "NaN"), BadSyntax, "NaN"),
        (lambda text: text.replace("0.06", "1e400"), BadSyntax, "1e400 is beyond doubles"),
        (lambda text: text.replace("0.06", '"inf"'), BadInput, "warn"),
        (lambda text: "[]", BadInput, "format None"),
        (lambda text: changed(format=FORMAT + 1), BadInput, f"format {FORMAT + 1}"),
        (lambda text: changed(findings=[{"id": 1}]), BadInput, "findings[0]"),
        (lambda text: changed(measured={}), BadInput, "measured"),
    ],
)
def test_what_is_no_such_file_is_refused_in_one_line(damaged, fault, told, tmp_path):
    path = tmp_path / "findings.json"
    path.write_text(damaged(findings_text(found())))
    with pytest.raises(fault) as error:
        read_findings(path)
    assert told in str(error.value) and str(path) in str(error.value)


def test_a_folder_without_findings_is_named(tmp_path):
    with pytest.raises(MissingFile, match=r"findings\.json"):
        read_findings(tmp_path)
