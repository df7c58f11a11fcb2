"""The files of a report: what the record says, as JSON, tables and moments, without a trace of this machine."""

from __future__ import annotations

import csv
import dataclasses
import functools
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet
import pytest
from hypothesis import given
from hypothesis import strategies as some
from ruamel.yaml import YAML

import clearance as cl
from clearance.cli import run
from clearance.errors import BadInput, MissingFile
from clearance.findings.findings_file import findings_text
from clearance.record.record import Record
from clearance.report import moveit_moments
from clearance.report.summary import json_text
from clearance.report.tables import write_csv
from clearance.report.topics.body_gaps import WIDTHS, body_gaps_of
from clearance.report.topics.provenance import public_path
from clearance.report.topics.worst import sensitivity_blocks, sensitivity_data
from clearance.run import Run
from clearance.world.robot import Joint, JointKind
from tests.case import test_recorded_run as recorded
from tests.findings.test_verdict import made
from tests.formats.making import CASE, write_case
from tests.gains.gantries import along_x, gantry, slot, standing
from tests.made_cases import at
from tests.report.cells import LEFT, box, cell, sliding
from tests.report.made import model_of, run_of, summary_of, write
from tests.report.records import record
from tests.report.schemas import printed_schema
from tests.report.test_golden import OPEN, SUSPECT, SWING, cell_run


def test_joints_without_limits_are_null_and_not_infinity(tmp_path):
    run = record(n_steps=5)
    robot = run.motions[0].placed.robot
    turning = Joint("pan", JointKind.CONTINUOUS, "base", "upper", np.eye(4), np.array([0.0, 0, 1]))
    placed = dataclasses.replace(
        run.motions[0].placed,
        robot=dataclasses.replace(robot, joints=(turning, *robot.joints[1:])),
    )
    run = dataclasses.replace(run, motions=(dataclasses.replace(run.motions[0], placed=placed),))
    joint = json.loads(json_text(summary_of(run)))["worst"]["joints"][0]
    assert (joint["lower"], joint["upper"]) == (None, None)
    write(run, tmp_path / "out")
    assert "no limits" in (tmp_path / "out" / "report.html").read_text()


def test_tracking_error_is_told_when_the_motion_is_simulated():
    run = record(n_steps=5)
    error = np.array([0.0, 0.1, 0.5, 0.2, 0.0])
    steps = run.rows.with_columns({"tracking_error": error})
    assert summary_of(run)["tracking_error"] is None
    told = summary_of(dataclasses.replace(run, table=steps))["tracking_error"]
    assert told == {"greatest": 0.5, "step": 2}


@pytest.mark.parametrize(
    ("path", "shown"),
    [
        ("case.yaml", "case.yaml"),
        ("/home/someone/cell/case.yaml", "case.yaml"),
        ("/home/someone/robots/arm.urdf", "../robots/arm.urdf"),
        (
            "/x/lib/python3.11/site-packages/pybullet_data/kuka_iiwa/model.urdf",
            "pybullet_data:kuka_iiwa/model.urdf",
        ),
    ],
)
def test_paths_name_no_machine(path, shown):
    assert public_path(path, Path("/home/someone/cell")) == shown


def test_no_file_of_a_report_names_the_folder_it_was_made_in(tmp_path):
    write(record(n_steps=20), tmp_path / "out")
    for path in (tmp_path / "out").iterdir():
        assert b"/home/someone" not in path.read_bytes()
        assert str(tmp_path).encode() not in path.read_bytes()


BOX = "scenes/box_box/case.yaml"


@pytest.fixture(scope="module")
def checked():
    return cl.check(BOX, limits=cl.Limits(0.03, 0.05))


def test_a_case_file_can_be_checked_by_its_path(checked):
    loaded = cl.check(cl.load_case(Path(BOX)), limits=cl.Limits(0.03, 0.05))
    assert checked.steps.equals(loaded.steps)
    with pytest.raises(MissingFile):
        cl.check("nowhere.yaml")
    with pytest.raises(BadInput, match="a int is given"):
        cl.check(3)


def test_a_run_is_told_in_a_line(checked):
    told = repr(checked)
    assert "\n" not in told and len(told) < 200
    assert told.startswith(f"<Run {checked.record.case.name}: {checked.verdict.headline()}, ")
    assert checked.worst["link"] in told and checked.worst["obstacle"] in told
    unchecked = "self-collision not checked [CL531]"
    assert str(checked).startswith(told) and str(checked).splitlines()[1].strip() == unchecked
    assert checked.verdict.text() == f"{checked.verdict.headline()}; {unchecked}"


@pytest.mark.parametrize("certify", [True, False])
def test_the_worst_moment_names_its_bodies_in_both_ways_whatever_moves(certify):
    """Two cubes of 0.1 m pass each other, 0.11 m apart in height; at both samples they are 0.9 m aside too."""
    one = sliding("left", [(0, 0), (1, 1)])
    other = sliding("right", [(0, 1), (1, 0)], base=at(z=0.71))
    apart = cl.check(cl.Case("passing", (one, other), ()), certify=certify)
    for row in (apart.worst, apart.worst_sample):
        assert (row["link"], row["obstacle"]) == ("left/tool", "right/tool")
        for side, name in (("body_a", "link"), ("body_b", "obstacle")):
            stem = side.removeprefix("body_")
            assert row[side] == row[name]
            assert [row[f"{stem}_{x}"] for x in "xyz"] == [row[f"{name}_{x}"] for x in "xyz"]
    assert apart.worst.get("between", False) == certify
    assert apart.worst["clearance"] == pytest.approx(0.11 if certify else np.hypot(0.9, 0.11))


def test_summary_and_events_are_those_of_the_report(checked, tmp_path):
    folder = checked.save(tmp_path / "out")
    assert folder == tmp_path / "out"
    written = json.loads((folder / "summary.json").read_text())
    assert json.loads(json.dumps(checked.summary)) == written
    assert [event.what for event in checked.events] == [
        event["what"] for event in written["events"]
    ]
    assert checked.events


finite = some.floats(allow_nan=False, allow_infinity=False)


@given(some.lists(finite, min_size=1, max_size=40))
def test_floats_come_back_from_csv_bit_for_bit(tmp_path_factory, values):
    path = tmp_path_factory.mktemp("csv") / "steps.csv"
    write_csv(lambda: [pa.table({"clearance": pa.array(values, pa.float64())})], path)
    with path.open(newline="") as file:
        back = [float(row["clearance"]) for row in csv.DictReader(file)]
    assert [value.hex() for value in back] == [float(value).hex() for value in values]


@pytest.mark.parametrize("name", ["plain", "with, comma", 'with "quotes"', "two\nlines"])
def test_names_come_back_from_csv(tmp_path, name):
    write_csv(lambda: [pa.table({"link": [name], "clearance": [0.1]})], tmp_path / "steps.csv")
    with (tmp_path / "steps.csv").open(newline="") as file:
        assert list(csv.DictReader(file)) == [{"link": name, "clearance": "0.1"}]


def table_of(case):
    data = sensitivity_data(cl.check(case).report.sensitivity)
    return data, repr(sensitivity_blocks(data, several_robots=False))


def test_one_number_says_both_ways():
    data, text = table_of(slot(fail=0.04, off=0.03))
    (rate,) = (one for one in data["rates"] if one["kind"] == "joint" and one["name"] == "y")
    assert rate["both_ways"] and "one way" not in text
    assert "+1.000" in text and "-1.000" in text and "obstacle left, y" in text


def test_what_holds_one_way_only_says_so():
    data, text = table_of(slot(fail=0.04, off=0.0))
    assert len(data["pairs"]) == 2
    assert "each figure holds in its direction only" in text and "As near are" in text


def test_of_bodies_in_contact_it_is_not_worked_out():
    post = standing("post", cl.box((0.1,) * 3), (0, 0, 0))
    data, text = table_of(cl.Case("hit", (along_x(gantry()),), (post,)))
    assert data["rates"] == [] and "not computed: the bodies are in contact" in text


WIDE = (cl.Rule(("*", "*"), name="wide", fail=0.0, warn=9.0),)
LIMITS = cl.Limits(fail=0.01, warn=0.3)


def moments_text(made) -> str:
    return moveit_moments.moments_text(model_of(made))


def read(text: str):
    return YAML(typ="safe", pure=True).load(text)


def test_the_worst_comes_first_and_all_pairs_below_a_limit_follow():
    run = record(limits=LIMITS)
    told = read(moments_text(run))
    minima = {(one.link, one.obstacle): one.clearance for one in run_of(run).pair_minima}
    below = {pair: least for pair, least in minima.items() if least < LIMITS.warn}
    names = [(m["bodies"][0]["link_name"], m["bodies"][1]["id"]) for m in told["moments"]]
    assert set(names) == set(below) and len(names) == len(below) > 1
    assert [m["clearance"] for m in told["moments"]] == sorted(below.values())


def test_what_is_too_much_is_left_out_and_counted(monkeypatch):
    run = record(limits=LIMITS)
    n = len(read(moments_text(run))["moments"])
    monkeypatch.setattr(moveit_moments, "MOST", n - 2)
    told = read(moments_text(run))
    assert (len(told["moments"]), told["n_left_out"]) == (n - 2, 2)


def test_links_name_their_robot_where_there_are_several_and_held_parts_the_link():
    part, wall = box("part", (0.05, 0.05, 0.05), at(0.5, z=0.9)), box("wall", (0.1, 2, 2), at(1.6))
    carries = (cl.Carry("part", "left/tool", cl.Window(0.0)),)
    robots = sliding("left", LEFT), sliding("right", LEFT, at(0.0, 3.0))
    case = cell(WIDE, robots, (part, wall), carries)
    moments = read(moments_text(cl.check(case)))["moments"]
    bodies = [body for moment in moments for body in moment["bodies"]]
    assert {"type": "ROBOT_LINK", "link_name": "tool", "robot": "left"} in bodies
    assert {"type": "ROBOT_ATTACHED", "id": "part", "link_name": "tool", "robot": "left"} in bodies
    assert {"type": "WORLD_OBJECT", "id": "wall"} in bodies
    left, right = moments[0]["robot_states"]
    assert left["attached_collision_objects"] == [{"link_name": "tool", "object": {"id": "part"}}]
    assert (right["robot"], right["attached_collision_objects"]) == ("right", [])


DEMO = Path(cl.__file__).parent / "demo"

RUNS: dict[str, Callable[[Path], Run]] = {
    "contact and a dispute": lambda _: run_of(SWING),
    "tolerances": lambda _: run_of(OPEN),
    "suspect": lambda _: run_of(SUSPECT),
    "two robots": lambda _: run_of(record(n_robots=2)),
    "parts and rules": lambda _: cell_run(),
    "a program": lambda _: cl.check(DEMO / "seam.yaml", need="minimum"),
    "gaps": lambda _: cl.check(DEMO / "post.yaml", need="pairs", body_gaps=True, contact="none"),
    "a recorded run": lambda folder: cl.check(
        recorded.case(folder), motion="recorded", recorded=folder / "run.csv"
    ),
}


@pytest.fixture(scope="module")
def errors() -> Callable[[str, dict], list[str]]:
    """Asks the schema of a file, as the command prints it, what it objects to."""
    validators = {name: printed_schema("--results", name)[1] for name in ("summary", "findings")}
    return lambda name, told: [error.message for error in validators[name].iter_errors(told)]


def files(made: Run) -> dict[str, dict]:
    """What the two files of a run hold."""
    summary = json.loads(json.dumps(made.summary))
    return {"summary": summary, "findings": json.loads(findings_text(made.finding_list))}


SLOW = {"a program", "gaps", "parts and rules"}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name in SLOW)) for name in RUNS]
)
def test_what_a_run_writes_keeps_to_the_schema_that_it_names(name, errors, tmp_path):
    for file, told in files(RUNS[name](tmp_path)).items():
        assert errors(file, told) == []
        assert told["$schema"] == f"urn:clearance:{file}:{told['format']}"


@pytest.mark.slow
def test_a_key_more_or_less_and_another_type_are_refused(errors):
    for file, told in files(cell_run()).items():
        for key in told:
            assert errors(file, {one: told[one] for one in told if one != key}), key
        assert errors(file, told | {"key": 1})
    summary = files(cell_run())["summary"]
    for key, value in {"passed": "no", "worst": {}, "rules": {}, "n_steps": 1.5}.items():
        assert errors("summary", summary | {key: value}), key


@functools.cache
def swing() -> Record:
    return dataclasses.replace(made(), body_gaps=True)


def test_a_gap_may_catch_what_needs_more(tmp_path):
    assert [WIDTHS[part] for part in ("body", "head", "finger")] == [0.5, 0.3, 0.025]
    near = [one for one in run_of(swing()).pair_minima if one.clearance < 0.5]
    told = body_gaps_of(run_of(swing()).pair_minima, frozenset({"post", "table", "wall </script>"}))
    assert len(told) == len(near)
    for one, minimum in zip(told, near, strict=True):
        assert one["gap"] == minimum.clearance
        assert one["may_catch"] == [
            part for part, width in WIDTHS.items() if minimum.clearance < width
        ]


def test_what_moves_on_both_sides_is_a_gap():
    both = dataclasses.replace(run_of(swing()).pair_minima[0], link="tool", obstacle="elbow")
    (told,) = body_gaps_of([dataclasses.replace(both, clearance=0.3)], frozenset({"post"}))
    assert told["may_catch"] == ["body"]


def test_pairs_that_both_stand_are_left_out(tmp_path):
    text = CASE.replace("xyz: [1.2, 0, 0]", "xyz: [0.2, 0.3, 0]")
    assert text != CASE
    file = write_case(tmp_path, text)
    found = cl.answer(cl.Question(cl.load_case(file), body_gaps=True))
    told = body_gaps_of(found.pair_minima, found.session.standing_bodies)
    pairs = {(one["body_a"], one["body_b"]) for one in told}
    nearest = {(one.link, one.obstacle): one.clearance for one in found.pair_minima}
    assert ("base", "post") in nearest and nearest["base", "post"] < 0.5
    assert pairs == {("upper", "post")}


def test_on_the_command_line(tmp_path, refusal, capsys):
    file = write_case(tmp_path, CASE.replace("xyz: [1.2, 0, 0]", "xyz: [0.2, 0.6, 0]"))
    run(["check", str(file), "--body-gaps"])
    assert "body gaps   " in capsys.readouterr().out
    told = refusal("check", file, "--body-gaps", "--need", "minimum")
    assert "body gaps need the least of every pair" in told


def test_padding_is_told_where_there_is_some():
    wall = box("wall", (0.1, 1, 1), at(1.6), padding=0.01)
    case = cell(WIDE, (sliding("arm", LEFT),), (wall,), ())
    moment = read(moments_text(cl.check(case)))["moments"][0]
    assert moment["padding"] == 0.01
    assert moment["distance"] == pytest.approx(moment["clearance"] + 0.01, abs=1e-15)
