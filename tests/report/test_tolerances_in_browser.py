"""The page of a case with tolerances in a real browser: the band below the curve, the bar, room on a phone."""

from __future__ import annotations

import pytest

from clearance.world.case import Limits
from tests.findings.test_verdict import made
from tests.report.browser import chromium, executable
from tests.report.budgets import with_budget
from tests.report.made import write

pytestmark = [
    pytest.mark.skipif(executable() is None, reason="no Chromium is installed"),
    pytest.mark.browser,
    pytest.mark.slow,
]

NAMES = "window.clearance.chart.told.curves.flatMap((one) => one.name || [])"


@pytest.mark.parametrize("width", [420, 1400])
def test_the_band_and_the_bar(tmp_path, width):
    write(with_budget(made(Limits(warn=0.02)), 0.0025), tmp_path / "out")
    with chromium() as page:
        page.open((tmp_path / "out" / "report.html").as_uri(), "window.clearance", width=width)
        page.settle()
        assert page.errors == [] and page.run("document.documentElement.scrollWidth") == width
        for _ in range(2):  # as drawn, and as drawn again
            names = page.run(NAMES)
            assert names == ["proven with tolerances", "expected, an estimate"]
            assert page.run("document.querySelectorAll('.chart .filled').length") == 1
            assert page.run("window.clearance.chart.range[0]") < -2.0
            page.run("document.getElementById('zoom-limits').click()")
            page.settle()
        assert page.box(".budget-bar")["width"] > 0.8 * min(width, 1240)
