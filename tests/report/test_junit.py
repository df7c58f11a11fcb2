"""JUnit XML: what a build server counts."""

from __future__ import annotations

import dataclasses
from xml.etree import ElementTree

from clearance.record.record import ProfileAnswer
from clearance.world.case import Limits
from clearance.world.notice import Notice, Severity
from tests.report.made import run_of, write_junit
from tests.report.records import record


def suite_of(tmp_path, **changes) -> ElementTree.Element:
    write_junit(record(**changes), tmp_path / "junit.xml")
    root = ElementTree.parse(tmp_path / "junit.xml").getroot()
    assert root.tag == "testsuites"
    return root.find("testsuite")


def failed(suite: ElementTree.Element) -> set[str]:
    return {
        case.get("name") for case in suite.findall("testcase") if case.find("failure") is not None
    }


def test_a_violated_pair_fails_and_the_others_pass(tmp_path):
    suite = suite_of(tmp_path)
    assert failed(suite) == {"verdict", "gripper - post"}
    assert suite.get("name") == "swing & <dip>"
    assert (suite.get("tests"), suite.get("failures"), suite.get("skipped")) == ("12", "2", "2")
    skipped = [case.get("message") for case in suite.findall("testcase/skipped")]
    assert skipped[0] == "excluded: bolted" and "samples only" in skipped[1]


def test_the_fail_limit_decides(tmp_path):
    wide = suite_of(tmp_path, limits=Limits(fail=0.1, warn=0.2))
    assert failed(wide) == {"verdict", "gripper - post", "fore - post"}


def test_profiles_and_notices_are_cases_of_their_own(tmp_path):
    """The one that is not kept fails, the one that is passes; suspect input fails, a warning does not."""
    floor = ProfileAnswer(
        "floor",
        "xy",
        None,
        "outside",
        0.02,
        False,
        False,
        -0.003,
        1e-4,
        (0, 0),
        (0, 0),
        "fore",
        7,
    )
    door = dataclasses.replace(floor, name="door", passed=True, gap=0.03)
    notices = (
        Notice(Severity.SUSPECT, "units", "post.stl"),
        Notice(Severity.WARNING, "geometry", "antenna"),
    )
    suite = suite_of(tmp_path, profiles=(floor, door), notices=notices)
    assert failed(suite) == {"verdict", "gripper - post", "floor", "units: post.stl"}
    assert {"door", "geometry: antenna"} <= {case.get("name") for case in suite.findall("testcase")}


def test_names_that_xml_has_no_room_for_are_escaped(tmp_path):
    made = record()
    minimum = dataclasses.replace(
        run_of(made).pair_minima[0], link="arm\uffff\x1b[31m", obstacle="post\ud800"
    )
    write_junit(run_of(made, (minimum,)), tmp_path / "junit.xml")
    suite = ElementTree.parse(tmp_path / "junit.xml").getroot().find("testsuite")
    names = {case.get("name") for case in suite.findall("testcase")}
    assert "arm\\uffff\\x1b[31m - post\\ud800" in names
