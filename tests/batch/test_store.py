"""The database of a batch: what is committed comes back, what is damaged or of something else is one line."""

import sqlite3
from contextlib import closing
from datetime import date

import pytest

from clearance.batch import engine
from clearance.batch.item import GivenTrajectory, Item
from clearance.batch.listed import read_list, write_list
from clearance.batch.options import CaseOptions
from clearance.batch.rows import VERDICT, error_row
from clearance.batch.store import FILE, FORMAT, Store, merge, open_store
from clearance.cli import run
from clearance.errors import BadInput, Incomplete, MissingFile
from clearance.run import CheckOptions
from clearance.world.rules import Waiver
from tests.batch.batches import ANSWER, answer_bytes, n_rows, run_here, write_cell

NEAREST = [0.5, 0.2, 0.04, 0.35, -0.1]


@pytest.fixture
def manifest(tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "SECONDS", 1e9)  # one task, however slow the machine
    monkeypatch.setattr(engine, "MOST", 2)
    monkeypatch.setattr(engine, "LEAST", 1)
    return write_cell(tmp_path / "in", NEAREST)


ODD = {
    "clearance": -0.0,
    "lower_bound": float("nan"),
    "proven": float("-inf"),
    "expected": 5e-324,
    "time": 3,
    "step": 2**62,
    "text": "a\0b\n'\"ü",
    "reasons": ["x", ""],
    "curve": [0.1, float("inf")],
}


def row(**told):
    return error_row("none", 1) | told


def test_a_row_of_odd_values_comes_back(tmp_path):
    with open_store(tmp_path) as store:
        store.put(rows=[("k", row(**ODD))])
        assert store.has("k") and store.n_damaged == 0
        (found,) = store.rows(["k"])
    expected = {"key": "k"} | row(**ODD) | {"lower_bound": None}
    assert found == expected and list(found) == ["key", *VERDICT.names]


def test_what_is_put_together_is_there_as_a_whole_or_not_at_all(tmp_path):
    def broken():
        yield "k", row()
        raise KeyboardInterrupt

    with open_store(tmp_path) as store:
        with pytest.raises(KeyboardInterrupt):
            store.put(rows=broken())
        store.put(rows=[("l", row())])
        assert not store.has("k") and store.has("l")


def changed(place, asked, *values):
    with closing(sqlite3.connect(place / FILE)) as db, db:
        db.execute(asked, values)


@pytest.mark.slow
@pytest.mark.parametrize("column", ["status", "exit_code", "clearance", "findings", "digest"])
def test_a_row_that_is_damaged_is_measured_again(column, manifest, tmp_path):
    run_here(manifest, tmp_path / "out")
    first = answer_bytes(tmp_path / "out")
    changed(tmp_path / "out", f"UPDATE cases SET {column} = 'clear' WHERE status = 'violated'")
    told, _ = run_here(manifest, tmp_path / "out")
    assert told.measured == ["t002"] and answer_bytes(tmp_path / "out") == first


@pytest.mark.slow
@pytest.mark.parametrize("read", ["[", "[[1]]", "null"])
def test_what_is_damaged_of_the_lists_of_files_is_measured_again(read, manifest, tmp_path):
    run_here(manifest, tmp_path / "out")
    changed(tmp_path / "out", "UPDATE inputs SET read = ?", read)
    assert len(run_here(manifest, tmp_path / "out")[0].measured) == 5


def test_known_hashes_that_are_damaged_are_measured_again_and_never_believed(
    manifest, tmp_path, monkeypatch
):
    monkeypatch.setattr("clearance.batch.file_hashes.RACY", -(10**18))
    run_here(manifest, tmp_path / "out")
    changed(
        tmp_path / "out", "UPDATE files SET sha256 = 'ff' WHERE CAST(path AS TEXT) LIKE '%t001.csv'"
    )
    assert run_here(manifest, tmp_path / "out")[0].measured == ["t001"]


@pytest.mark.parametrize("content", [b"PAR1" * 500, b"SQLite format 3\0" + bytes(5000)])
def test_a_file_of_something_else_is_one_line(content, manifest, tmp_path, capsys):
    (tmp_path / "out").mkdir()
    (tmp_path / "out" / FILE).write_bytes(content)
    for asked in (["batch", str(manifest), "--out"], ["batch", "status"], ["batch", "merge"]):
        assert run([*asked, str(tmp_path / "out")]) == 2
        err = capsys.readouterr().err
        assert err.startswith("error: ") and err.count("\n") == 1 and FILE in err
        assert "damaged" in err or "no store" in err


def test_a_store_of_another_format_is_one_line(manifest, tmp_path, refusal):
    run_here(manifest, tmp_path / "out")
    changed(tmp_path / "out", f"PRAGMA user_version = {FORMAT + 1}")
    told = refusal("batch", "status", tmp_path / "out")
    assert f"a store of format {FORMAT + 1}; a new folder" in told


def test_what_a_process_that_was_ended_left_at_the_beginning_is_no_hindrance(tmp_path):
    (tmp_path / ".store.lock").write_text("")
    (tmp_path / FILE).write_text("")
    with open_store(tmp_path) as store:
        assert len(store) == 0


def test_on_a_full_disk_what_was_kept_stays(manifest, tmp_path, monkeypatch):
    put = Store.put

    def nearly_full(self, *given, **told):
        """Room for one task."""
        n_pages = self._one("PRAGMA page_count")[0]
        self._one(f"PRAGMA max_page_count = {n_pages + (0 if len(self) else 50)}")
        put(self, *given, **told)

    monkeypatch.setattr(Store, "put", nearly_full)
    with pytest.raises(Incomplete, match="database or disk is full") as caught:
        run_here(manifest, tmp_path / "out")
    assert "the same command goes on once there is room" in str(caught.value)
    monkeypatch.undo()
    kept = n_rows(tmp_path / "out")
    assert 0 < kept < 5
    told, found = run_here(manifest, tmp_path / "out")
    assert len(told.measured) == 5 - kept and found.n_cases == 5


def test_a_part_knows_what_the_store_has_and_is_merged(manifest, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    place = tmp_path / "out"
    run_here(manifest, place)
    first = answer_bytes(place)
    (manifest.parent / "t001.csv").write_text("time,rail\n0,0\n1,0.7\n")
    (manifest.parent / "t002.csv").write_text("time,rail\n0,0\n1,0.7\n")
    asked = ["batch", str(manifest), "--out", "out", "--jobs", "1", "--quiet"]
    assert run([*asked, "--shard", "2/2"]) == 0  # t001 and t003
    with closing(sqlite3.connect(place / "part-2-of-2.sqlite")) as db:
        assert db.execute("SELECT count(*) FROM cases").fetchone() == (1,)
    assert n_rows(place) == 5 and set(answer_bytes(place)) == {"batch.html", "junit.xml"}
    assert run(["batch", "merge", "out"]) == 0
    assert n_rows(place) == 6 and not (place / "part-2-of-2.sqlite").exists()
    assert run(asked) == 1
    assert set(answer_bytes(place)) == set(ANSWER) and answer_bytes(place) != first
    assert n_rows(place) == 7


def test_only_stores_are_merged(tmp_path, capsys):
    (tmp_path / "none").mkdir()
    (tmp_path / "cell.yaml").write_text("name: x\n")
    for other in ("none", "cell.yaml", "gone"):
        assert run(["batch", "merge", str(tmp_path / "out"), str(tmp_path / other)]) == 2
        err = capsys.readouterr().err
        assert other in err and err.startswith("error: ") and err.count("\n") == 1
    with open_store(tmp_path / "out") as store, pytest.raises(BadInput, match="no store"):
        merge(store, [tmp_path / "none"], print)


UNTIL = {"at_least": 0.01, "by": "me", "until": date(2027, 3, 31)}


@pytest.fixture
def cases():
    plain = CaseOptions.of(CheckOptions(need="limit", today=date(2026, 11, 1)))
    waiver = Waiver(("a", "b"), reason='says "cases": [ and ]}', **UNTIL)
    waived = plain.waived_by((waiver,))
    given = GivenTrajectory("/in/t0.csv", '{"period":0.5}', "left")
    return [
        Item(0, "t0", "/in/cell.yaml", given, plain),
        Item(1, 'a {"quoted"} name', "/in/whole.yaml", None, waived),
        Item(2, "tü", "/in/cell.yaml", GivenTrajectory("/in/tü.csv", "{}"), waived),
        Item(3, "no text", "/in/cell.yaml", GivenTrajectory("/in/\udcff.csv", "{}"), plain),
    ]


def test_it_comes_back(cases, tmp_path):
    with open_store(tmp_path) as store:
        write_list(store, cases[:1])
        write_list(store, cases)
        found = read_list(store)
    assert found == cases
    assert [one.options.key for one in found] == [one.options.key for one in cases]


def test_a_store_without_one_says_so(tmp_path):
    with open_store(tmp_path) as store, pytest.raises(MissingFile, match="no batch was begun"):
        read_list(store)


@pytest.mark.parametrize(
    ("options", "item"),
    [("{", "[1"), ('{"need": 3}', '["/in/cell.yaml", null]'), ("{}", '["/in/cell.yaml"]')],
)
def test_one_that_is_damaged_is_told_in_one_line(options, item, tmp_path):
    with open_store(tmp_path) as store:
        store.write_list([options], [(0, "t0", item, 0)])
        with pytest.raises(BadInput, match="the list of cases is damaged"):
            read_list(store)


def test_a_database_of_something_else_is_one_line_and_stays(manifest, tmp_path, capsys):
    (tmp_path / "out").mkdir()
    changed(tmp_path / "out", "CREATE TABLE mine (x)")
    assert run(["batch", str(manifest), "--out", str(tmp_path / "out")]) == 2
    err = capsys.readouterr().err
    assert "this is no store" in err and err.count("\n") == 1
    changed(tmp_path / "out", "INSERT INTO mine VALUES (1)")


@pytest.mark.slow
def test_parts_that_were_measured_elsewhere_are_merged_and_stay(manifest, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    asked = ["batch", str(manifest), "--jobs", "1", "--quiet"]
    for i in (1, 2):
        run([*asked, "--out", f"part{i}", "--shard", f"{i}/2"])
    assert run(["batch", "merge", "out", "part1", "part2"]) == 0
    assert run([*asked, "--out", "out"]) == 1 and n_rows(tmp_path / "out") == 5
    run([*asked, "--out", "alone"])
    assert all(
        (tmp_path / "out" / name).read_bytes() == (tmp_path / "alone" / name).read_bytes()
        for name in ("cases.parquet", "findings.parquet")
    )
    assert (tmp_path / "part1" / "part-1-of-2.sqlite").is_file()
