"""JUnit XML: what a build server counts."""

from __future__ import annotations

from xml.etree import ElementTree

from clearance.report import write_junit
from clearance.world.case import Limits
from tests.report.records import disagreeing, record


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
    assert failed(suite) == {"gripper - post"}
    assert suite.get("name") == "swing & <dip>"
    assert (suite.get("tests"), suite.get("failures"), suite.get("skipped")) == ("10", "1", "1")
    assert suite.find("testcase/skipped").get("message") == "excluded: bolted"


def test_the_fail_limit_decides(tmp_path):
    wide = suite_of(tmp_path, limits=Limits(fail=0.1, warn=0.2))
    assert failed(wide) == {"gripper - post", "fore - post"}


def test_contact_fails_without_a_limit(tmp_path):
    assert failed(suite_of(tmp_path, limits=Limits())) == {"gripper - post"}


def test_a_near_miss_passes_and_says_so(tmp_path):
    suite = suite_of(tmp_path, limits=Limits(fail=0.01, warn=0.1))
    told = {case.get("name"): case.findtext("system-out") for case in suite.findall("testcase")}
    assert told["fore - post"].startswith("near miss: ")
    assert not told["upper - table"].startswith("near miss")


def test_a_cross_check_that_disagrees_fails(tmp_path):
    assert "agrees with python-fcl" in failed(suite_of(tmp_path, cross_check=disagreeing()))
