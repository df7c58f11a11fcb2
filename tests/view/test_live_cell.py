"""The live viewer of a cell: parts go with hands, what is not there is hidden, buttons lead to each pick-up."""

from __future__ import annotations

import json

import pytest

import clearance as cl
from clearance.view import play
from tests.report.browser import Page, chromium, executable
from tests.report.cells import cell
from tests.view.test_live_viewer import WORLD, press

RUN = cell()


@pytest.fixture(scope="module")
def page() -> Page:
    if executable() is None:
        pytest.skip("no Chromium is installed")
    with play(cl.check(RUN).session.replay()) as playback, chromium() as page:
        page.open(playback.url, "window.viewer && Object.keys(viewer.gui_controllers).length >= 4")
        page.wait("viewer.animator.duration > 0")
        page.settle()
        yield page


def body(page: Page, name: str) -> dict:
    kinds = json.dumps(["links", "obstacles", "moving", "parts"])
    path = page.run(
        f"(() => {{ const top = viewer.scene_tree.find(['meshcat']).object;"
        f"for (const kind of {kinds}) for (const k of (top.getObjectByName(kind) || {{children: []}}).children)"
        f"if (k.name.endsWith(' {name}')) return [kind, k.name]; }})()"
    )
    return page.run(f"({WORLD})({json.dumps(['meshcat', *path])})")


def test_a_button_leads_to_each_pick_up_and_the_part_is_with_the_hand(page):
    press(page, "right/tool takes part")
    part, hand = body(page, "part"), body(page, "right tool")
    assert part["centre"] == pytest.approx([1.16, 0, 0.5], abs=1e-5)
    assert hand["centre"] == pytest.approx([1.2355, 0, 0.5], abs=1e-5)


def test_what_is_not_in_the_cell_is_hidden(page):
    page.run("void viewer.gui_controllers['step'].setValue(0)")
    page.settle()
    assert not body(page, "cart")["visible"] and not body(page, "crate")["visible"]
    press(page, "right/tool takes part")
    assert body(page, "cart")["visible"] and body(page, "door")["visible"]
