"""Overlaps in the report: the same figures in summary, page, replay and picture."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from clearance.record.record import Record
from clearance.record.wording import contact_text, least_cm3, volume_cm3
from clearance.report.topics.contact import sections
from clearance.simulate.replay import replay as replay_contact
from tests.report.browser import executable, opened
from tests.report.made import content_of, replay_of, summary_of
from tests.report.records import record, with_contacts


@functools.cache
def run() -> Record:
    """The swing, with what its overlaps are."""
    return with_contacts(record())


def test_contact_that_was_not_worked_out_is_said():
    summary = summary_of(record())
    assert summary["contact"] is None and summary["status_counts"]["contact"]
    (section,) = sections(content_of(record()))
    assert "were not computed" in section.blocks[0].content


def test_a_bound_is_worded_as_one():
    figures = {"penetration": 0.0123451, "penetration_at_least": 0.012, "exact": False}
    figures |= {"volume": 2e-6, "volume_at_least": 0.0, "volume_exact": False}
    assert contact_text(figures) == "12.00 to 12.35 mm deep, at most 2.00 cm³ shared"
    assert contact_text(figures | {"exact": True}) == "12.35 mm deep, at most 2.00 cm³ shared"


@pytest.mark.parametrize("volume", [0.0, 1e-15, 1.23456e-6, 9.999e-7, 1.0])
def test_a_volume_lies_between_its_two_wordings(volume):
    more, less = 1 + 1e-11, 1 - 1e-11  # rounding noise does not count
    assert float(least_cm3(volume)) * less <= volume * 1e6 <= float(volume_cm3(volume)) * more


def test_too_many_contacts_are_thinned_but_never_the_deepest(monkeypatch):
    monkeypatch.setattr(replay_contact, "MOST_CONTACTS", 5)
    replay = replay_of(run())
    assert 2 <= len(replay.contacts) <= 5
    assert max(one.penetration for one in replay.contacts) == run().deepest.known.penetration


def red(pixels):
    r, g, b = np.moveaxis(pixels[..., :3].astype(int), -1, 0)
    return (r > 170) & (g < 90) & (b < 90)


LINES = """[...document.querySelectorAll('td')].filter((cell) => cell.textContent === 'gripper').map((cell) => {
  const range = document.createRange();
  range.selectNodeContents(cell);
  return new Set([...range.getClientRects()].map((part) => Math.round(part.top))).size; })"""
"""The number of lines that the name of a link has in each table of the page."""


@pytest.mark.browser
@pytest.mark.skipif(executable() is None, reason="no Chromium is installed")
def test_the_page_draws_the_region_in_red_and_the_way_out(tmp_path):
    with opened(run(), tmp_path) as page:
        page.run("document.getElementById('readout').style.display = 'none'")
        counts = {}
        for step in (0, run().deepest.step):
            page.run(f"window.clearance.showFrame({step})")
            page.run("document.getElementById('camera-gap').click()")
            page.settle()
            counts[step] = int(red(page.pixels("#pane")).sum())
        state = page.run("window.clearance.state()")
        page.open(page.report, "window.clearance", width=420)
        assert set(page.run(LINES)) == {1}
        assert page.errors == []
    assert counts[0] == 0 and counts[run().deepest.step] > 400
    here = [row.known for row in run().contacts if row.step == run().deepest.step]
    assert len(state["contacts"]) == len(here)
    for drawn, found in zip(state["contacts"], here, strict=True):
        assert drawn["foot"] == pytest.approx(found.centroid, abs=1e-6)
        assert drawn["direction"] == pytest.approx(found.direction, abs=1e-6)
        assert drawn["corners"] == len(found.region.vertices)
