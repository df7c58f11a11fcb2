"""A batch in one process: only what is missing or has changed is measured, and the answer has the same bytes."""

import hashlib
from dataclasses import replace
from datetime import date

import pytest
import trimesh

from clearance.batch import engine, file_hashes, rows
from clearance.batch.file_hashes import FileHashes
from clearance.batch.keys import key_of, program
from clearance.batch.measuring import Task, conditions_of, measure, read_item
from clearance.case import packed
from clearance.case.case_file import load_cell, with_trajectory_file
from clearance.case.packing import case_contents, write_pack
from clearance.formats.schema.timed import TrajectoryFile
from clearance.run import Question, answer
from clearance.world.case import Source
from tests.batch.batches import (
    CELL,
    URDF,
    answer_bytes,
    cases,
    column,
    findings,
    items_of,
    n_rows,
    run_here,
    statuses,
    write_cell,
    write_path,
)
from tests.run.test_options import BESIDE, EVERY

NEAREST = [0.5, 0.2, 0.04, 0.35, -0.1]


@pytest.fixture
def manifest(tmp_path, monkeypatch):
    monkeypatch.setattr(engine, "SECONDS", 1e9)  # one task, however slow the machine
    return write_cell(tmp_path / "in", NEAREST)


def test_each_case_has_the_verdict_of_its_check(manifest, tmp_path):
    _, found = run_here(manifest, tmp_path / "out")
    expected = ["clear", "near", "violated", "clear", "contact"]
    assert list(statuses(found).values()) == expected and found.exit_code == 1
    cell = load_cell(manifest.parent / "cell.yaml")
    for row in cases(tmp_path / "out"):
        asked = TrajectoryFile(file=f"{row['case']}.csv")
        run = answer(Question(with_trajectory_file(cell, asked, row["case"]), need="limit"))
        assert (row["status"], row["clearance"]) == (run.verdict.status, run.worst["clearance"])
        assert row["reasons"] == list(run.verdict.reasons) and row["basis"] == "motion"
        assert len(row["curve"]) == 3


def test_only_what_has_changed_is_measured(manifest, tmp_path):
    run_here(manifest, tmp_path / "out")
    write_path(manifest.parent / "t001.csv", 0.01)
    told, found = run_here(manifest, tmp_path / "out")
    assert told.measured == ["t001"] and statuses(found)["t001"] == "violated"


def test_packed_cases_are_taken_and_measured_again_where_they_change(tmp_path):
    """Each is unpacked while it is measured; its zip is the file that it was made from."""
    write_cell(tmp_path / "in", [0.2, 0.04])
    for name in ("t000", "t001"):
        case = tmp_path / "in" / f"{name}.yaml"
        case.write_text(CELL.replace("name: rail\n", f"trajectory: {name}.csv\n"))
        write_pack(case_contents(case), tmp_path / f"{name}.zip", {})
    (tmp_path / "all.yaml").write_text("cases: 't*.zip'\n")
    before = {*packed._FOLDERS}
    told, found = run_here(tmp_path / "all.yaml", tmp_path / "out")
    assert statuses(found) == {"t000": "near", "t001": "violated"} and len(told.measured) == 2
    assert packed._FOLDERS == before
    told, _ = run_here(tmp_path / "all.yaml", tmp_path / "out")
    assert told.measured == []
    (tmp_path / "t000.zip").replace(tmp_path / "t001.zip")
    (tmp_path / "all.yaml").write_text("cases: t001.zip\n")
    told, found = run_here(tmp_path / "all.yaml", tmp_path / "out")
    assert told.measured == ["t001"] and statuses(found) == {"t001": "near"}
    (tmp_path / "all.yaml").write_text("cell: t001.zip\ntrajectories: in/t001.csv\n")
    _, found = run_here(tmp_path / "all.yaml", tmp_path / "out")
    assert "t001.zip: is a zip; unzip it, and give its case file" in column(found, "text")[0]


def test_fresh_measures_all_again(manifest, tmp_path):
    run_here(manifest, tmp_path / "out")
    first = answer_bytes(tmp_path / "out")
    told, _ = run_here(manifest, tmp_path / "out", fresh=True)
    assert len(told.measured) == 5 and answer_bytes(tmp_path / "out") == first
    assert n_rows(tmp_path / "out") == 5


def test_bad_input_among_others_is_told_and_the_others_are_done(manifest, tmp_path):
    (manifest.parent / "t001.csv").write_text("time,rail\n0,0\n1,x\n")
    (manifest.parent / "t003.csv").write_text("time,rial\n0,0\n1,1\n")
    (manifest.parent / "t004.csv").unlink()
    (manifest.parent / "t002.csv").unlink()
    _, found = run_here(manifest, tmp_path / "out")
    assert statuses(found) == {"t000": "clear", "t001": "error", "t003": "error"}
    assert found.exit_code == 1
    rows = {row["case"]: row for row in cases(tmp_path / "out")}
    assert "t001.csv: line 3: 'x' in column 'rail' is not a number" in rows["t001"]["text"]
    assert "rial" in rows["t003"]["reasons"][0]
    told, strict = run_here(manifest, tmp_path / "out", strict=True)
    assert strict.exit_code == 2 and told.measured == ["t001", "t003"]


def test_the_key_is_of_all_that_decides_a_row(manifest):
    item = items_of([str(manifest)])[0]
    files = [("cell.yaml", "a"), ("t000.csv", "b")]
    key = key_of(item, files)
    assert key == key_of(item, files[::-1])
    assert key != key_of(item, [("cell.yaml", "a"), ("t000.csv", "c")])
    without = ("today", "tolerance", "waivers", "unproven_ok")  # of files, and of cases with some
    names = [name for name in EVERY if name not in without and "recorded" not in name]
    others = [{"need": "steps"}]
    others += [{"need": "steps"} | BESIDE.get(name, {}) | {name: EVERY[name][0]} for name in names]
    keys = {key_of(items_of([str(manifest)], one)[0], files) for one in others}
    assert len(keys | {key}) == len(names) + 2 > 12


def test_the_key_is_of_what_is_in_the_files_that_are_given(manifest, tmp_path):
    tolerance, recorded = tmp_path / "t.yaml", tmp_path / "run.csv"
    keys = {key_of(items_of([str(manifest)])[0], [])}
    for size in (0.001, 0.01):
        tolerance.write_text(f"obstacles: {{wall: {{xyz: {size}}}}}\n")
        recorded.write_text(f"time,rail\n0,0\n1,{0.43 + size}\n")
        for given in (dict(tolerance=tolerance), dict(motion="recorded", recorded=recorded)):
            keys.add(key_of(items_of([str(manifest)], given)[0], []))
    assert len(keys) == 5


def test_a_variable_that_xacro_asks_for_is_an_input(manifest, monkeypatch):
    path, item = manifest.parent / "cart.xacro", items_of([str(manifest)])[0]
    path.write_text('<box size="$(optenv CART_LENGTH 0.2) 0.2 0.2"/>')
    case = replace(read_item(item).case, sources=(Source(path.name, "a", 1, str(path)),))
    monkeypatch.delenv("CART_LENGTH", raising=False)
    (before,) = conditions_of(item, case)
    monkeypatch.setenv("CART_LENGTH", "1.5")
    (now,) = conditions_of(item, case)
    assert before.path == now.path and before.sha256 != now.sha256


def test_where_findings_are_missing_the_row_says_why(manifest, monkeypatch):
    case = read_item(items_of([str(manifest)])[2]).case
    whole, least = (answer(Question(case, need=need)) for need in ("limit", "minimum"))
    assert rows.row_of(whole)["incomplete"] == ""
    assert "need 'minimum'" in rows.row_of(least)["incomplete"]
    monkeypatch.setattr(rows, "MOST_FINDINGS", 0)
    assert rows.row_of(whole)["incomplete"] == "1 of 1 findings are not listed"


def test_tolerances_that_change_during_a_batch_are_no_answer(manifest, tmp_path):
    own = tmp_path / "t.yaml"
    own.write_text("obstacles: {wall: {xyz: 0.001}}\n")
    item = items_of([str(manifest)], dict(tolerance=own))[0]
    own.write_text("obstacles: {wall: {xyz: 0.002}}\n")
    done = measure(Task((item,), 60.0, program(), "a batch"))
    assert not done.measured and "t.yaml: it changed" in done.faults[0].text


def test_where_a_case_has_waivers_the_day_decides(manifest, tmp_path):
    (manifest.parent / "waivers.yaml").write_text(
        "- {between: [slider, wall], case: t002, at_least: 0.03, reason: seen, by: me, "
        "until: 2027-03-31}\n"
    )
    (manifest.parent / "cell.yaml").write_text(CELL + "waivers: [waivers.yaml]\n")

    def run_on(day):
        return run_here(manifest, tmp_path / "out", changes=dict(today=date.fromisoformat(day)))

    told, found = run_on("2027-03-31")
    assert len(told.measured) == 5 and statuses(found)["t002"] in ("clear", "near")
    waived = [row["waived"] for row in findings(tmp_path / "out") if row["case"] == "t002"]
    assert "seen (me)" in waived
    assert run_on("2027-03-31")[0].measured == []
    told, found = run_on("2027-04-01")
    assert len(told.measured) == 5 and statuses(found)["t002"] == "violated"


def test_a_cell_that_is_edited_while_the_batch_runs_is_not_taken_for_what_was_read(
    manifest, tmp_path, monkeypatch
):
    monkeypatch.setattr(file_hashes, "RACY", 0)
    first, second, *_ = items_of([str(manifest)])
    measure(Task((first,), 60.0, program(), "a batch"))
    cell = manifest.parent / "cell.yaml"
    cell.write_text(CELL.replace("fail: 0.05", "fail: 0.29"))
    hashes = FileHashes()
    hashes.learn(measure(Task((second,), 60.0, program(), "a batch")).read)
    assert hashes.of(str(cell)) == hashlib.sha256(cell.read_bytes()).hexdigest()


@pytest.mark.slow
def test_a_package_that_a_variable_finds_elsewhere_is_measured_again(
    manifest, tmp_path, monkeypatch
):
    urdf = manifest.parent / "cart.urdf"
    urdf.write_text(
        URDF.replace('<box size="0.2 0.2 0.2"/>', '<mesh filename="package://pk/m.stl"/>')
    )
    for name, size in (("one", 0.2), ("other", 1.0)):
        (tmp_path / name / "pk").mkdir(parents=True)
        trimesh.creation.box([size] * 3).export(tmp_path / name / "pk" / "m.stl")
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "one"))
    _, before = run_here(manifest, tmp_path / "out")
    told, _ = run_here(manifest, tmp_path / "out")
    assert told.measured == []
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "other"))
    told, now = run_here(manifest, tmp_path / "out")
    assert len(told.measured) == len(NEAREST)
    assert statuses(before)["t003"] == "clear" and statuses(now)["t003"] == "contact"


@pytest.mark.parametrize("nearer", ["in/pk/m.stl", "first/pk/m.stl", "first/m.stl"])
@pytest.mark.slow
def test_a_mesh_that_appears_nearer_is_measured(nearer, manifest, tmp_path):
    """In the file's folder, in an earlier package folder, or in one that its manifest makes the package."""
    urdf, cell = manifest.parent / "cart.urdf", manifest.parent / "cell.yaml"
    urdf.write_text(
        URDF.replace('<box size="0.2 0.2 0.2"/>', '<mesh filename="package://pk/m.stl"/>')
    )
    dirs = "[../first, ../last]" if nearer.startswith("first") else "[]"
    cell.write_text(CELL.replace("cart.urdf", f"cart.urdf, package_dirs: {dirs}"))
    (tmp_path / "first").mkdir()
    for folder in ("last/pk", "pk"):  # the last package folder, and the folder above the file's
        (tmp_path / folder).mkdir(parents=True)
        trimesh.creation.box([0.2] * 3).export(tmp_path / folder / "m.stl")
    _, before = run_here(manifest, tmp_path / "out")
    assert run_here(manifest, tmp_path / "out")[0].measured == []
    (tmp_path / nearer).parent.mkdir(exist_ok=True)
    trimesh.creation.box([1.0] * 3).export(tmp_path / nearer)
    (tmp_path / "first" / "package.xml").write_text("<package><name>pk</name></package>")
    told, now = run_here(manifest, tmp_path / "out")
    assert len(told.measured) == len(NEAREST)
    assert statuses(before)["t003"] == "clear" and statuses(now)["t003"] == "contact"
    (tmp_path / nearer).unlink()
    told, again = run_here(manifest, tmp_path / "out")
    assert told.measured == [] and statuses(again) == statuses(before)
