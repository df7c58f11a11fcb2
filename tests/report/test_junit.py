"""JUnit XML: what a build server counts."""

from __future__ import annotations

import dataclasses
from datetime import date
from xml.etree import ElementTree

import numpy as np
import pytest

import clearance as cl
from clearance.report import junit
from clearance.report.junit_cases import write_run_junit
from clearance.report.markdown import markdown
from clearance.run import Question, answer
from clearance.world.notice import Notice, Severity
from clearance.world.rules import Waiver
from tests.findings.gates import load_gates
from tests.findings.test_verdict import NOT_KEPT
from tests.made_cases import at
from tests.report.cells import sliding
from tests.report.junit_schema import valid_suite
from tests.report.made import run_of, write_junit
from tests.report.records import record


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
