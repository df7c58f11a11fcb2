"""The page in a real browser: it draws, it says what the table says, and a click moves the robot."""

from __future__ import annotations

import dataclasses
from datetime import date
from pathlib import Path

import numpy as np
import pytest

import clearance as cl
from clearance.findings.comparison import compared
from clearance.report.comparison import write_comparison
from clearance.report.still import overview, still_of
from clearance.run import Question, answer
from clearance.world.body import Body, Obstacle
from clearance.world.case import Case, Limits
from clearance.world.rules import Waiver
from tests.findings.gates import load_gates
from tests.findings.test_verdict import made
from tests.made_cases import arm, at
from tests.profiles.moving import slab, sliding
from tests.report.browser import Page, chromium, executable, opened, show
from tests.report.made import replay_of, write
from tests.report.records import record, with_budget

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(executable() is None, reason="no Chromium is installed"),
]

RUN = record(limits=Limits(fail=0.01, warn=0.06))


@pytest.fixture(scope="module")
def page(tmp_path_factory) -> Page:
    with opened(RUN, tmp_path_factory.mktemp("report")) as page:
        yield page


def row(step: int) -> dict:
    return RUN.steps.slice(step, 1).to_pylist()[0]


def links_drawn(state: dict) -> np.ndarray:
    return np.array([state["bodies"][body.name] for body in RUN.case.robots[0].robot.bodies])


def test_it_opens_at_the_worst_step_as_the_picture_does_and_fetches_nothing(page):
    assert page.run("window.clearance.state().step") == RUN.worst_step
    assert page.errors == []
    foreign = [url[:80] for url in page.requests if not url.startswith(("file:", "data:", "blob:"))]
    assert foreign == []
    camera = overview(still_of(replay_of(RUN)))
    eye, target = np.array(page.run("window.clearance.state().camera"))
    assert np.abs(eye - camera.eye).max() < 1e-4
    forward = (target - eye) / np.linalg.norm(target - eye)
    assert np.abs(forward - camera.axes[2]).max() < 1e-5


def test_the_replay_is_drawn_and_changes_with_the_step(page):
    show(page, 0)
    first = page.pixels("#pane").astype(int)
    show(page, 200)
    later = page.pixels("#pane").astype(int)
    assert first.std() > 10, "a blank canvas has one colour"
    assert len(np.unique(first.reshape(-1, 3), axis=0)) > 200
    assert (np.abs(first - later).max(axis=2) > 30).sum() > 500


@pytest.mark.parametrize("step", [44, 239])
def test_line_and_links_are_where_table_and_kinematics_say(page, step):
    state, expected = show(page, step), row(step)
    ends = np.array(
        [[expected[f"{body}_{axis}"] for axis in "xyz"] for body in ("link", "obstacle")]
    )
    assert state["step"] == step
    assert np.abs(np.array([state["dots"], state["line"]]) - ends).max() < 1e-9
    length = np.linalg.norm(np.subtract(*state["line"]))
    assert length == pytest.approx(expected["clearance"], abs=1e-9)
    poses = RUN.motions[0].poses(step, step + 1)[0, :, :3, 3]
    assert np.abs(links_drawn(state) - poses).max() < 1e-6


def test_the_line_has_the_colour_of_its_status_and_none_is_drawn_in_contact(page):
    statuses = RUN.steps["status"].to_pylist()
    shown = [show(page, statuses.index(one)) for one in ("clear", "near", "violated", "contact")]
    assert len({one["colour"] for one in shown}) == 4 and shown[-1]["line"] is None


def curve_point(page: Page, step: int) -> tuple[float, float]:
    """Where on the window the curve stands at a step."""
    page.run("window.scrollTo(0, 0)")
    axis = page.run(
        "(() => { const {chart} = window.clearance;"
        f"return {{x: chart.x({row(step)['time']}), y: chart.room.top + 60}}; }})()"
    )
    box = page.box("#curve")
    return box["x"] + axis["x"], box["y"] + axis["y"]


def test_a_click_on_the_curve_moves_the_robot_to_that_step(page):
    before = links_drawn(show(page, 5))
    page.click(*curve_point(page, 180))
    page.wait("window.clearance.state().step === 180")
    assert np.abs(links_drawn(page.run("window.clearance.state()")) - before).max() > 0.05


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


def test_it_prints_with_a_still_of_the_worst_moment(page):
    page.wait("document.getElementById('replay-still').src.startsWith('data:image/png')")
    assert page.pdf().startswith(b"%PDF")
    page.call("Emulation.setEmulatedMedia", media="print")
    try:
        assert page.run("getComputedStyle(document.getElementById('transport')).display") == "none"
        assert page.box("#replay-still")["height"] > 150
        assert 150 < page.box("#curve svg")["height"] < 400
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


@pytest.fixture(scope="module")
def crowded(tmp_path_factory) -> Page:
    """43 links among 60 obstacles, every pair at every step, with a moment between two steps; and its run."""
    run = cl.check(hand_among_boxes(), need="pairs")
    with opened(run, tmp_path_factory.mktemp("crowded")) as page:
        page.run_of = run
        yield page


@pytest.mark.parametrize(("width", "theme"), [(420, "dark"), (1400, "light")])
def test_nothing_is_clipped_and_wide_tables_scroll_in_their_own_box(crowded, width, theme):
    page = crowded
    scheme = [{"name": "prefers-color-scheme", "value": theme}]
    page.call("Emulation.setEmulatedMedia", media="", features=scheme)
    page.open(page.report, "window.clearance", width=width, height=900)
    page.settle()
    assert page.run("document.documentElement.scrollWidth") <= width
    beyond = page.run(
        "Array.from(document.querySelectorAll('body *')).filter((e) => !e.closest('.scroll, #pane, #curve')"
        " && e.getBoundingClientRect().right > innerWidth + 1).map((e) => e.outerHTML.slice(0, 80))"
    )
    assert beyond == []
    box = page.run("(() => { const b = document.querySelector('.matrix').parentElement;"
                   "return [b.clientHeight, b.scrollHeight, b.clientWidth, b.scrollWidth]; })()")  # fmt: skip
    assert box[0] <= 900 and box[1] > box[0] and box[3] > box[2]
    paper = page.run("getComputedStyle(document.body).backgroundColor")
    light = sum(map(int, paper.strip("rgb()").split(","))) > 384
    assert light == (theme == "light")
    assert page.errors == []


def test_the_replay_opens_at_the_moment_between_two_steps_with_its_bodies_marked(crowded):
    page, worst = crowded, crowded.run_of.worst
    page.open(page.report, "window.clearance", width=1400, height=900)
    page.settle()
    assert worst["between"] and worst["clearance"] == 0.0
    state = page.run("window.clearance.state()")
    assert (state["step"], state["nearest"]) == (worst["step"], [worst["link"], worst["obstacle"]])
    text = page.run("document.getElementById('readout').textContent")
    assert f"between the steps {worst['step']} and {worst['step'] + 1}" in text
    assert "contact" in text and page.run("Math.min(...window.clearance.chart.told.main.y)") == 0.0
    page.run("window.clearance.showFrame(0)")
    page.run("Array.from(document.querySelectorAll('tr[data-time]')).at(-1).click()")
    assert page.run("window.clearance.state().nearest") == [worst["link"], worst["obstacle"]]


def hand_among_boxes() -> Case:
    """A chain of 43 boxes that turns a little; one box flies through an obstacle between steps 3 and 4."""
    places = [
        at(x=2.125),
        *(at(x=-1.0 - 0.2 * (i % 10), y=0.3 * (i // 10), z=0.2) for i in range(59)),
    ]
    obstacles = [(cl.box((0.05, 0.05, 0.05)), place) for place in places]
    positions = np.zeros((8, 43))
    positions[:, 0] = [-0.3, -0.25, -0.2, -0.15, 0.15, 0.2, 0.25, 0.3]
    return arm("hand", [cl.box((0.04, 0.03, 0.03))] * 43, obstacles, positions)


KEYS = "[...document.querySelectorAll('.chart .key')].map((one) => one.textContent)"
NAMES = "window.clearance.chart.told.curves.flatMap((one) => one.name || [])"


def test_the_band_and_the_bar(tmp_path):
    with opened(with_budget(made(Limits(warn=0.02)), 0.0025), tmp_path) as page:
        for width in (420, 1400):
            page.open(page.report, "window.clearance", width=width)
            page.settle()
            assert page.errors == [] and page.run("document.documentElement.scrollWidth") == width
            for _ in range(2):  # as drawn, and as drawn again
                names = page.run(NAMES)
                assert names == ["proven with tolerances, at the samples", "expected, an estimate"]
                assert page.run(KEYS) == names
                assert page.run("document.querySelector('.chart').scrollWidth") <= width
                assert page.run("document.querySelectorAll('.chart .filled').length") == 1
                assert page.run("window.clearance.chart.range[0]") < -2.0
                page.run("document.getElementById('zoom-limits').click()")
                page.settle()
            assert page.box(".budget-bar")["width"] > 0.8 * min(width, 1240)


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


WIDTHS = (420, 1400)


def test_both_pages_fit_every_width_and_a_finding_moves_the_replay(folder):
    with chromium() as page:
        comparison = f"file://{folder}/both/comparison.html"
        for width in WIDTHS:
            page.open(comparison, "document.readyState === 'complete'", width)
            assert page.run("document.documentElement.scrollWidth") <= width
            assert page.run("document.querySelectorAll('svg g .curve').length") == 2
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


def test_a_step_of_unknown_clearance_has_no_status_and_no_dots(tmp_path):
    """A contact is the least, and the steps behind it are not measured."""
    post = Obstacle(Body("post", slab([0.6, -0.05, 0.0], [0.7, 0.05, 0.1])))
    way = sliding(slab([0.0, -0.05, 0.0], [0.1, 0.05, 0.1]), [0.0, 0.3, 0.5, 0.3, 0.1, 0.0])
    run = cl.check(dataclasses.replace(way, obstacles=(post,)), need="minimum")
    with opened(run, tmp_path) as page:
        told = {}
        for step in (2, 5):
            page.run(f"window.clearance.showFrame(window.clearance.frameOfStep({step}))")
            told[step] = page.run("document.getElementById('readout').textContent")
        assert "contact" in told[2]
        assert "status unknown" in told[5] and "contact" not in told[5]
        assert page.run("document.querySelectorAll('.curve.unknown').length") > 0
        assert page.errors == []
