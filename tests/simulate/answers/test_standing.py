"""Pairs that touch all the time because their link never moves come as one hint with the line to paste."""

from dataclasses import replace

import numpy as np
import pytest

from clearance import check, load_case
from clearance.report.topics.certainty import notes_of
from clearance.simulate.answers.standing import standing_contacts, standing_hint
from tests.formats.making import CASE, write_case

TABLES = CASE.replace(
    "trajectory:",
    "  - {name: table, pose: {xyz: [0, 0, -0.15]}, box: {size: [1, 1, 0.1]}}\n"
    "  - {name: 'plate, 2', pose: {xyz: [0, 0, -0.05]}, box: {size: [0.1, 0.1, 0.1]}}\n"
    "  - {name: collar, pose: {xyz: [0, 0, 0.6]}, box: {size: [0.1, 0.1, 0.1]}}\ntrajectory:",
)
"""The arm's base stands on a table and in a plate; the collar is inside its upper link, which turns."""


@pytest.fixture
def run(tmp_path):
    return check(load_case(write_case(tmp_path, TABLES)), need="pairs")


def test_only_links_that_never_move_are_named(run):
    assert sorted(standing_contacts(run.record)) == [("base", "plate, 2"), ("base", "table")]


def test_the_hint_holds_the_line_to_paste_and_the_line_leaves_them_out(run, tmp_path):
    (hint,) = standing_hint(run.record)
    assert hint.startswith("2 pairs touch all the time, since the link never moves")
    assert notes_of(run.record, run.session.hints).count(hint) == 1
    line = hint.partition("case: ")[2]
    again = check(load_case(write_case(tmp_path, TABLES + line + "\n")))
    assert standing_hint(again.record) == []
    assert len(again.record.case.allow) == 2


def test_a_link_that_stands_because_its_joint_rests_is_standing_too(run):
    placed = run.record.case.robots[0]
    asked = replace(placed.trajectory, positions=np.zeros_like(placed.trajectory.positions))
    resting = replace(run.record.case, robots=(replace(placed, trajectory=asked),))
    found = standing_contacts(check(resting).record)
    assert ("upper", "collar") in found
