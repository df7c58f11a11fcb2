"""The page as text: complete, self-contained, and nothing in a name can break out of it."""

from __future__ import annotations

import dataclasses
import json
import re

import numpy as np
import pytest

from clearance.record.every_pair import EveryPair
from clearance.report import pair_curves as room
from clearance.report.page import _bands, page_of
from clearance.report.pair_curves import pair_curves
from clearance.report.sections import MAX_EVENT_ROWS, events
from clearance.world.case import SignOff
from tests.report.made import replay_of, run_of, summary_of
from tests.report.records import disagreeing, record


@pytest.fixture(scope="module")
def page() -> str:
    run = record(cross_check=disagreeing())
    return page_of(summary_of(run), replay_of(run))


def own_text(page: str) -> str:
    """The page without its scripts."""
    return re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


def test_names_are_escaped(page):
    text = own_text(page)
    assert "<b>gripper" not in text
    assert "&lt;b&gt;gripper&lt;/b&gt;.stl" in text
    assert "swing &amp; &lt;dip&gt;" in text
    assert page.count("<script") - page.count("\\u003cscript") >= 5
    data = re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)
    assert "wall </script>" in {body["name"] for body in json.loads(data[1])["bodies"]}


def test_nothing_is_fetched(page):
    assert not re.search(r"<(?:script|img|link|iframe)[^>]+(?:src|href)=[\"'](?!data:|#)", page)
    assert not re.search(
        r"@import|url\((?!data:)", re.search(r"<style>(.*?)</style>", page, re.DOTALL)[1]
    )


def test_every_part_of_the_page_is_there(page):
    text = own_text(page)
    for title in (
        "Contact, looked at the samples only", "Self-collision not checked",
        "Clearance over time", "Replay", "Worst moment", "Events", "How sure",
        "Least clearance of every pair, mm", "Not measured", "What was loaded",
        "Where this comes from",
    ):  # fmt: skip
        assert title in text, title
    assert "disagrees with python-fcl" in text
    assert "124.9" in text, "both answers of a step that differs"
    assert "facets of a pair stand up to 0.1 mm outside" in text


def test_the_matrix_leads_to_the_step_of_each_pair(page):
    cells = re.findall(
        r'<td class="cell (\w+)" data-step="(\d+)"[^>]*title="([^:]+):', own_text(page)
    )
    run = record()
    assert {(name, int(step)) for _, step, name in cells} == {
        (f"{p.link} - {p.obstacle}".replace("<", "&lt;").replace(">", "&gt;"), p.step)
        for p in run_of(run).pair_minima
    }
    assert [shade for shade, *_ in cells].count("contact") == 1


def test_a_long_list_of_events_is_cut_and_says_so():
    summary = summary_of(record())
    summary["events"] = summary["events"][:1] * (MAX_EVENT_ROWS + 7)
    summary["not_listed"]["events"] = 3
    html = events(summary)
    assert html.count("data-step") == MAX_EVENT_ROWS
    assert "7 more events in summary.json" in html
    assert "3 more events follow from the status in steps.csv" in html
    assert "&lt;" not in html, "markup shown as text"


@pytest.mark.slow
def test_a_long_run_is_thinned_and_says_so():
    run = record(n_steps=900)
    replay = replay_of(run, max_frames=200)
    assert "Drawn are" in page_of(summary_of(run), replay)
    assert "Drawn are" not in page_of(summary_of(run), replay_of(run))


def test_bands_that_no_screen_can_tell_apart_are_one():
    spans = [(0.0, 1.0), (1.5, 2.0), (2.01, 3.0), (3.05, 3.1), (9.0, 9.0)]
    found = [{"start": start, "end": end} for start, end in spans]
    assert _bands(found, 0.1) == [[0.0, 1.0], [1.5, 3.1], [9.0, 9.0]]
    assert _bands(found, 0.0) == [list(span) for span in spans]
    assert _bands([], 0.1) == []


def test_author_and_revision_stand_in_the_header_with_fields_to_sign():
    run = record()
    signed = dataclasses.replace(
        run, case=dataclasses.replace(run.case, sign_off=SignOff("J. <Doe>", "B"))
    )
    text = own_text(page_of(summary_of(signed), replay_of(signed)))
    assert text.count("J. &lt;Doe&gt;") == 2 and "Revision B" in text
    for role in ("Author", "Checked", "Approved", "Signature"):
        assert role in text
    assert "Sign-off" not in own_text(page_of(summary_of(run), replay_of(run)))


def test_pairs_without_a_curve_of_their_own_have_their_line():
    run = record()
    page = page_of(summary_of(run), replay_of(run))
    data = json.loads(
        re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)[1]
    )
    assert data["curves"] is None and len(data["pairs"]) == len(run_of(run).pair_minima)
    names = [[data["bodies"][i]["name"] for i in pair["bodies"]] for pair in data["pairs"]]
    assert names == [[one.link, one.obstacle] for one in run_of(run).pair_minima]


def test_curves_are_never_above_the_clearance_and_few_where_there_are_many_pairs(monkeypatch):
    clearance = np.random.default_rng(0).uniform(0.0, 1.0, (240, 9))
    run = record()
    pairs = [(one.link, one.obstacle) for one in run_of(run).pair_minima][::-1]
    every = EveryPair([a for a, _ in pairs], [b for _, b in pairs], clearance)
    whole = pair_curves(dataclasses.replace(run, every_pair=every), run_of(run).pair_minima)
    assert whole.clearances.shape == (9, 240) and (whole.times == run.motions[0].times).all()
    assert (whole.clearances[::-1].T <= clearance).all()
    assert np.abs(whole.clearances[::-1].T - clearance).max() < 1e-7
    monkeypatch.setattr(room, "MOST_NUMBERS", 9 * 20)
    few = pair_curves(dataclasses.replace(run, every_pair=every), run_of(run).pair_minima)
    assert few.clearances.shape == (9, 20) and few.times.shape == (20,)
    assert np.abs(few.clearances[::-1].min(axis=1) - clearance.min(axis=0)).max() < 1e-7
