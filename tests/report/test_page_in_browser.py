"""The page in a real browser: it draws, it says what the table says, and a click moves the
robot."""

from __future__ import annotations

import numpy as np
import pytest

from clearance.report import write
from clearance.report.wording import mm
from clearance.world.case import Limits
from tests.report.browser import Page, chromium, executable
from tests.report.records import record

pytestmark = pytest.mark.skipif(executable() is None, reason="no Chromium is installed")

RUN = record(limits=Limits(fail=0.01, warn=0.06))


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Page:
    folder = tmp_path_factory.mktemp("report") / "out"
    write(RUN, folder)
    with chromium() as page:
        page.open((folder / "report.html").as_uri(), "window.clearance")
        page.settle()
        yield page


def row(step: int) -> dict:
    return RUN.steps.slice(step, 1).to_pylist()[0]


def show(page: Page, step: int) -> dict:
    page.run(f"window.clearance.showFrame(window.clearance.frameOfStep({step}))")
    page.settle()
    return page.run("window.clearance.state()")


def links_drawn(state: dict) -> np.ndarray:
    return np.array([state["bodies"][body.name] for body in RUN.case.robots[0].robot.bodies])


def test_it_opens_at_the_worst_step_without_an_error_and_fetches_nothing(page):
    assert page.run("window.clearance.state().step") == RUN.worst_step
    assert page.errors == []
    foreign = [url[:80] for url in page.requests if not url.startswith(("file:", "data:", "blob:"))]
    assert foreign == []


def test_the_replay_is_drawn_and_changes_with_the_step(page):
    show(page, 0)
    first = page.pixels("#pane").astype(int)
    show(page, 200)
    later = page.pixels("#pane").astype(int)
    assert first.std() > 10, "a blank canvas has one colour"
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 200
    assert (np.abs(first - later).max(axis=2) > 30).sum() > 500


@pytest.mark.parametrize("step", [0, 1, 44, 130, 239])
def test_the_line_is_where_the_table_says(page, step):
    state, expected = show(page, step), row(step)
    ends = np.array(
        [[expected[f"{body}_{axis}"] for axis in "xyz"] for body in ("link", "obstacle")]
    )
    assert state["step"] == step
    assert np.abs(np.array(state["dots"]) - ends).max() < 1e-9
    assert np.abs(np.array(state["line"]) - ends).max() < 1e-9
    length = np.linalg.norm(np.subtract(*state["line"]))
    assert length == pytest.approx(expected["clearance"], abs=1e-9)


@pytest.mark.parametrize("step", [0, 100, 239])
def test_the_links_are_where_kinematics_puts_them(page, step):
    expected = RUN.motions[0].poses(step, step + 1)[0, :, :3, 3]
    assert np.abs(links_drawn(show(page, step)) - expected).max() < 1e-6


def test_the_line_has_the_colour_of_its_status_and_none_is_drawn_in_contact(page):
    colours = {show(page, RUN.steps["status"].to_pylist().index(s))["colour"] for s in
               ("clear", "near", "violated", "contact")}  # fmt: skip
    assert len(colours) == 4
    assert show(page, RUN.worst_step)["line"] is None


def curve_point(page: Page, step: int) -> tuple[float, float]:
    """Where on the window the curve stands at a step."""
    page.run("window.scrollTo(0, 0)")
    axis = page.run(
        "(() => { const {xaxis, _size} = document.getElementById('curve')._fullLayout;"
        f"return {{x: _size.l + xaxis.d2p({row(step)['time']}), y: _size.t + 60}}; }})()"
    )
    box = page.box("#curve")
    return box["x"] + axis["x"], box["y"] + axis["y"]


@pytest.mark.parametrize("step", [60, 180])
def test_a_click_on_the_curve_moves_the_robot_to_that_step(page, step):
    before = links_drawn(show(page, 5))
    page.click(*curve_point(page, step))
    page.wait(f"window.clearance.state().step === {step}")
    after = links_drawn(page.run("window.clearance.state()"))
    assert np.abs(after - before).max() > 0.05
    expected = RUN.motions[0].poses(step, step + 1)[0, :, :3, 3]
    assert np.abs(after - expected).max() < 1e-6


def test_hovering_over_the_curve_names_step_clearance_link_and_obstacle(page):
    x, y = curve_point(page, 120)
    page.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
    page.wait("document.querySelector('#curve .hoverlayer').textContent.includes('step 120')")
    text = page.run("document.querySelector('#curve .hoverlayer').textContent")
    for part in (mm(row(120)["clearance"]) + " mm", row(120)["link"], row(120)["obstacle"]):
        assert part in text


@pytest.mark.parametrize("selector", [".cell", "tr[data-step]", "a[data-step]"])
def test_a_click_in_a_table_moves_the_replay(page, selector):
    show(page, 3)
    wanted = page.run(
        f"(() => {{ const one = Array.from(document.querySelectorAll({selector!r})).at(-1);"
        "one.click(); return Number(one.dataset.step); })()"
    )
    assert page.run("window.clearance.state().step") == wanted


def test_play_runs_on_the_clock_of_the_trajectory_and_pause_stops_it(page):
    show(page, 0)
    page.run("document.getElementById('play').click()")
    page.wait("window.clearance.state().step > 10")
    page.run("document.getElementById('play').click()")
    step = page.run("window.clearance.state().step")
    page.settle()
    assert page.run("window.clearance.state().step") == step


def test_the_slider_scrubs_and_the_button_jumps_to_the_worst_step(page):
    page.run("(() => { const s = document.getElementById('scrub'); s.value = 77;"
             "s.dispatchEvent(new Event('input')); })()")  # fmt: skip
    assert page.run("window.clearance.state().step") == 77
    page.run("document.getElementById('worst-step').click()")
    assert page.run("window.clearance.state().step") == RUN.worst_step


def test_it_prints_with_a_still_of_the_worst_moment(page):
    page.wait("document.getElementById('replay-still').src.startsWith('data:image/png')")
    page.wait("document.getElementById('curve-still').src.startsWith('data:image/svg')")
    assert page.pdf().startswith(b"%PDF")
    page.call("Emulation.setEmulatedMedia", media="print")
    try:
        assert page.run("getComputedStyle(document.getElementById('transport')).display") == "none"
        assert page.box("#replay-still")["height"] > 150
        assert page.box("#curve-still")["height"] > 150
    finally:
        page.call("Emulation.setEmulatedMedia", media="")


def test_no_error_came_up_in_all_this(page):
    assert page.errors == []


def test_a_page_without_webgl_says_so_and_keeps_its_tables(tmp_path):
    write(record(n_steps=2), tmp_path / "out")
    with chromium() as page:
        page.call("Page.addScriptToEvaluateOnNewDocument",
                  source="HTMLCanvasElement.prototype.getContext = () => null;")  # fmt: skip
        page.open((tmp_path / "out" / "report.html").as_uri(), "window.clearance")
        assert "cannot draw in 3-D" in page.run("document.getElementById('pane').textContent")
        assert page.run("window.clearance.state().step") == 0
        assert page.run("document.querySelectorAll('.cell').length") == 9
