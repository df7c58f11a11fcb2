"""What a build server is told: JUnit, annotations and Markdown; no name can break out of them."""

from __future__ import annotations

import dataclasses
import io
import re
from datetime import date
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from markdown_it import MarkdownIt
from rich.console import Console

import clearance as cl
from clearance.formats.motion.requests import line_of_sample
from clearance.report import junit
from clearance.report.annotations import MOST, annotation_lines, command
from clearance.report.junit_cases import write_run_junit
from clearance.report.markdown import MOST_ROWS, markdown, plain
from clearance.report.moment import sample_at
from clearance.report.terminal import terminal_table
from clearance.report.topic import TerminalTable
from clearance.report.topics import worst
from clearance.run import Question, Run, answer
from clearance.world.notice import Notice, Severity
from clearance.world.placed_robot import PlacedRobot
from clearance.world.rules import Waiver
from clearance.world.timing import Timing
from clearance.world.trajectory import Trajectory
from tests.findings.gates import load_gates, write_gates, write_way
from tests.findings.test_verdict import NOT_KEPT, WARNING, made
from tests.made_cases import at
from tests.report.cells import sliding
from tests.report.made import model_of, run_of, write_junit
from tests.report.records import arm, record
from tests.report.schemas import valid_suite


def failed(suite: ElementTree.Element) -> set[str]:
    return {
        case.get("name") for case in suite.findall("testcase") if case.find("failure") is not None
    }


def test_profiles_and_notices_are_cases_of_their_own(tmp_path):
    """The one that is not kept fails, the one that is passes; suspect input fails, a warning does not."""
    door = dataclasses.replace(NOT_KEPT, name="door", passed=True, gap=0.03)
    notices = (
        Notice(Severity.SUSPECT, "units", "post.stl"),
        Notice(Severity.WARNING, "geometry", "antenna"),
    )
    write_junit(record(profiles=(NOT_KEPT, door), notices=notices), tmp_path / "junit.xml")
    suite = valid_suite(tmp_path / "junit.xml")
    assert failed(suite) == {"verdict", "gripper - post", "floor", "units: post.stl"}
    assert {"door", "geometry: antenna"} <= {case.get("name") for case in suite.findall("testcase")}


def test_names_that_xml_has_no_room_for_are_escaped(tmp_path):
    made = record()
    minimum = dataclasses.replace(
        run_of(made).pair_minima[0], link="arm\uffff\x1b[31m", obstacle="post\ud800"
    )
    write_junit(run_of(made, (minimum,)), tmp_path / "junit.xml")
    names = {case.get("name") for case in valid_suite(tmp_path / "junit.xml").iter("testcase")}
    assert "arm\\uffff\\x1b[31m - post\\ud800" in names


GATES = {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.004), "gate_c": (0.8, 0.015)}


@pytest.mark.parametrize("waive", ["none", "a", "all", "stale"])
def test_a_run_is_red_where_it_is_not_passed(waive, tmp_path):
    patterns = {"none": [], "a": ["gate_a"], "all": ["gate_*"], "stale": ["gate_*", "gate_c"]}
    said = {"at_least": 0.002, "reason": "it gives way", "by": "N. N.", "until": date(2027, 1, 1)}
    waivers = tuple(Waiver(("box", gate), **said) for gate in patterns[waive])
    case = dataclasses.replace(load_gates(tmp_path, GATES), waivers=waivers)
    run = answer(Question(case, today=date(2026, 11, 1)))
    write_junit(run, tmp_path / "junit.xml")
    suite = valid_suite(tmp_path / "junit.xml")
    red = failed(suite)
    assert ("verdict" in red) == (not run.passed) and bool(red) == (not run.passed)
    skipped = {case.get("name"): case.find("skipped").get("message")
               for case in suite if case.find("skipped") is not None}  # fmt: skip
    waived = {f"box - {f.body_b}" for f in run.findings if f.waived is not None}
    assert waived == {name for name, told in skipped.items() if "it gives way" in told}
    if waive == "all":
        assert run.passed and len(waived) == 2


def test_a_file_has_room_for_what_fails_before_all_else(tmp_path, monkeypatch):
    one = record()
    whole = tmp_path / "whole.xml"
    write_junit(one, whole)
    monkeypatch.setattr(junit, "MOST_BYTES", 1500)
    write_junit(one, tmp_path / "junit.xml")
    suite = valid_suite(tmp_path / "junit.xml")
    told = {each.get("name"): each.get("value") for each in suite.find("properties")}
    n_whole = len(valid_suite(whole).findall("testcase"))
    n_left_out = n_whole - len(suite.findall("testcase"))
    assert n_left_out > 0 and told["cases_left_out"] == str(n_left_out)
    assert suite.get("failures") == valid_suite(whole).get("failures")
    assert (tmp_path / "junit.xml").stat().st_size < 1500 + 1000


def test_a_rule_that_no_one_pair_leaves_open_has_a_name_and_the_advice_stands_in_no_column(
    tmp_path, monkeypatch
):
    """Two boxes on clocks that are not tied go at the limit; the proof is given up."""
    monkeypatch.setattr("clearance.simulate.measure.clocks.unsynchronised.MOST_DECIDING", -1)
    way = [(0, 0), (0.3, 0.3), (1, 1)]
    robots = [sliding(name, way, at(y=y, z=0.5)) for name, y in (("a", 0), ("b", 0.2))]
    limits = cl.Limits(rules=(cl.Rule(("a/*", "b/*"), name="apart", fail=0.1, warn=0.2),))
    run = cl.check(cl.Case("at", tuple(robots), (), limits, clock=cl.Clock(np.inf)))
    write_run_junit(run.report, tmp_path / "junit.xml")
    cases = valid_suite(tmp_path / "junit.xml").iter("testcase")
    named = [case.get("name") for case in cases if case.get("classname") == "unproven"]
    assert named == ["the motion between the samples [apart]"]
    row = "| violated | apart | any pair | "
    assert sum(line.startswith(row) for line in markdown(run.report).splitlines()) == 1
    page = run.page()
    assert "not proven any pair" in page and "not proven a finer proof" not in page


BROKEN = {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.004)}


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    return tmp_path_factory.mktemp("gates")


@pytest.fixture(scope="module")
def run(folder) -> Run:
    return cl.check(load_gates(folder, BROKEN))


def lines_of(run: Run, root: Path) -> list[str]:
    return [*annotation_lines(run.report, root)]


def test_a_finding_is_annotated_on_the_row_of_its_moment(run, folder):
    worst = run.findings[0]
    rows = (folder / "way.csv").read_text().splitlines()
    lines = lines_of(run, folder)
    assert len(lines) == 2
    assert lines[0].startswith(
        f"::error file=way.csv,line={worst.step + 2},title=clearance%3A gates::3.000 mm"
    )
    assert float(rows[worst.step + 1].split(",")[0]) == pytest.approx(worst.time, abs=1e-6)


def test_at_most_ten_and_the_worst_first(tmp_path):
    gates = {f"gate_{i}": (-0.9 + 0.15 * i, 0.001 + 1e-4 * i) for i in range(12)}
    lines = lines_of(cl.check(load_gates(tmp_path, gates)), tmp_path)
    assert len(lines) == MOST
    assert [f"gate_{i} at" in line for i, line in enumerate(lines)] == [True] * MOST


def test_steps_are_told_by_the_points_of_the_file_where_these_are_others(tmp_path):
    """The way begins at 1 s; the case gives the start, which is a step before it."""
    path = write_gates(tmp_path, {"gate_a": (0.0, -0.01)})
    write_way(tmp_path / "way.csv", np.linspace(-1.0, 1.0, 41))
    rows = [row.split(",") for row in (tmp_path / "way.csv").read_text().splitlines()[1:]]
    later = [f"{float(time) + 1.0:.6f},{x}" for time, x in rows]
    (tmp_path / "way.csv").write_text("\n".join(["time,slide_x", *later]) + "\n")
    asked = "trajectory: {file: way.csv, start_state: {slide_x: -1.0}}"
    path.write_text(path.read_text().replace("trajectory: way.csv", asked))
    run = cl.check(path)
    line = int(re.search(r"line=(\d+),", lines_of(run, tmp_path)[0])[1])
    time = float((tmp_path / "way.csv").read_text().splitlines()[line - 1].split(",")[0])
    assert time == pytest.approx(run.findings[0].time, abs=1e-6)
    told = dict(worst.lines(run.report))["worst"]
    step, at = run.worst["step"], run.worst["time"]
    point = round((at - 1.0) / 0.05) + 1  # from 1 s on, every 50 ms
    assert told.startswith(f"step {step} of 42 steps, {at:.3f} s, point {point} of 41 of way.csv: ")
    same = dict(worst.lines(cl.check(load_gates(tmp_path / "same", BROKEN)).report))["worst"]
    assert "point" not in same


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("time,a\n0,1\n1,2\n", [2, 3, None]),
        ("\n\ntime,a\n\n0,1\n\n1,2\n", [5, 7, None]),
        ("time;a\n0;1,5\n1;2\n", [2, 3, None]),
        ("0,1\n1,2\n", [1, 2, None]),
    ],
)
def test_the_line_of_a_sample(text, lines, tmp_path):
    (tmp_path / "way.csv").write_text(text)
    assert [line_of_sample(str(tmp_path / "way.csv"), i) for i in range(3)] == lines


def test_a_file_that_is_no_table_has_no_lines(tmp_path):
    for name in ("way.yaml", "way.json", "gone.csv"):
        assert line_of_sample(str(tmp_path / name), 0) is None


def test_a_sample_is_that_at_or_before_a_time_of_the_run():
    trajectory = Trajectory(np.array([0.0, 1.0, 2.0]), ("pan",), np.zeros((3, 1)))
    placed = PlacedRobot(arm(), trajectory)
    assert [sample_at(placed, t) for t in (-1.0, 0.0, 0.9, 1.0, 1.5, 9.0)] == [0, 0, 0, 1, 1, 2]
    stamped = dataclasses.replace(placed, trajectory=trajectory.shifted(1.7e9))
    assert [sample_at(stamped, 1.7e9 + t) for t in (0.0, 0.9, 1.0, 1.5)] == [0, 0, 1, 1]
    late = dataclasses.replace(placed, timing=Timing(start=5.0, rate=2.0, after="loop"))
    assert [sample_at(late, t) for t in (5.0, 5.5, 6.25, 6.5)] == [0, 1, 0, 1]


ANY_TEXT = st.text(max_size=60) | st.sampled_from(
    ["::error::x", "a\n::error::x", "%0A::", "a,line=1::b", "--><script>", "| x |", "`x`", "![a](http://b)",
     "<img src=x>", "@someone", "#1", "http://x.y", "www.x.y", "- a", "1. a", "[x]: y", "~~x~~", "a|b", "$x$"]
)  # fmt: skip


@given(ANY_TEXT, ANY_TEXT)
@example("a\n::error::x", "a\r::error::x")
def test_no_name_ends_a_command_or_begins_another(name, message):
    line = command("error", {"file": name, "title": name}, message)
    assert "\n" not in line and "\r" not in line
    head, told = re.fullmatch(r"::error (file=[^:,]*,title=[^:,]*)::(.*)", line, re.DOTALL).groups()
    for given_text, escaped in ((name, head.split(",")[0][5:]), (message, told)):
        for sign, code in ((":", "%3A"), (",", "%2C"), ("\r", "%0D"), ("\n", "%0A"), ("%", "%25")):
            escaped = escaped.replace(code, sign)
        assert escaped == given_text


@pytest.mark.parametrize("name", ["::error::x", "##vso[task.complete]"])
def test_no_name_that_begins_a_line_of_a_table_is_a_command(name):
    console = Console(file=io.StringIO(), width=80)
    console.print(terminal_table(TerminalTable(("body", "least"), [(name, name)])))
    lines = [line.strip() for line in console.file.getvalue().splitlines()]
    assert not any(line.startswith(("::", "##")) for line in lines)
    assert any(line.startswith(f"'{name}'") for line in lines)


@given(ANY_TEXT | st.text("a1_*`~[]()<>|\\&#;:/.-+=!$@ ", max_size=12))
@example("[CL501](http://x.y)")
@example("CL501]: x")
@example("12) a")
@example("---")
def test_plain_text_stays_text_in_markdown(text):
    """As another parser reads it, in an item of a list and in a cell of a table."""
    expected = " ".join("".join(c if c.isprintable() else " " for c in text).split())
    reader = MarkdownIt("commonmark").enable(["table", "strikethrough"])
    for page in (f"- {plain(text)}\n", f"| a |\n| --- |\n| {plain(text)} |\n"):
        kinds = [one.type for one in reader.parse(page)]
        inline = [one for one in reader.parse(page) if one.type == "inline"]
        letters = inline[-1].children if expected else []
        assert {one.type for one in letters} <= {"text"}
        assert "".join(one.content for one in letters) == expected
        assert kinds[0] in ("bullet_list_open", "table_open") and len(kinds) <= 22
    assert not re.search(r"https?:/|www\.", plain(text), re.IGNORECASE)


def test_names_from_files_do_not_break_out_of_the_table(run):
    finding = dataclasses.replace(
        run.findings[0], body_a="a|b\n| x |", body_b="<script>", rule="`r`"
    )
    model = dataclasses.replace(run.report)
    vars(model)["findings"] = (finding,) * (MOST_ROWS + 7)
    text = markdown(model)
    rows = [line for line in text.splitlines() if line.startswith("|")]
    assert (
        len(rows) == MOST_ROWS + 2 and len({row.replace(r"\|", "").count("|") for row in rows}) == 1
    )
    assert r"\<script\>" in text and r"\`r\`" in text and "7 more findings." in text


def test_what_limits_a_verdict_that_passes_is_a_warning(tmp_path):
    case = load_gates(tmp_path, {"gate": (0.0, 0.1)})
    lines = lines_of(cl.check(case, certify=False), tmp_path)
    assert lines == [
        "::warning title=clearance%3A gates::clear at the samples only: the motion "
        "between the samples is not checked"
    ]
    waivers = (
        Waiver(("box", "gate_a"), at_least=0.002, reason="gives way", by="N. N."),
        Waiver(("box", "gate_b"), at_least=0.002, reason="gives way", by="N. N."),
    )
    waived = cl.check(dataclasses.replace(load_gates(tmp_path, BROKEN), waivers=waivers))
    lines = lines_of(waived, tmp_path)
    assert waived.passed and len(lines) == 2
    assert lines[0].startswith("::warning title=clearance%3A gates::waived: 3.000 mm, below")
    table = markdown(waived.report)
    assert "| violated, waived |" in table and "with 2 waivers" in table


def test_markdown_names_a_warning_once_whether_it_fails_or_not():
    for strict in (False, True):
        text = markdown(model_of(made(notices=(WARNING,), strict=strict)))
        assert text.count("links without a collision shape: antenna") == 1
