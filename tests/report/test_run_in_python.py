"""What a run says of itself in Python: a short line, a notebook's few lines, events, summary, certificate."""

import json
from pathlib import Path

import pytest

import clearance as cl
from clearance.errors import BadInput, MissingFile

CASE = "scenes/box_box/case.yaml"


@pytest.fixture(scope="module")
def run():
    return cl.check(CASE, limits=cl.Limits(0.03, 0.05))


def test_a_case_file_can_be_checked_by_its_path(run):
    again = cl.check(Path(CASE), limits=cl.Limits(0.03, 0.05))
    loaded = cl.check(cl.load_case(CASE), limits=cl.Limits(0.03, 0.05))
    assert run.steps.equals(again.steps) and run.steps.equals(loaded.steps)
    with pytest.raises(MissingFile):
        cl.check("nowhere.yaml")
    with pytest.raises(BadInput, match="a int is given"):
        cl.check(3)


def test_a_run_is_told_in_a_line(run):
    told = repr(run)
    assert "\n" not in told and len(told) < 200
    assert told.startswith(f"<Run {run.record.case.name}: {run.verdict.text()}, ")
    assert run.worst["link"] in told and run.worst["obstacle"] in told


def test_a_notebook_shows_verdict_and_closest_pairs(run):
    html = run._repr_html_()
    assert run.verdict.text() in html and "self-collision not checked" in html
    assert html.count("<tr>") == 1 + min(5, len(run.record.pair_minima))


def test_names_are_escaped_in_a_notebook(run):
    from dataclasses import replace

    case = replace(run.record.case, name="<script>alert(1)</script>")
    assert "<script>" not in cl.check(case)._repr_html_()


def test_summary_and_events_are_those_of_the_report(run, tmp_path):
    folder = run.save(tmp_path / "out")
    assert folder == tmp_path / "out"
    written = json.loads((folder / "summary.json").read_text())
    assert json.loads(json.dumps(run.summary)) == written
    assert [event.what for event in run.events] == [event["what"] for event in written["events"]]
    assert run.events


def test_the_certificate_is_at_hand(run):
    assert run.certificate.lower_bound.min() <= run.worst["clearance"]
    assert cl.check(CASE, certify=False).certificate is None


@pytest.mark.parametrize("folder", ["", None, 3])
def test_what_is_no_folder_is_refused(run, folder):
    with pytest.raises(BadInput, match="a path of a folder is needed"):
        run.save(folder)
