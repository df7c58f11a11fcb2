"""The page of a gain in a headless browser: it fits narrow and wide, and leads to both replays."""

import pytest

import clearance as cl
from clearance.gains.folder import save_gain
from tests.gains.making_gain import SLOT, write_cell
from tests.report.browser import chromium, executable

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(executable() is None, reason="no Chromium; set CLEARANCE_CHROMIUM"),
]


def test_the_page_fits_and_leads_to_both_replays(tmp_path):
    out = save_gain(cl.gain(write_cell(tmp_path, SLOT), "waypoints"), tmp_path / "out")
    with chromium() as page:
        for width in (420, 1400):
            page.open(f"file://{out}/gain.html", "document.readyState === 'complete'", width)
            assert page.run("document.documentElement.scrollWidth") <= width
            assert page.run("document.querySelectorAll('svg g .curve').length") == 2
        assert "kept, 1 joint changed" in page.run("document.querySelector('.verdict').textContent")
        links = page.run("[...document.querySelectorAll('a')].map(a => a.href)")
        assert len(links) == 2
        for link in links:
            page.open(link, "window.clearance", 1400)
            assert "Change of this clearance with" in page.run("document.body.textContent")
        before = page.run("window.clearance.state()")
        assert before["earlier"]["tool"][1] == pytest.approx(
            before["bodies"]["tool"][1] + 0.02, abs=1e-6
        )
        page.run("document.getElementById('earlier-motion').click()")
        assert page.run("window.clearance.state().earlier") == {}
        page.run("window.clearance.showFrame(0)")
        assert page.run("window.clearance.state().earlier") == {}
        page.run("document.getElementById('earlier-motion').click()")
        start = page.run("window.clearance.state()")
        assert start["earlier"]["tool"] == pytest.approx(start["bodies"]["tool"], abs=1e-6)
        assert not page.errors and all(url.startswith(("file:", "data:")) for url in page.requests)


def test_a_page_of_what_cannot_be_does_not_speak_of_a_bound(tmp_path):
    cell = write_cell(tmp_path, SLOT)
    out = save_gain(cl.gain(cell, "waypoints", keep=[(0.9, 1.1)]), tmp_path / "out")
    text = (out / "gain.html").read_text()
    assert "Proven: no change of this kind is enough." in text
    assert "The bound is proven" not in text and "gained" not in text
