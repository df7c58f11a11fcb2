"""The table of findings and the page of two runs in a browser: nothing is cut off, and a row moves the replay."""

from __future__ import annotations

import dataclasses
from datetime import date
from pathlib import Path

import pytest

import clearance as cl
from clearance.findings.comparison import compared
from clearance.report.comparison import write_comparison
from clearance.run import Question, answer
from clearance.world.waiver import Waiver
from tests.findings.gates import load_gates
from tests.report.browser import chromium, executable

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(executable() is None, reason="no Chromium; set CLEARANCE_CHROMIUM"),
]
WIDTHS = (420, 1000, 2000)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    place = tmp_path_factory.mktemp("reports")
    before = cl.check(load_gates(place, {"gate_a": (-0.5, 0.003), "gate_<b>": (0.5, 0.004)}))
    before.save(place / "before")
    case = load_gates(place, {"gate_a": (-0.5, 0.0025), "gate_<b>": (0.5, 0.1), "c": (0.8, 0.001)})
    reason = "the gate gives way by more than what the robot takes of it, " * 5
    until = date(2027, 3, 31)
    waiver = Waiver(("box", "gate_a"), at_least=0.002, reason=reason, by="N. N.", until=until)
    case = dataclasses.replace(case, waivers=(waiver,))
    now = answer(Question(case, today=date(2026, 11, 1)))
    comparison = compared(before.finding_list, now.finding_list)
    now.save(place / "now", comparison)
    write_comparison(comparison, place / "before", place / "now", place / "both")
    return place


def test_both_pages_fit_every_width_and_a_finding_moves_the_replay(folder):
    with chromium() as page:
        for width in WIDTHS:
            page.open(
                f"file://{folder}/both/comparison.html", "document.readyState === 'complete'", width
            )
            assert page.run("document.documentElement.scrollWidth") <= width
            assert page.run("document.querySelectorAll('svg .curve').length") == 2
            assert page.run("document.querySelectorAll('.findings tbody tr').length") == 3
        assert not page.errors and all(url.startswith(("file:", "data:")) for url in page.requests)
        for width in WIDTHS:
            page.open(f"file://{folder}/now/report.html", "window.clearance", width)
            assert page.run("document.documentElement.scrollWidth") <= width
        told = page.run("document.querySelector('table.findings').textContent")
        assert "not comparable" in told and "worse, was 3.000 mm" in told and "N. N." in told
        assert "gate_<b>" in page.run("document.body.textContent")
        row = "[...document.querySelectorAll('table.findings tbody tr')][1]"
        page.run(f"{row}.click()")
        step = page.run(f"Number({row}.dataset.step)")
        assert f"step {step}" in page.run("document.getElementById('readout').textContent")
        assert not page.errors
