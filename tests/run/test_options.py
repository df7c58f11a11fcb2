"""Options are declared once: every door takes all of them and makes the same of what is said in its own way."""

from __future__ import annotations

import argparse
import re
from dataclasses import dataclass, replace
from datetime import date
from pathlib import Path

import click
import numpy as np
import pytest

import clearance as cl
from clearance.batch.manifest_file import manifest_of
from clearance.cli.options import asked_options, said, spelled_by
from clearance.errors import BadDimension, BadInput, UnknownKey
from clearance.options import LENGTH, SWITCH, check_values, made, option, options_in
from clearance.pytest_plugin import PREFIX, pytest_addoption
from clearance.run import CheckOptions, Question
from clearance.world.notice import KINDS, START, WARNED_TOO, Notice, Severity, accepted_kind
from clearance.world.rules import Waiver
from tests.findings.gates import load_gates

NAMES = {name for name, one in options_in(CheckOptions).items() if one.said}
WAIVER = Waiver(("box", "gate_a"), at_least=0.002, reason="soft", by="me", until=date(2027, 1, 1))

EVERY = {
    # option: in Python, on the command line, in a manifest (key, value)
    "need": ("pairs", "--need pairs", ("need", "pairs")),
    "certify": (False, "--samples-only", ("samples_only", True)),
    "certify_gap": (0.0005, "--certify-mm 0.5", ("certify_gap", 0.0005)),
    "contact": ("every", "--contact every", ("contact", "every")),
    "body_gaps": (True, "--body-gaps", ("body_gaps", True)),
    "cross_check": (True, "--cross-check", ("cross_check", True)),
    "method": ("paper", "--method paper", ("method", "paper")),
    "paper_tolerance": (2.5, "--paper-tolerance-mm 2500 --method paper", ("paper_tolerance", 2.5)),
    "motion": ("simulated", "--motion simulated", ("motion", "simulated")),
    "today": (date(2026, 11, 1), "--today 2026-11-01", ("today", "2026-11-01")),
    "fail": (0.005, "--fail-mm 5", ("limits", {"fail": 0.005})),
    "warn": (0.02, "--warn-mm 20", ("limits", {"warn": 0.02})),
    "accept": (("units", "rest"), "--accept units --accept CL429", ("accept", ["units", "CL429"])),
    "fail_on_warning": (True, "--fail-on-warning", ("fail_on_warning", True)),
    "tolerance": ("t.yaml", "--tolerance t.yaml", ("tolerance", "t.yaml")),
    "unproven_ok": (True, "--unproven-ok", ("unproven_ok", True)),
    "waivers": (("a.yaml",), "--waivers a.yaml", ("waivers", ["a.yaml"])),
    "recorded": ("run.csv", "--recorded run.csv", ("recorded", "run.csv")),
    "recorded_offset": (-3.2, "--recorded-offset=-3.2", ("recorded_offset", -3.2)),
    "recorded_robot": ("left", "--recorded-robot left", ("recorded_robot", "left")),
    "recorded_gaps": ("hold", "--recorded-gaps hold", ("recorded_gaps", "hold")),
    "recorded_columns": (
        {"time": "t", "rail": "rail"}, "--recorded-columns time=t,rail",
        ("recorded_columns", {"time": "t", "rail": "rail"}),
    ),
}  # fmt: skip

BESIDE = {
    "paper_tolerance": {"method": "paper"},
    **{name: {"motion": "recorded", "recorded": "run.csv"} for name in EVERY if "recorded" in name},
}
"""What an option says something beside."""


def in_python(name: str) -> CheckOptions:
    return made(CheckOptions, BESIDE.get(name, {}) | {name: EVERY[name][0]})


@click.command()
@asked_options(CheckOptions)
def command(**given):
    return made(CheckOptions, said(CheckOptions, given), spelled_by(CheckOptions))


def on_the_command_line(text: str) -> CheckOptions:
    with command.make_context("check", text.split()) as context:
        return command.invoke(context)


def words(name: str) -> str:
    others = {"motion": "recorded", "recorded": "run.csv"} if "recorded" in name else {}
    beside = " ".join(f"--{one} {value}" for one, value in others.items() if one != name)
    return f"{EVERY[name][1]} {beside}"


def test_each_kind_of_warning_that_is_made_can_be_accepted_by_its_code():
    sources = (path.read_text() for path in Path(cl.__file__).parent.rglob("*.py"))
    made_of = re.compile(r'(?:Severity\.WARNING[^,]*|severity), *\s*(?:"([^"]+)"|START)')
    kinds = {kind or START for text in sources for kind in made_of.findall(text)}
    one = (Notice(Severity.WARNING, kind, "") for kind in kinds)
    assert len(kinds) > 10 and all(it.accepted_by((accepted_kind(it.code),)) for it in one)
    assert kinds & set(KINDS) == set(WARNED_TOO)


def test_the_table_here_is_of_all_options():
    assert set(EVERY) == NAMES


@pytest.mark.parametrize("name", EVERY)
def test_the_command_line_says_the_same_as_python(name):
    assert on_the_command_line(words(name)) == in_python(name)


@pytest.mark.parametrize("name", EVERY)
def test_a_manifest_says_the_same_with_files_seen_from_its_folder(name, tmp_path):
    key, value = EVERY[name][2]
    raw = {"cases": ["a.yaml"], **BESIDE.get(name, {}), key: value}
    _, found = manifest_of(raw, tmp_path / "batch.yaml")
    asked = made(CheckOptions, found)
    there = {one: getattr(asked, one) for one in options_in(CheckOptions)}
    here = {one: getattr(in_python(name), one) for one in options_in(CheckOptions)}
    for one, paths in in_python(name).files.items():
        if paths:
            here[one] = tuple(tmp_path / path for path in paths)
            here[one] = here[one] if one == "waivers" else here[one][0]
    assert there == here


@pytest.mark.parametrize("name", EVERY)
def test_pytest_says_the_same(name):
    parser = argparse.ArgumentParser()
    parser.getgroup = lambda *_: parser
    parser.addoption = parser.add_argument
    pytest_addoption(parser)
    given = vars(parser.parse_args(words(name).replace("--", "--clearance-").split()))
    told = {one: given[f"{PREFIX}{one}"] for one in NAMES if given[f"{PREFIX}{one}"] is not None}
    assert made(CheckOptions, told) == in_python(name)


REFUSED = [
    # what is given, error, words
    ({"need": "all"}, BadInput, "need: 'all' is given; one of steps, pairs, limit, minimum"),
    ({"certify": 3}, BadInput, "certify: 3 is given; True or False"),
    ({"certify_gap": 0.0}, BadDimension, "certify_gap: 0.0 is given; a length above 0"),
    ({"certify_gap": 0.1, "certify": False}, BadInput, "certify_gap says nothing with certify=False"),
    ({"paper_tolerance": 0.1}, BadInput, "paper_tolerance says nothing without method='paper'"),
    ({"fail": -1.0}, BadDimension, "fail: -1.0 is given; a length, 0 or more"),
    ({"fail": float("nan")}, BadDimension, "fail: nan is given"),
    ({"accept": ["unit"]}, BadInput, "accept: 'unit' is given; kinds of suspect input: units, limits"),
    ({"today": "1.4.2027"}, BadInput, "today: '1.4.2027' is given; a day, as 2027-03-31"),
    ({"limits": (0.1, 0.2)}, BadInput, "limits: (0.1, 0.2) is given; a Limits"),
    ({"tolerance": 3}, BadInput, "tolerance: 3 is given; a mapping, the path of a file, or a Budget"),
    ({"waivers": [3]}, BadInput, "waivers: 3 is given; the path of a file, or a Waiver"),
    ({"recorded": "run.csv"}, BadInput, "recorded says nothing without motion='recorded'"),
    ({"motion": "recorded"}, BadInput, "recorded: nothing is given"),
    ({"body_gaps": True, "need": "limit"}, BadInput, "body gaps need the least of every pair"),
    ({"need": "limit", "cross_check": True}, BadInput, "cross-check needs every step, not 'limit'"),
    ({"need": "pairs", "method": "paper"}, BadInput, "method 'paper' measures every step"),
    ({"needs": "limit"}, UnknownKey, "there is no option 'needs'; did you mean 'need'?"),
    ({"needs": "limit"}, TypeError, "there is no option 'needs'; did you mean 'need'?"),
]  # fmt: skip


@pytest.mark.parametrize(("given", "fault", "told"), REFUSED)
def test_each_fault_is_one_line_with_the_option(given, fault, told):
    with pytest.raises(fault) as caught:
        made(CheckOptions, given)
    assert str(caught.value).startswith(told)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("--fail-mm x", "'x' is given; a length, 0 or more [mm]"),
        ("--certify-mm 1 --samples-only", "--certify-mm says nothing with --samples-only"),
        ("--recorded-gaps hold", "--recorded-gaps says nothing without --motion recorded"),
        ("--paper-tolerance-mm 5", "--paper-tolerance-mm says nothing without --method paper"),
        ("--recorded-columns a=,b --motion recorded", "'a=,b' is given; columns such as time,elbow=q3"),
    ],
)  # fmt: skip
def test_the_command_line_names_options_as_it_writes_them(text, told):
    with pytest.raises((click.ClickException, BadInput)) as caught:
        on_the_command_line(text)
    assert told in str(caught.value)


def test_numbers_and_switches_of_numpy_are_taken():
    asked = CheckOptions(fail=np.float64(0.005), certify=np.bool_(False))
    assert (asked.fail, asked.certify) == (0.005, False) and type(asked.certify) is bool


@pytest.fixture
def case(tmp_path):
    """Two gates, 3 mm and 100 mm away; its limits are 5 and 20 mm."""
    return load_gates(tmp_path, {"gate_a": (-0.5, 0.003), "gate_b": (0.5, 0.1)})


def test_each_change_of_a_case_is_applied(case):
    asked = CheckOptions(
        fail=0.001, warn=0.002, accept="units", waivers=[WAIVER], tolerance={"base": {"xyz": 0.001}},
        unproven_ok=True,
    )  # fmt: skip
    found = asked.apply(replace(case, accept=("axis", "units")))
    assert (found.limits.fail, found.limits.warn) == (0.001, 0.002)
    assert found.accept == ("axis", "units") and found.waivers == (*case.waivers, WAIVER)
    assert found.tolerance is not None and found.tolerance.unproven_ok
    again = CheckOptions(limits=cl.Limits(0.01, 0.02), warn=0.03).apply(case)
    assert (again.limits.fail, again.limits.warn) == (0.01, 0.03)


def test_what_a_case_cannot_have_is_refused(case):
    with pytest.raises(BadInput, match="unproven_ok: the case has no tolerances"):
        CheckOptions(unproven_ok=True).apply(case)
    with pytest.raises(BadDimension, match="warn limit 1 mm is below the fail limit 5 mm; warn at"):
        CheckOptions(warn=0.001).apply(case)


@pytest.mark.parametrize("name", ["need", "certify", "certify_gap", "method", "motion"])
def test_rows_of_another_question_are_not_taken_up(case, name):
    assert Question(case).of_rows != Question(case, **{name: EVERY[name][0]}).of_rows


def test_a_question_is_made_in_one_hop(case):
    asked = CheckOptions(need="limit", fail=0.001, today=date(2026, 11, 1), waivers=[WAIVER])
    question = Question.of(case, asked)
    assert (question.need, question.today) == ("limit", date(2026, 11, 1))
    assert question.case.limits.fail == 0.001 and Question.of(case, CheckOptions()).today is None
    paper = Question(case, method="paper", certify_gap=0.01)
    assert not paper.certify and replace(paper, contact="none").method == "paper"


def test_a_field_is_all_that_a_new_option_takes():
    """What `option` declares is on the command line, is checked, and has its help and its default."""

    @dataclass(frozen=True)
    class List:
        reach: float = option(0.5, LENGTH, "Reach to look at.")
        quick: bool = option(False, SWITCH, "Look once.", needs=("reach", 1.0))

        def __post_init__(self) -> None:
            check_values(self)

    @click.command()
    @asked_options(List)
    def look(**given):
        return made(List, said(List, given), spelled_by(List))

    with look.make_context("look", ["--reach-mm", "1000", "--quick"]) as context:
        assert look.invoke(context) == List(reach=1.0, quick=True)
        assert "Reach to look at.  [default: 500]" in context.get_help()
    with pytest.raises(BadInput, match=r"quick says nothing without reach=1\.0"):
        List(quick=True)
