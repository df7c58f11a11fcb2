"""Waivers that all cases of a batch share, as a truth table: each must be needed by one case, not by all."""

import pyarrow.parquet as pq
import pytest

from clearance.cli import run
from tests.batch.batches import answer_bytes, write_cell
from tests.report.schemas import valid_suite

DAY = "2026-11-01"


@pytest.fixture
def folder(tmp_path, monkeypatch):
    write_cell(tmp_path, [0.5, 0.6, 0.04])
    monkeypatch.chdir(tmp_path)
    return tmp_path


def waiver(between="[slider, wall]", at_least=0.03, until="2027-03-31", **more):
    told = f"between: {between}, at_least: {at_least}, until: {until}, reason: soft, by: N. N."
    return "- {" + ", ".join([told, *(f"{key}: {value}" for key, value in more.items())]) + "}\n"


def write_waivers_of_the_cell(folder, text):
    (folder / "own.yaml").write_text(text)
    with (folder / "cell.yaml").open("a") as file:
        file.write("waivers: [own.yaml]\n")


def batch(*arguments, day=DAY):
    common = ["--out", "store", "--jobs", "1", "--today", day, "--waivers", "waivers.yaml"]
    return run(["batch", "batch.yaml", *common, *arguments])


TABLE = {
    # what: waivers, exit code, headline, a line
    "one case needs it": (waiver(), 0, "CLEAR with waivers  3 cases: 3 clear", "waived      1 case with what"),
    "expired": (
        waiver(until="2026-10-31"), 1, "VIOLATED  3 cases: 1 violated, 2 clear",
        "waivers     waiver slider - wall (waivers.yaml: waivers[0]) has expired on 2026-10-31",
    ),
    "no case needs it": (
        waiver() + waiver("[slider, floor]"), 1, "UNUSED WAIVER  3 cases: 3 clear",
        "waivers     waiver slider - floor (waivers.yaml: waivers[1]) is not needed: no body is called 'floor'",
    ),
    "of no body": (
        waiver() + waiver("[slider, wal]"), 1, "UNUSED WAIVER", "no body is called 'wal'; did you mean 'wall'?",
    ),
    "of a case": (
        waiver(case="t002"), 0, "CLEAR with waivers  3 cases: 3 clear", '<p class="faint">1 with waivers</p>',
    ),
    "of another case": (
        waiver() + waiver(case="t000"), 1, "UNUSED WAIVER",
        "waivers[1]) is not needed: in every case its pairs keep",
    ),
    "of no case": (
        waiver() + waiver(case="t02"), 1, "UNUSED WAIVER", "no case is called 't02'; did you mean 't002'?",
    ),
    "of the cell, and no motion needs it": (
        waiver() + waiver("[slider, floor]"), 1, "UNUSED WAIVER  3 cases: 3 clear",
        "waivers     waiver slider - floor (own.yaml: waivers[1]) is not needed: no body is called 'floor'",
    ),
}  # fmt: skip


@pytest.mark.slow
@pytest.mark.parametrize("what", TABLE)
def test_truth_table(what, folder, capsys):
    text, code, headline, line = TABLE[what]
    if "of the cell" in what:
        write_waivers_of_the_cell(folder, text)
        text = "[]"
    (folder / "waivers.yaml").write_text(text)
    assert batch() == code
    told = capsys.readouterr().out
    assert told.startswith(headline)
    assert line in told + (folder / "store" / "batch.html").read_text()
    suite = valid_suite(folder / "store" / "junit.xml")
    assert (suite.get("failures") == "0") == (code == 0)
    page = (folder / "store" / "batch.html").read_text()
    assert ("is not needed" in page) == ("is not needed" in told)
    assert ("waived: " in page) == ("with 1 waiver" in str(_texts(folder)))
    first = answer_bytes(folder / "store")
    assert batch("--quiet") == code and answer_bytes(folder / "store") == first
    assert run(["view", "store", "t000"]) == 0  # writes the page once more, of the tables
    again = (folder / "store" / "batch.html").read_text()
    assert ("is not needed" in again) == ("is not needed" in page)


def _texts(folder):
    return pq.read_table(folder / "store" / "cases.parquet")["text"].to_pylist()


def test_what_is_waived_stays_in_sight(folder):
    (folder / "waivers.yaml").write_text(waiver())
    assert batch("--quiet") == 0
    row = pq.read_table(folder / "store" / "cases.parquet").to_pylist()[2]
    page = (folder / "store" / "batch.html").read_text()
    assert (
        '"headline": [0, 0, 1]' in page and '"headlines": ["clear", "clear with 1 waiver"]' in page
    )
    assert row["text"] == "clear with 1 waiver" and "39.99 mm" in row["waived"][0]
    assert row["waivers"] == ["waiver slider - wall (waivers.yaml: waivers[0])"]
    told = [one.text for one in valid_suite(folder / "store" / "junit.xml").iter("system-out")]
    assert told[2].startswith("clear with 1 waiver; ") and "waived: " not in told[0] + told[1]
    assert "; waived: 39.99 mm, below the fail limit" in told[2]
    found = pq.read_table(folder / "store" / "findings.parquet").to_pylist()
    (of_case,) = (one for one in found if one["case"] == "t002")
    assert (of_case["waived"], of_case["code"]) == ("soft (N. N.)", "CL501")


def test_what_is_not_answered_may_need_it(folder, capsys):
    (folder / "waivers.yaml").write_text(waiver(case="t002"))
    (folder / "t002.csv").write_text("time,rail\n0,x\n")
    assert batch() == 1
    assert "is not needed" not in capsys.readouterr().out
    assert batch("--shard", "1/3") == 0
    assert "is not needed" not in capsys.readouterr().out


def test_a_waiver_is_a_change_of_its_cases_alone(folder, capsys):
    (folder / "waivers.yaml").write_text(waiver(case="t002"))
    batch()
    (folder / "waivers.yaml").write_text(waiver(case="t002", at_least=0.02))
    capsys.readouterr()
    assert batch() == 0
    assert "cached      2 of 3" in capsys.readouterr().out
    assert batch(day="2027-03-31") == 0
    assert "cached      3 of 3" in capsys.readouterr().out
    assert batch(day="2027-04-01") == 1
    told = capsys.readouterr().out
    assert "cached      2 of 3" in told and "has expired on 2027-03-31" in told


def test_a_waiver_that_another_cell_needs_is_not_needed_for_that(folder, capsys):
    write_cell(folder / "far", [0.5])
    for cell in (folder, folder / "far"):
        write_waivers_of_the_cell(cell, waiver())
    (folder / "far" / "batch.yaml").write_text(
        'name: far\ncell: cell.yaml\ntrajectories: "t*.csv"\n'
    )
    asked = ["batch", "batch.yaml", "far/batch.yaml", "--out", "store", "--jobs", "1"]
    assert run([*asked, "--today", DAY]) == 1
    assert capsys.readouterr().out.startswith("UNUSED WAIVER  4 cases: 4 clear")


def test_a_cell_that_cannot_be_read_is_an_error_of_its_cases(folder, capsys):
    (folder / "waivers.yaml").write_text(waiver(until="2026-10-31"))
    (folder / "cell.yaml").write_text("robot: [\n")
    assert batch() == 1
    told = capsys.readouterr().out
    assert told.startswith("ERROR  3 cases: 3 error") and "has expired on 2026-10-31" in told
