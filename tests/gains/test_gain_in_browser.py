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
            assert page.run("document.querySelectorAll('svg polyline').length") == 2
        assert "kept, changed by 20.00 mm" in page.run(
            "document.querySelector('.verdict').textContent"
        )
        links = page.run("[...document.querySelectorAll('a')].map(a => a.href)")
        assert len(links) == 2
        for link in links:
            page.open(link, "window.clearance", 1400)
            assert "What this clearance changes by" in page.run("document.body.textContent")
        assert not page.errors and all(url.startswith(("file:", "data:")) for url in page.requests)
