"""The page as text: complete, self-contained, and nothing in a name can break out of it."""

from __future__ import annotations

import dataclasses
import json
import re
from xml.etree import ElementTree

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as some

from clearance.record.every_pair import EveryPair
from clearance.report import curves
from clearance.report.blocks import At, Cell, Inline, Row, Section, Table
from clearance.report.curves import pair_curves
from clearance.report.page import _bands
from clearance.report.rendering import render
from clearance.report.topics.events import MOST_ROWS, sections
from clearance.world.case import SignOff
from tests.report.made import content_of, page_of, replay_of, run_of, summary_of
from tests.report.records import disagreeing, record

# what XML cannot hold at all, and the line ends that its readers turn into others
TEXT = some.text(
    some.characters(exclude_categories=("Cc", "Cs"), exclude_characters="\ufffe\uffff")
)


@pytest.fixture(scope="module")
def page() -> str:
    return page_of(record(cross_check=disagreeing()))


def own_text(page: str) -> str:
    """The page without its scripts."""
    return re.sub(r"<script.*?</script>", "", page, flags=re.DOTALL)


def data_in(page: str) -> dict:
    """What its scripts draw."""
    data = re.search(r'<script id="data" type="application/json">(.*?)</script>', page, re.DOTALL)
    return json.loads(data[1])


@given(TEXT, TEXT)
def test_a_reader_finds_the_text_and_the_attribute_that_were_given(text, title):
    cells = [text, Cell([text, Inline(text, title=title)], "number"), Inline(text, at=At(3, 0.5))]
    table = Table((text, f">{text}"), [Row(cells, At(7))])
    read = ElementTree.fromstring(render("section.html", section=Section(text, [table])))
    assert [one.text or "" for one in read.iter("th")] == [text.removeprefix(">"), text]
    row = read.find(".//tbody/tr")
    assert row.get("data-step") == "7" and row.get("tabindex") == "0"
    first, second, third = row
    assert (first.text or "", second.text or "", second.get("class")) == (text, text, "number")
    assert (second[0].text or "", second[0].get("title") or "") == (text, title)
    assert dict(third[0].items()) == {"href": "#stage", "data-step": "3", "data-time": "0.5"}


def test_names_are_escaped(page):
    text = own_text(page)
    assert "<b>gripper" not in text
    assert "&lt;b&gt;gripper&lt;/b&gt;.stl" in text
    assert "swing &amp; &lt;dip&gt;" in text
    assert page.count("<script") - page.count("\\u003cscript") >= 5
    assert "wall </script>" in {body["name"] for body in data_in(page)["bodies"]}


def test_nothing_is_fetched(page):
    assert not re.search(r"<(?:script|img|link|iframe)[^>]+(?:src|href)=[\"'](?!data:|#)", page)
    assert not re.search(
        r"@import|url\((?!data:)", re.search(r"<style>(.*?)</style>", page, re.DOTALL)[1]
    )


def test_a_long_list_of_events_is_cut_and_says_so():
    events = summary_of(record())["events"][:1] * (MOST_ROWS + 7)
    content = content_of(record(), events=events, not_listed={"events": 3})
    (section,) = sections(content)
    table, *notes = section.blocks
    assert len(table.rows) == MOST_ROWS
    assert [note.content for note in notes] == [
        "7 more events in summary.json.",
        "3 more events follow from the status in steps.csv.",
    ]


@pytest.mark.parametrize(
    ("warn", "fail", "contact", "shown"),
    [
        (0.0, 0.0, "same", ["contact begins"]),
        (0.002, 0.002, "same", ["fail limit entered", "contact begins"]),
        (0.005, 0.002, "same", ["warn limit entered", "fail limit entered", "contact begins"]),
        (0.0, 0.0, "padded", ["fail limit entered", "contact begins"]),
    ],
)
def test_events_of_limits_that_nobody_gave_are_not_on_the_page(warn, fail, contact, shown):
    (event,) = summary_of(record())["events"][:1]
    what = ["warn limit entered", "fail limit entered", "contact begins"]
    content = content_of(
        record(),
        events=[{**event, "what": one} for one in what],
        limits={"warn": warn, "fail": fail},
        intervals={"below_warn": ["same"], "below_fail": ["same"], "contact": [contact]},
    )
    table = next(sections(content)).blocks[0]
    assert [row.cells[2] for row in table.rows] == shown


@pytest.mark.slow
def test_a_long_run_is_thinned_and_says_so():
    run = record(n_steps=900)
    assert "Drawn are" in page_of(run, replay_of(run, max_frames=200))
    assert "Drawn are" not in page_of(run)


def test_bands_that_no_screen_can_tell_apart_are_one():
    spans = [(0.0, 1.0), (1.5, 2.0), (2.01, 3.0), (3.05, 3.1), (9.0, 9.0)]
    found = [{"start": start, "end": end} for start, end in spans]
    assert _bands(found, 0.1) == [[0.0, 1.0], [1.5, 3.1], [9.0, 9.0]]
    assert _bands(found, 0.0) == [list(span) for span in spans]
    assert _bands([], 0.1) == []


def test_author_and_revision_stand_in_the_header_with_fields_to_sign():
    run = record()
    case = dataclasses.replace(run.case, sign_off=SignOff("J. <Doe>", "B"))
    text = own_text(page_of(dataclasses.replace(run, case=case)))
    assert text.count("J. &lt;Doe&gt;") == 2 and "Revision B" in text
    for role in ("Author", "Checked", "Approved", "Signature"):
        assert role in text


def test_curves_are_never_above_the_clearance_and_few_where_there_are_many_pairs(monkeypatch):
    clearance = np.random.default_rng(0).uniform(0.0, 1.0, (240, 9))
    run = record()
    pairs = [(one.link, one.obstacle) for one in run_of(run).pair_minima][::-1]
    every = EveryPair([a for a, _ in pairs], [b for _, b in pairs], clearance)
    measured = dataclasses.replace(run, every_pair=every)
    whole = pair_curves(measured, run_of(run).pair_minima)
    assert whole.clearances.shape == (9, 240) and (whole.times == run.motions[0].times).all()
    assert (whole.clearances[::-1].T <= clearance).all()
    assert np.abs(whole.clearances[::-1].T - clearance).max() < 1e-7
    monkeypatch.setattr(curves, "MOST_NUMBERS", 9 * 20)
    few = pair_curves(measured, run_of(run).pair_minima)
    assert few.clearances.shape == (9, 20) and few.times.shape == (20,)
    assert np.abs(few.clearances[::-1].min(axis=1) - clearance.min(axis=0)).max() < 1e-7
