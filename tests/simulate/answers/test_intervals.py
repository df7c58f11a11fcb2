"""Intervals and events on a run of statuses written down by hand."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.record.table import Names
from clearance.simulate.answers import intervals as room
from clearance.simulate.answers.intervals import events, extent, intervals, not_listed
from tests.report.made import run_of as made_run
from tests.report.records import record, with_steps

GAPS = [0.03, 0.018, 0.004, 0.0, 0.0, 0.003, 0.012, 0.05, 0.015]
LETTERS = "c n v x x v n c n"


def session_of(letters: str, gaps: list[float]):
    made = record(n_steps=len(gaps))
    codes = np.array(["cnvx".index(letter) for letter in letters.split()])
    status = Names(codes, ["clear", "near", "violated", "contact"])
    steps = made.rows.with_columns({"clearance": np.array(gaps), "status": status})
    return made_run(with_steps(made, steps)).session


def test_intervals_by_hand():
    run = session_of(LETTERS, GAPS)
    found = intervals(run)
    spans = {
        level: [(i.first_step, i.last_step, i.worst_step) for i in some]
        for level, some in found.items()
    }
    assert spans == {
        "below_warn": [(1, 6, 3), (8, 8, 8)],
        "below_fail": [(2, 5, 3)],
        "contact": [(3, 4, 3)],
    }
    (below,), times = found["below_fail"], run.record.steps["time"].to_pylist()
    assert (below.start, below.end, below.clearance) == (times[2], times[5], 0.0)


WARN, FAIL, TOUCH = (
    ("warn limit entered", "warn limit left"),
    ("fail limit entered", "fail limit left"),
    ("contact begins", "contact ends"),
)


@pytest.mark.parametrize(
    ("letters", "gaps", "expected"),
    [
        (LETTERS, GAPS, [(1, WARN[0]), (2, FAIL[0]), (3, TOUCH[0]), (5, TOUCH[1]), (6, FAIL[1]), (7, WARN[1]),
                         (8, WARN[0])]),
        ("c x c", [0.1, 0.0, 0.1], [(1, WARN[0]), (1, FAIL[0]), (1, TOUCH[0]), (2, TOUCH[1]), (2, FAIL[1]),
                                    (2, WARN[1])]),
    ],
    ids=["one by one", "all levels at once"],
)  # fmt: skip
def test_events_enter_the_widest_level_first_and_leave_the_deepest_first(letters, gaps, expected):
    found = [(event.step, event.what) for event in events(session_of(letters, gaps))]
    assert found == expected


def test_events_tell_the_least_until_the_level_is_left():
    told = {(event.step, event.what): event.least for event in events(session_of(LETTERS, GAPS))}
    assert told[1, "warn limit entered"] == told[2, "fail limit entered"] == 0.0
    assert told[8, "warn limit entered"] == 0.015
    assert told[7, "warn limit left"] is None


def test_a_run_that_never_rests_lists_its_first_intervals_and_says_how_many_more(monkeypatch):
    whole = session_of(LETTERS, GAPS)
    all_events, all_intervals = events(whole), intervals(whole)
    assert set(not_listed(whole).values()) == {0}
    monkeypatch.setattr(room, "MOST_LISTED", 1)
    assert events(whole) == all_events[:1]
    assert intervals(whole) == {level: found[:1] for level, found in all_intervals.items()}
    assert not_listed(whole) == {"below_warn": 1, "below_fail": 0, "contact": 0, "events": 6}
    assert extent(whole, "below_warn") == (2, 7)
