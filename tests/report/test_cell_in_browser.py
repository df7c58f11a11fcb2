"""The page of a cell in a real browser: all that moves is drawn where it is, hands and rules are said."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

import clearance as cl
from clearance.world.budget import Budget, ObstacleTolerance
from clearance.world.rules import Allowance
from clearance.world.timing import Window
from tests.made_cases import at
from tests.report.browser import Page, executable, opened, show
from tests.report.cells import box, cell, sliding, with_a_hole

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(executable() is None, reason="no Chromium is installed"),
]


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Page:
    with opened(cl.check(cell(), need="pairs"), tmp_path_factory.mktemp("cell")) as page:
        yield page


def readout(page: Page) -> str:
    return page.run("document.getElementById('readout').innerText")


def test_parts_go_with_the_hand_that_holds_them_and_the_page_says_so(page):
    held = {}
    for step in (0, 2, 3, 5):  # 0, 1.5, 2 and 3 s
        state = show(page, step)
        held[step] = readout(page)
        part = state["bodies"]["part"]
        by = "right/tool" if step >= 3 else "left/tool"
        if step >= 1:
            offset = np.subtract(part, state["bodies"][by])
            assert offset == pytest.approx([0.16 if by == "left/tool" else -0.0755, 0, 0], abs=1e-6)
    assert "holds" not in held[0]
    assert "left/tool holds part" in held[2]
    assert "right/tool holds part" in held[3] and "left/tool holds" not in held[3]
    assert page.errors == []


def test_what_is_not_in_the_cell_is_not_drawn(page):
    assert sorted(show(page, 0)["hidden"]) == ["cart", "crate"]
    assert show(page, 2)["hidden"] == []
    assert sorted(show(page, 6)["hidden"]) == ["cart", "crate"]


def test_the_readout_and_the_hover_name_the_rule(page):
    show(page, 0)
    assert "by rule fence" in readout(page)
    texts = page.run("window.clearance.chart.told.tip(0)")
    assert "by rule fence: fail 5 mm, warn 500 mm" in texts


def test_a_page_says_of_steps_at_which_nothing_is_measured_that_it_is_so(tmp_path):
    way = [(0, 0), (1, 0.1), (2, 0.2), (3, 0.3)]
    robots = (sliding("left", way), sliding("right", [(0, 3), (3, 3)]))
    allow = (Allowance(("*", "*"), Window(1.0, 2.5)),)
    case = cell((), robots, (box("post", (0.1, 0.1, 2), at(0.6)),), (), allow=allow)
    with opened(cl.check(case), tmp_path) as page:
        show(page, 2)
        assert "nothing measured" in readout(page) and "no pair is left" in readout(page)


def test_nothing_is_drawn_as_proven_with_tolerances_where_a_recording_is_not_measured(tmp_path):
    budget = Budget(obstacles={"post": ObstacleTolerance(surface=0.001)})
    with opened(cl.check(replace(with_a_hole(), tolerance=budget)), tmp_path) as page:
        lines = "[...document.querySelectorAll('path.filled, g > .curve.more')]"
        drawn = page.run(f"{lines}.map((one) => one.getAttribute('d').split('M').length - 1)")
        assert drawn == [2, 2, 2]


def test_the_curve_has_a_gap_where_a_recording_is_not_measured(tmp_path):
    case = with_a_hole()
    (hole,) = case.robots[0].trajectory.holes
    run = cl.check(case)
    bounds = run.steps.select(["lower_bound", "upper_bound"]).to_pylist()
    assert [row["lower_bound"] is None for row in bounds] == [i == 3 for i in range(7)]
    assert bounds[3] == {"lower_bound": None, "upper_bound": None}
    with opened(run, tmp_path) as page:
        assert "inf" not in (tmp_path / "out" / "steps.csv").read_text()
        drawn = page.run("document.querySelector('.curve.status.clear').getAttribute('d')")
        assert drawn.count("M") == 2
        assert run.steps["clearance"][3].as_py() == 0.29999999999999993
        assert "300.0" not in readout(page) and "299.9 mm" in readout(page)
        band = page.run("window.clearance.chart.told.bands.at(-1)")
        assert band == {"start": hole.start, "end": hole.end, "kind": "unmeasured"}
