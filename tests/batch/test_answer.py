"""A case of a batch says all that its own check says, in every answer; what is worst stands first."""

from __future__ import annotations

import pyarrow as pa
import pytest
from pytest import approx

from clearance.batch import engine
from clearance.batch.answer import BatchAnswer
from clearance.batch.page import page_data, page_of
from clearance.run import check
from tests.batch.batches import cases, printed, run_here, write_cell
from tests.report.schemas import valid_suite

HELD = "time,rail\n" + "".join(f"{i / 100:.2f},0\n" for i in range(201) if not 60 < i < 140)


def data_of(answer, place):
    page = page_data(answer, place)
    return page, [page["headlines"][i] for i in page["headline"]]


def test_time_that_is_not_measured_stands_in_every_answer(tmp_path, capsys):
    manifest = write_cell(tmp_path / "in", [0.5])
    (tmp_path / "run.csv").write_text(HELD)
    asked = dict(motion="recorded", recorded=tmp_path / "run.csv", recorded_gaps="not_measured")
    _, found = run_here(manifest, tmp_path / "store", changes=asked | {"unproven_ok": True})
    (row,) = cases(tmp_path / "store")
    assert row["text"].endswith(", not measured from 0.6 to 1.4 s") and row["shade"] == "near"
    assert found.shade == "near"
    first = printed(found, tmp_path / "store", capsys)[0]
    assert first == f"CLEAR  1 case: 1 {row['text']}"
    page, headlines = data_of(found, tmp_path / "store")
    assert headlines == [row["text"]] and page["shade"] == ["near"]
    assert f'<p class="verdict near">1 case: 1 {row["text"]}</p>' in page_of(
        found, tmp_path / "store"
    )
    (told,) = valid_suite(tmp_path / "store" / "junit.xml").iter("system-out")
    assert told.text.startswith(f"{row['text']}; ")


def test_all_that_a_case_reserves_is_told_where_headlines_differ(tmp_path, capsys):
    """Of two clear cases one is at a single pose; neither measures links against each other."""
    manifest = write_cell(tmp_path / "in", [0.5, 0.6])
    (tmp_path / "in" / "t001.csv").write_text("time,rail\n0,0\n")
    _, found = run_here(manifest, tmp_path / "store")
    lines = printed(found, tmp_path / "store", capsys)
    assert lines[0] == "CLEAR  2 cases: 2 clear (1 with reservations)"
    assert lines[1] == "              clear at a single pose (1 case: t001)"
    page = page_of(found, tmp_path / "store")
    assert "<p>clear at a single pose (1 case: t001)</p>" in page


def test_what_was_not_checked_is_told_as_by_check(tmp_path, capsys):
    _, found = run_here(write_cell(tmp_path / "in", [0.5, 0.6]), tmp_path / "store")
    cell = tmp_path / "in" / "cell.yaml"
    cell.write_text(cell.read_text() + "trajectory: {file: t000.csv}\n")
    scope = list(check(cell).verdict.scope)
    assert scope and [row["scope"] for row in cases(tmp_path / "store")] == [scope, scope]
    line = f"{'; '.join(scope)} (2 cases: t000, t001)"
    assert f"              {line}" in printed(found, tmp_path / "store", capsys)
    assert line in page_of(found, tmp_path / "store")
    told = valid_suite(tmp_path / "store" / "junit.xml").iter("system-out")
    assert all(scope[0] in one.text for one in told)


def test_the_proven_clearance_counts_tolerances(tmp_path):
    manifest = write_cell(tmp_path / "in", [0.4])
    cell = tmp_path / "in" / "cell.yaml"
    cell.write_text(cell.read_text() + "tolerance: {base: {xyz: 0.01}}\n")
    _, found = run_here(manifest, tmp_path / "store")
    (row,) = cases(tmp_path / "store")
    page, headlines = data_of(found, tmp_path / "store")
    assert headlines == ["clear with tolerances"]
    assert page["bound"] == [pytest.approx(390.0, abs=0.2)] and row["lower_bound"] > 0.399


def test_of_cases_in_contact_the_deepest_is_worst(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr(engine, "SECONDS", 1e9)  # one task, however slow the machine
    manifest = write_cell(tmp_path / "in", [-0.01, -0.03, 0.5, -0.02])
    _, found = run_here(manifest, tmp_path / "out")
    assert [row["case"] for row in found.worst] == ["t001", "t003", "t000"]
    assert found.critical["case"] == "t001"
    depths = {row["case"]: row["penetration"] for row in cases(tmp_path / "out")}
    right = {"t000": approx(0.01), "t001": approx(0.03), "t002": None, "t003": approx(0.02)}
    assert depths == right
    page = page_data(found, tmp_path / "out")
    assert page["clearance"] == approx([-10.0, -30.0, 400.0, -20.0], abs=0.002)
    assert page["touches"] == [1, 1, 0, 1]
    told = "\n".join(printed(found, tmp_path / "out", capsys))
    assert "critical    t001: contact, at most 30.00 mm deep, slider - wall" in told
    assert "contact     t001: contact 30.00 mm deep: slider - wall" in told


def test_cases_with_warnings_are_named(tmp_path, capsys):
    _, found = run_here(write_cell(tmp_path / "in", [0.4, 0.5, 0.6]), tmp_path / "out")
    i = found.rows.schema.get_field_index("warnings")
    column = pa.array([["a start"], [], ["a hole"]], found.rows.schema.field(i).type)
    found = BatchAnswer(found.rows.set_column(i, "warnings", column))
    told = printed(found, tmp_path / "out", capsys)
    assert any(line.endswith("warnings    2 cases, see the page: t000, t002") for line in told)
