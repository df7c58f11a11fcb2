"""What of a batch stands first: of cases in contact the deepest, in the summary, the table and on the page."""

import pyarrow as pa
from pytest import approx

from clearance.batch import engine
from clearance.batch.answer import BatchAnswer
from clearance.batch.page import page_data
from tests.batch.batches import cases, printed, run_here, write_cell


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
