"""The pytest plugin, run in pytest: what it collects, what fails and says what, and that it costs nothing."""

from __future__ import annotations

import dataclasses
import re
import subprocess
import sys
import tomllib
import warnings
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.case.case_list import cases_in
from clearance.errors import BadInput
from clearance.pytest_plugin import assert_clear
from clearance.simulate.measure import refine
from clearance.world.notice import Notice, Severity
from clearance.world.placed_robot import SelfClearance
from tests.findings.gates import load_gates, write_gates
from tests.made_cases import arm, at

pytest_plugins = ["pytester"]

ROOT = Path(__file__).parents[2]
HOME = Path.home()
"""Where compiled kernels are kept; a run inside a test has another home, unless it is told."""
A, B = "gate_a", "gate_b"
BROKEN = {A: (-0.5, 0.003), B: (0.5, 0.1)}
CLEAR = {A: (-0.5, 0.05), B: (0.5, 0.1)}
RULES = (
    "{fail: 0.005, warn: 0.02, rules: [{name: tight, between: [box, gate_b], fail: 0.001}, "
    "{between: [box, gate_c], fail: 0.001}]}"
)


@pytest.fixture(scope="module", autouse=True)
def run(tmp_path_factory):
    """A run and its report; pytest inside a test forgets what it imports, and numba can be imported once only."""
    folder = tmp_path_factory.mktemp("gates")
    made = cl.check(load_gates(folder, BROKEN), need="limit")
    made.save(folder / "report")
    return made


def alone(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of all plugins that are installed none is loaded by itself."""
    monkeypatch.setenv("PYTEST_DISABLE_PLUGIN_AUTOLOAD", "1")
    monkeypatch.setenv("PYTHONPATH", str(ROOT))
    monkeypatch.setenv("HOME", str(HOME))


@pytest.fixture
def inside(pytester, monkeypatch):
    """Runs pytest with the plugin alone in the folder of the test."""
    alone(monkeypatch)

    def run(*arguments: str) -> pytest.RunResult:
        return pytester.runpytest("-p", "clearance.pytest_plugin", *arguments)

    return run


def write_case(
    folder: Path, gates=BROKEN, *extra: str, name="cell.clearance.yaml", **changes
) -> Path:
    return write_gates(folder, gates, *extra, **changes).rename(folder / name)


def test_a_case_is_a_test_a_rule_and_one_for_the_verdict(inside, pytester):
    gates = BROKEN | {"gate_c": (0.7, 0.1)}
    write_case(pytester.path, gates, limits=RULES)
    result = inside("-v")
    result.assert_outcomes(passed=2, failed=2)
    told = result.stdout.str()
    assert "cell.clearance.yaml::rule default FAILED" in told
    assert "cell.clearance.yaml::rule tight PASSED" in told
    assert "cell.clearance.yaml::rule box - gate_c PASSED" in told
    assert "cell.clearance.yaml::verdict FAILED" in told


def test_a_failure_says_who_how_near_when_and_where_the_page_is(inside, pytester):
    write_case(pytester.path)
    told = inside("--clearance-out", "reports").stdout.str()
    assert "3.000 mm, below the fail limit of 5 mm: box - gate_a at 0.350 s, step 7" in told
    page = pytester.path / "reports" / "cell.clearance.yaml" / "report.html"
    assert f"page: {page}" in told and page.is_file()
    assert "Traceback" not in told and "collected.py" not in told
    assert "--clearance-out DIR writes the page" in inside().stdout.str()


def test_each_case_has_a_report_of_its_own(inside, pytester):
    for folder, gates in (("weld", BROKEN), ("weld-a", CLEAR)):
        (pytester.path / folder).mkdir()
        write_case(pytester.path / folder, gates)
    inside("--clearance-out", "reports").assert_outcomes(passed=2, failed=2)
    summary = pytester.path / "reports" / "weld" / "cell.clearance.yaml" / "summary.json"
    assert '"verdict": "violated"' in summary.read_text()


def test_a_case_that_is_refused_leaves_no_older_report_green(inside, pytester):
    file = write_case(pytester.path, CLEAR)
    inside("--clearance-out", "reports").assert_outcomes(passed=2)
    folder = pytester.path / "reports" / file.name
    assert (folder / "summary.json").is_file()
    file.write_text(file.read_text().replace("trajectory", "trajectori"))
    inside("--clearance-out", "reports").assert_outcomes(failed=2)
    assert not (folder / "summary.json").exists()
    assert "Not finished" in (folder / "report.html").read_text()


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("cases: ['no_*.yaml']", "no file is called 'no_*.yaml'"),
        ("cases: ['../*.yaml']", "a pattern below the folder of the list, without `..`"),
        ("cases: [a.yaml]\nname: x", "no list of cases"),
        ("- 1", "no mapping"),
    ],
)
def test_a_bad_list_is_one_line(text, told, tmp_path):
    (tmp_path / "all.clearance.yaml").write_text(text)
    with pytest.raises(BadInput, match=re.escape(told)):
        list(cases_in(tmp_path / "all.clearance.yaml"))


def test_a_bad_list_fails_when_it_is_collected(inside, pytester):
    (pytester.path / "all.clearance.yaml").write_text("cases: 7")
    result = inside()
    result.assert_outcomes(errors=1)
    assert "no list of cases" in result.stdout.str() and "Traceback" not in result.stdout.str()


def test_options_of_a_check_are_taken(inside, pytester):
    write_case(pytester.path)
    inside("--clearance-fail-mm", "2").assert_outcomes(passed=2)
    assert inside("--clearance-fail-mm", "-2").ret == pytest.ExitCode.USAGE_ERROR


def test_what_is_waived_is_skipped_and_an_unused_waiver_fails(inside, pytester):
    (pytester.path / "waivers.yaml").write_text(
        "- {between: [box, gate_a], at_least: 0.002, reason: gives way, by: N. N., until: 9999-01-01}\n"
    )
    write_case(pytester.path, BROKEN, "waivers: [waivers.yaml]")
    result = inside("-rs")
    result.assert_outcomes(passed=1, skipped=1)
    assert "by N. N.: gives way" in result.stdout.str()
    write_case(pytester.path, CLEAR, "waivers: [waivers.yaml]")
    result = inside()
    result.assert_outcomes(passed=1, failed=1)
    assert "is not needed" in result.stdout.str()


def test_in_a_run_that_is_suspect_no_rule_passes(inside, pytester):
    path = write_case(pytester.path, CLEAR)
    path.write_text(path.read_text().replace("xyz: [0.5,", "xyz: [5000,"))
    result = inside("-rs")
    result.assert_outcomes(failed=1, skipped=1)
    assert "the test of the verdict fails: suspect units" in result.stdout.str()
    path.write_text(path.read_text() + "accept: [units]\n")
    inside().assert_outcomes(passed=2)


TESTS = """
import pytest
from clearance.pytest_plugin import assert_clear

def test_of_a_case(clearance_case):
    run = clearance_case("cell/case.yaml")
    assert run.record.need == "minimum"
    assert_clear(run, between=("box", "gate_b"), at_least=0.05)
    with pytest.raises(AssertionError, match="3.000 mm, below the fail limit"):
        assert_clear(run)
"""


def test_the_fixture_checks_a_case_by_its_path(inside, pytester):
    write_gates(pytester.path / "cell", BROKEN)
    pytester.makepyfile(TESTS)
    inside("--clearance-need", "minimum").assert_outcomes(passed=1)


def test_what_is_refused_in_a_test_shows_the_line_of_the_test_alone(inside, pytester):
    write_gates(pytester.path / "cell", CLEAR)
    pytester.makepyfile("""
from clearance.pytest_plugin import assert_clear

def test_of_no_pair(clearance_case):
    assert_clear(clearance_case("cell/case.yaml"), between=("box", "gate_aa"))

def test_of_no_case(clearance_case):
    clearance_case("cell/none.yaml")
""")
    told = inside()
    told.assert_outcomes(failed=2)
    lines = told.stdout.str()
    assert "did you mean 'gate_a'?" in lines and "there is no file 'none.yaml'" in lines
    assert "kept.py" not in lines and "collected.py" not in lines and "in __init__" not in lines


@pytest.mark.cold
def test_the_plugin_imports_nothing_that_measures():
    """Every pytest run of who has this package installed imports the plugin."""
    heavy = "{'numba', 'numpy', 'pyarrow', 'pydantic', 'rich', 'ruamel'}"
    script = (
        f"import pytest; import clearance.pytest_plugin, sys; print({heavy} & {{*sys.modules}})"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT, check=True
    )
    assert done.stdout.strip() == "set()"


def test_the_package_declares_its_plugin():
    told = tomllib.loads((ROOT / "pyproject.toml").read_text())
    assert told["project"]["entry-points"]["pytest11"] == {"clearance": "clearance.pytest_plugin"}


@pytest.mark.parametrize(
    ("asked", "told"),
    [
        ({}, "below the fail limit of 5 mm: box - gate_a"),
        ({"between": ("box", A)}, "box - gate_a: 3.000 mm at 0.350 s, step 7; the fail limit is 5 mm"),
        ({"between": ("box", B), "at_least": 0.2}, "box - gate_b: 100.0 mm at"),
    ],
)  # fmt: skip
def test_what_comes_nearer_is_told(run, asked, told):
    with pytest.raises(AssertionError) as error:
        assert_clear(run, **asked)
    assert told in str(error.value) and "gates is not clear" in str(error.value)


def test_exactly_as_far_as_asked_for_is_far_enough_where_the_work_suffices(run, monkeypatch):
    assert_clear(run, between=("box", B), at_least=0.1)
    monkeypatch.setattr(refine, "MOST_QUERIES", -1)
    with pytest.raises(AssertionError, match=r"only 99\.9.*undecided"):
        assert_clear(run, between=("box", B), at_least=0.1)


def test_contact_is_never_clear(tmp_path):
    run = cl.check(load_gates(tmp_path, {A: (0.0, 0.0)}, limits="{fail: 0}"))
    with pytest.raises(AssertionError, match="contact at"):
        assert_clear(run, between=("box", A), at_least=0.0)


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("certify", [True, False])
def test_tolerances_count_whichever_pair_is_asked_about(tmp_path, certify):
    case = load_gates(tmp_path, CLEAR)  # 50 and 100 mm
    off = {"obstacles": {A: {"xyz": 0.048}, B: {"xyz": 0.03}}}
    run = cl.check(case, tolerance=off, certify=certify)
    assert_clear(run, between=("box", B), at_least=0.0698)
    for asked, told in (
        ({"between": ("box", B), "at_least": 0.0701}, "box - gate_b: with tolerances only"),
        ({"between": ("box", A)}, "; the fail limit is 5 mm"),
        ({"at_least": 0.01}, "at least 10 mm was asked for"),
    ):
        with pytest.raises(AssertionError, match="with tolerances only") as error:
            assert_clear(run, **asked)
        assert told in str(error.value)
    off["obstacles"][A] = {"xyz": 0.06}
    run = cl.check(case, tolerance=off, certify=certify)
    with pytest.raises(AssertionError, match="contact is not ruled out; at least 0 mm"):
        assert_clear(run, between=("box", A), at_least=0.0)
    accepted = cl.check(case, tolerance=off | {"unproven_ok": True}, certify=certify)
    assert_clear(accepted, between=("box", A))
    with pytest.raises(AssertionError, match="contact is not ruled out; at least 0 mm"):
        assert_clear(accepted, between=("box", A), at_least=0.0)


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_suspect_input_is_never_clear_whichever_pair_is_asked_about(tmp_path):
    case = load_gates(tmp_path, CLEAR)
    doubt = Notice(Severity.SUSPECT, "units", "lengths look like millimetres")
    suspect = cl.check(dataclasses.replace(case, notices=(*case.notices, doubt)), need="limit")
    for asked in ({"between": ("box", A)}, {"at_least": 0.001}, {}):
        with pytest.raises(AssertionError, match="suspect units: lengths look like"):
            assert_clear(suspect, **asked)
    accepted = dataclasses.replace(suspect.record.case, accept=("units",))
    assert_clear(cl.check(accepted, need="limit"), between=("box", A))


def test_what_is_asked_is_proven_whatever_the_run_is(tmp_path):
    """The box passes the wall between two samples, 3 mm away; at both it is farther than 200 mm."""
    case = load_gates(tmp_path, {A: (0.0, 0.003)}, n_steps=4)
    run = cl.check(case, certify=False)
    assert run.worst["clearance"] > 0.05
    with pytest.raises(AssertionError, match="at least 5 mm was asked for"):
        assert_clear(run, between=("box", A), at_least=0.005)


def test_pairs_that_a_pattern_means_and_that_are_excused_are_told(tmp_path):
    run = cl.check(load_gates(tmp_path, CLEAR, "allow: [[box, gate_a]]"))
    with pytest.warns(UserWarning, match="not measured are box - gate_a "):
        assert_clear(run, between=("box", "gate_*"), at_least=0.02)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert_clear(run, between=("box", B), at_least=0.02)


@pytest.fixture(scope="module")
def swaying():
    """A run of two links over a bare root, beside a post, whose links are not measured against one another."""
    links, post = [cl.box((0.5, 0.1, 0.1)), cl.box((0.4, 0.08, 0.08))], cl.box((0.1, 0.1, 2.0))
    return cl.check(arm("swaying", links, [(post, at(x=1.9))], np.array([[0.0, 0.1], [0.1, 0.0]])))


def test_what_stands_in_the_headline_beside_clear_is_a_warning(inside, pytester):
    write_case(pytester.path, CLEAR)
    inside().assert_outcomes(passed=2, warnings=0)
    result = inside("--clearance-samples-only")
    result.assert_outcomes(passed=2, warnings=1)
    assert "gates: clear at the samples only" in result.stdout.str()


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("between", [None, ("*", "*"), ("l2", "*"), ("o*", "l?")])
def test_links_of_one_robot_that_are_not_measured_are_told_wherever_they_are_meant(
    swaying, between
):
    with warnings.catch_warnings(record=True, action="always") as found:
        assert_clear(swaying, between=between, at_least=0.001)
    told = [one for one in found if "not measured are" in str(one.message)]
    meant = between != ("o*", "l?")
    assert len(told) == meant
    for one in told:
        assert "not measured are l2 - l1 (self-collision not checked)" in str(one.message)
    by_hand = dataclasses.replace(swaying.record.case.robots[0], self_clearance=SelfClearance())
    measured = cl.check(dataclasses.replace(swaying.record.case, robots=(by_hand,)))
    with pytest.warns(UserWarning, match=r"not measured are l2 - l1 \(excused: Adjacent\)$"):
        assert_clear(measured, between=("*", "*"), at_least=0.001)


@pytest.mark.parametrize(
    ("between", "told"),
    [
        (("l1", "l2"), "no pair is measured between ['l1', 'l2']: l2 - l1 (self-collision not checked)"),
        (("[l]0", "o0"), "'[l]0' matches l0 alone: no geometry"),
        (("basis", "*"), "no body is called 'basis'"),
    ],
)  # fmt: skip
def test_a_pattern_of_what_is_not_measured_says_why(swaying, between, told):
    with pytest.raises(BadInput, match=re.escape(told)):
        assert_clear(swaying, between=between)


def test_a_listed_case_that_is_a_link_to_nowhere_is_not_left_out(tmp_path):
    write_case(tmp_path, name="there.yaml")
    (tmp_path / "gone.yaml").symlink_to("nowhere.yaml")
    listed = tmp_path / "all.clearance.yaml"
    listed.write_text('cases: ["*.yaml"]')
    assert [path.name for path in cases_in(listed)] == ["gone.yaml", "there.yaml"]


def test_a_name_that_nothing_has_checked_stays_on_one_line(inside, pytester):
    rule = r'{name: "x\n::error::told", between: [box, gate_b], fail: 0.001}'
    write_case(pytester.path, limits=f"{{fail: 0.005, rules: [{rule}]}}")
    result = inside()
    result.assert_outcomes(failed=3)
    assert not [line for line in result.outlines if line.startswith("::error")]
