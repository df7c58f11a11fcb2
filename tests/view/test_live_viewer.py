"""The live viewer: meshcat holds what the replay holds, and its own controls move it."""

from __future__ import annotations

import json
import re
import signal
import subprocess
import sys
from dataclasses import replace
from urllib.error import URLError
from urllib.request import ProxyHandler, build_opener

import numpy as np
import pytest

from clearance.errors import BadSyntax, MissingFile
from clearance.view import play, show
from clearance.view.playback import line_tracks
from tests.report.browser import Page, chromium, executable
from tests.report.made import replay_of, write
from tests.report.records import record, with_contacts

RUN = with_contacts(record())
WORLD = """(name) => {
  const scene = viewer.scene; scene.updateMatrixWorld(true); const back =
  scene.matrixWorld.clone().invert(); const node = viewer.scene_tree.find(name).object; const at =
  (z) => new MeshCat.THREE.Vector3(0, 0,
  z).applyMatrix4(node.matrixWorld).applyMatrix4(back).toArray(); return {visible: node.visible,
  centre: at(0), ends: [at(-0.5), at(0.5)]};
}"""


@pytest.fixture(scope="module")
def page() -> Page:
    if executable() is None:
        pytest.skip("no Chromium is installed")
    with play(replay_of(RUN)) as playback, chromium() as page:
        page.open(playback.url, "window.viewer && Object.keys(viewer.gui_controllers).length >= 4")
        page.wait("viewer.animator.duration > 0")
        page.settle()
        yield page


def node(page: Page, *path: str) -> dict:
    return page.run(f"({WORLD})({json.dumps(['meshcat', *path])})")


def press(page: Page, start: str) -> None:
    page.run(f"(() => {{ const all = viewer.gui_controllers;"
             f"all[Object.keys(all).find((name) => name.startsWith({start!r}))].getValue()"
             ".call(viewer); })()")  # fmt: skip
    page.settle()


def slide(page: Page, step: int) -> None:
    page.run(f"void viewer.gui_controllers['step'].setValue({step})")
    page.settle()


def row(step: int) -> dict:
    return RUN.steps.slice(step, 1).to_pylist()[0]


@pytest.mark.parametrize("step", [0, 1, 44, 130, 239])
def test_the_step_slider_puts_line_and_links_where_the_record_has_them(page, step):
    slide(page, step)
    expected = row(step)
    ends = np.array(
        [[expected[f"{body}_{axis}"] for axis in "xyz"] for body in ("link", "obstacle")]
    )
    line = node(page, "clearance", expected["status"], "line")
    assert np.abs(np.array(line["ends"]) - ends).max() < 1e-5, "three.js keeps tracks in float32"
    for i, body in enumerate(RUN.case.robots[0].robot.bodies):
        drawn = node(page, "links", f"{i} {body.name}")["centre"]
        assert np.abs(drawn - RUN.motions[0].poses(step, step + 1)[0, i, :3, 3]).max() < 1e-6


@pytest.mark.parametrize("status", ["clear", "near", "violated", "contact"])
def test_only_the_line_in_the_colour_of_the_status_is_visible(page, status):
    slide(page, RUN.steps["status"].to_pylist().index(status))
    visible = {
        s for s in ("clear", "near", "violated", "contact") if node(page, "clearance", s)["visible"]
    }
    assert visible == {status}


def test_the_button_jumps_to_the_worst_step(page):
    slide(page, 200)
    press(page, "worst")
    expected = RUN.motions[0].poses(RUN.worst_step, RUN.worst_step + 1)[0, 3, :3, 3]
    assert np.abs(node(page, "links", "3 gripper")["centre"] - expected).max() < 1e-6
    assert not page.run("viewer.animator.playing")


def test_the_button_jumps_to_the_deepest_contact_which_is_drawn_there_only(page):
    press(page, "deepest")
    at = [i for i, row in enumerate(RUN.contacts) if row.step == RUN.deepest.step]
    drawn = [node(page, "contacts", str(i))["visible"] for i in range(len(RUN.contacts))]
    assert [i for i, seen in enumerate(drawn) if seen] == at
    slide(page, 0)
    assert not any(node(page, "contacts", str(i))["visible"] for i in at)


def test_it_plays_and_scrubs_with_meshcats_own_controls(page):
    slide(page, 0)
    page.run("viewer.animator.play()")
    page.wait("viewer.animator.time > 0.5")
    page.run("viewer.animator.pause()")
    page.run("void viewer.animator.time_scrubber.setValue(3.0)")
    expected = RUN.motions[0].poses(119, 120)[0, 3, :3, 3]
    assert np.abs(node(page, "links", "3 gripper")["centre"] - expected).max() < 1e-6


def test_the_picture_is_not_blank_and_nothing_failed(page):
    press(page, "worst")
    pixels = page.pixels("#meshcat-pane").astype(int)
    assert len(np.unique(pixels.reshape(-1, 3), axis=0)) > 200
    assert [error for error in page.errors if "404" not in error] == [], "meshcat has no favicon"


@pytest.mark.slow
def test_a_folder_plays_like_its_record(tmp_path):
    write(RUN, tmp_path / "out")
    with play(tmp_path / "out") as playback:
        assert playback.url.startswith("http://127.0.0.1")
        assert playback.replay.steps.tolist() == replay_of(RUN).steps.tolist()


@pytest.mark.parametrize("name", ["nowhere", "empty"])
def test_a_folder_without_a_report_is_refused_in_one_line(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(MissingFile) as caught:
        show(tmp_path / name, open_browser=False)
    assert name in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_damaged_replay_is_refused(tmp_path):
    (tmp_path / "replay.npz").write_bytes(b"PK nonsense")
    with pytest.raises(BadSyntax, match="run `clearance check` again"):
        play(tmp_path)


def test_the_rod_reaches_from_point_to_point_in_every_direction():
    from scipy.spatial.transform import Rotation

    rng = np.random.default_rng(7)
    lines = rng.normal(size=(60, 6))
    lines[0, 3:] = lines[0, :3] - [0, 0, 2.0]  # straight down
    lines[1, 3:] = lines[1, :3] + [1e-9, 0, -1.0]  # almost
    lines[2, 3:] = lines[2, :3]  # contact
    middles, turns, scales = map(np.array, line_tracks(lines))
    half = Rotation.from_quat(turns).apply(np.column_stack([0 * scales[:, :2], 0.5 * scales[:, 2]]))
    assert np.abs(np.column_stack([middles - half, middles + half]) - lines).max() < 3e-9


ENDS = {
    signal.SIGINT: 0,
    signal.SIGTERM: 0,
    signal.SIGHUP: -signal.SIGHUP,
    signal.SIGKILL: -signal.SIGKILL,
}


HEARD = (signal.SIGINT, signal.SIGHUP)
"""What a program that runs the tests in the background may have them ignore."""


@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="other signals")
@pytest.mark.parametrize("how", ENDS)
def test_the_server_ends_with_the_program(tmp_path, how):
    replay_of(RUN).save(tmp_path / "replay.npz")
    script = "import sys; from clearance.view import show; show(sys.argv[1], open_browser=False)"
    program = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path)], stdout=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(how, signal.SIG_DFL) if how in HEARD else None,
    )  # fmt: skip
    url = re.search(r"http://\S+", program.stdout.readline())[0]
    ask = build_opener(ProxyHandler({})).open
    assert ask(url, timeout=120).status == 200
    program.send_signal(how)
    assert program.wait(timeout=120) == ENDS[how]
    with pytest.raises(URLError):
        ask(url, timeout=120)


def test_a_run_that_ends_in_contact_plays(tmp_path):
    """Each overlap is hidden in the frame after its own, where there is one."""
    replay = replay_of(RUN)
    last = len(replay.times) - 1
    at_the_end = replace(replay, contacts=[replace(one, frame=last) for one in replay.contacts])
    at_the_end.save(tmp_path / "replay.npz")
    with play(tmp_path) as playback:
        assert {contact.frame for contact in playback.replay.contacts} == {last}
