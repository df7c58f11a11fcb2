"""Intervals and events on a run of statuses written down by hand."""

from __future__ import annotations

import numpy as np

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
    found = intervals(session_of(LETTERS, GAPS))
    spans = {
        level: [(i.first_step, i.last_step, i.worst_step) for i in some]
        for level, some in found.items()
    }
    assert spans == {
        "below_warn": [(1, 6, 3), (8, 8, 8)],
        "below_fail": [(2, 5, 3)],
        "contact": [(3, 4, 3)],
    }


def test_intervals_carry_times_and_the_least_clearance():
    run = session_of(LETTERS, GAPS)
    interval = intervals(run)["below_fail"][0]
    times = run.record.steps["time"].to_pylist()
    assert (interval.start, interval.end, interval.clearance) == (times[2], times[5], 0.0)


def test_events_by_hand():
    found = [(event.step, event.what) for event in events(session_of(LETTERS, GAPS))]
    assert found == [
        (1, "warn limit entered"),
        (2, "fail limit entered"),
        (3, "contact begins"),
        (5, "contact ends"),
        (6, "fail limit left"),
        (7, "warn limit left"),
        (8, "warn limit entered"),
    ]


def test_a_jump_through_all_levels_enters_the_widest_first_and_leaves_the_deepest_first():
    found = [(event.step, event.what) for event in events(session_of("c x c", [0.1, 0.0, 0.1]))]
    assert found == [
        (1, "warn limit entered"),
        (1, "fail limit entered"),
        (1, "contact begins"),
        (2, "contact ends"),
        (2, "fail limit left"),
        (2, "warn limit left"),
    ]


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
