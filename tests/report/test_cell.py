"""A cell of several actors and rules: every answer names the rule that judges, and what moves by which hand."""

from __future__ import annotations

import dataclasses
import json
import re

import pyarrow.csv
import pyarrow.parquet
import pytest

import clearance as cl
from clearance.report.summary import json_text
from clearance.report.topics.pairs import PairJudge
from clearance.world.case import Clock
from clearance.world.placed_robot import SelfClearance
from clearance.world.rules import Allowance
from clearance.world.timing import Window
from tests.made_cases import at
from tests.report.cells import box, cell, sliding
from tests.report.made import page_of, printed, replay_of, write_junit


@pytest.fixture(scope="module")
def run():
    return cl.check(cell(), need="pairs")


@pytest.fixture(scope="module")
def summary(run):
    return json.loads(json_text(run.summary))


def test_one_robot_among_what_stands_keeps_its_names_first_and_has_the_others_too(tmp_path):
    robots = (sliding("left", [(0, 0), (1, 1)]),)
    obstacles = (box("post", (0.2, 0.2, 2)),)
    run = cl.check(cell((), robots, obstacles, ()), need="pairs")
    run.save(tmp_path / "out")
    old = "link obstacle link_x link_y link_z obstacle_x obstacle_y obstacle_z".split()
    new = "body_a body_b a_x a_y a_z b_x b_y b_z".split()
    steps = pyarrow.csv.read_csv(tmp_path / "out" / "steps.csv")
    assert steps.column_names[:11] == ["step", "time", "clearance", *old]
    assert [steps[name] for name in old] == [steps[name] for name in new]
    pairs = pyarrow.parquet.read_table(tmp_path / "out" / "pairs.parquet")
    assert pairs.column_names[:4] == ["step", "link", "obstacle", "clearance"]
    contacts = pyarrow.csv.read_csv(tmp_path / "out" / "contacts.csv")
    assert contacts.column_names[:4] == ["step", "time", "link", "obstacle"]
    assert len(contacts) and contacts["link"] == contacts["body_a"]


def test_padding_alone_is_no_contact_anywhere(tmp_path):
    """The bodies are 1 mm apart and padded by 3 mm: violated by 2 mm, in contact nowhere."""
    robots = (sliding("left", [(0, 0), (1, 0)], padding={"tool": 0.003}),)
    obstacles = (box("post", (0.1, 0.1, 1), at(0.101, z=0.5)),)
    run = cl.check(cell((), robots, obstacles, ()))
    assert run.status == "violated" and run.worst["clearance"] == pytest.approx(-0.002)
    (minimum,) = run.pair_minima
    assert PairJudge.of(run.record).status_of(minimum) == "violated"
    assert run.summary["status_counts"]["contact"] == 0
    replay = replay_of(run.session)
    assert set(replay.status.tolist()) == {2}
    text = re.sub(r"<script.*?</script>", "", page_of(run, replay), flags=re.DOTALL)
    assert 'class="cell violated"' in text and 'class="cell contact"' not in text
    assert "-2.000 mm" in run.verdict.reasons[0].replace("-2.001", "-2.000")


def test_self_collision_is_said_robot_by_robot():
    robots = (
        sliding("left", [(0, 0), (1, 1)], self_clearance=SelfClearance()),
        sliding("right", [(0, 3), (1, 3)]),
    )
    run = cl.check(cell((), robots, (box("table", (4, 4, 0.1)),), ()))
    assert run.verdict.not_checked == ("self-collision of right",)
    assert "self-collision of right not checked" in "\n".join(printed(run))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("slack", "told"), [(float("inf"), "clocks not tied"), (0.25, "clocks up to 0.25 s apart")]
)
def test_the_verdict_says_how_far_clocks_may_be_apart_and_both_times(slack, told):
    """The times are written into the record by hand: what is said of them is asked here."""
    found = cl.check(cell((), carries=()))
    worst = dataclasses.replace(found.record.worst, time_b=2.5)
    case = dataclasses.replace(found.record.case, clock=Clock(slack))
    record = dataclasses.replace(found.record, case=case, worst=worst, worst_sample=worst)
    session = dataclasses.replace(found.session, record=record)
    run = dataclasses.replace(found, record=record, session=session)
    assert run.verdict.headline().endswith(told)
    summary = run.summary
    assert summary["clocks"] == told and summary["worst"]["time_b"] == 2.5
    text = "\n".join(printed(run))
    assert f"with {worst.obstacle} at 2.500 s" in text and told.upper() not in text
    html = page_of(run)
    assert f"with {worst.obstacle} at 2.500 s" in html and told in html


@pytest.mark.parametrize("certify", [True, False])
def test_while_nothing_is_measured_the_report_says_so_and_stands(certify, tmp_path):
    robots = (
        sliding("left", [(0, 0), (1, 0.1), (2, 0.2), (3, 0.3)]),
        sliding("right", [(0, 3), (3, 3)]),
    )
    allow = (Allowance(("*", "*"), Window(1.0, 2.5)),)
    obstacles = (box("post", (0.1, 0.1, 2), at(0.6)),)
    run = cl.check(cell((), robots, obstacles, (), allow=allow), certify=certify)
    assert any("nothing is measured from 1.000 s to 2.500 s" in one for one in run.verdict.warnings)
    replay = replay_of(run.session)
    assert replay.steps[replay.known == 0].tolist() == [2]
    assert replay.nearest[replay.known == 0].tolist() == [[-1, -1]]
    assert (
        "Infinity" not in page_of(run, replay).partition('<script id="data"')[2].partition("</s")[0]
    )
    write_junit(run, tmp_path / "junit.xml")
    assert printed(run)
