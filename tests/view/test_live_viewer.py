"""The live viewer: it plays what the replay holds as a report's page does, and leads to the moments to look at."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from urllib.error import URLError
from urllib.request import ProxyHandler, build_opener

import numpy as np
import pytest

import clearance as cl
from clearance.errors import BadSyntax, MissingFile
from clearance.view import play, show
from clearance.view.playback import moments_of
from tests.report.browser import chromium, executable
from tests.report.cells import cell
from tests.report.made import replay_of, write
from tests.report.records import record, with_contacts

RUN = with_contacts(record())


@pytest.mark.browser
@pytest.mark.skipif(executable() is None, reason="no Chromium is installed")
def test_it_plays_the_replay_and_its_links_lead_to_moments():
    replay = replay_of(RUN)
    with play(replay) as playback, chromium() as page:
        page.open(playback.url, "window.clearance")
        page.settle()
        state = page.run("window.clearance.state()")
        ends = replay.lines[replay.i_worst].reshape(2, 3)
        assert state["frame"] == replay.i_worst and np.abs(state["dots"] - ends).max() < 1e-9
        links = page.run("[...document.querySelectorAll('main li a')].map((a) => a.textContent)")
        assert links == [text for text, _ in moments_of(replay)]
        for i, (_, time) in enumerate(moments_of(replay)):
            page.run(f"document.querySelectorAll('main li a')[{i}].click()")
            frame = page.run("window.clearance.state().frame")
            assert replay.times[frame] == pytest.approx(time)
        assert len(page.run("window.clearance.state().contacts")) == 1
        assert page.run("document.querySelectorAll('.chart .curve').length") == 4
        asked = {url for url in page.requests if not url.startswith(("data:", "blob:"))}
        assert page.errors == [] and asked == {playback.url}


def test_moments_are_the_worst_the_first_of_each_kind_pick_ups_and_the_deepest_contact():
    replay = replay_of(RUN)
    told, status = dict(moments_of(replay)), RUN.steps["status"].to_pylist()
    worst, *firsts, deepest = told
    assert worst == f"worst: 0.000 mm at {RUN.worst.time:.3f} s" and "deepest contact" in deepest
    assert firsts == ["first near miss", "first violation", "first contact"]
    found = [told[name] for name in (*firsts, deepest)]
    steps = [*(status.index(kind) for kind in ("near", "violated", "contact")), RUN.deepest.step]
    assert found == RUN.motions[0].times[steps].tolist()
    picked = dict(moments_of(cl.check(cell()).session.replay()))
    assert picked["right/tool takes part at 2.000 s"] == 2.0


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


def test_a_damaged_replay_is_refused(tmp_path):
    (tmp_path / "replay.npz").write_bytes(b"PK nonsense")
    with pytest.raises(BadSyntax, match="run `clearance check` again"):
        play(tmp_path)


@pytest.mark.browser
@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="other signals")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_server_ends_with_the_program(tmp_path, how):
    replay_of(RUN).save(tmp_path / "replay.npz")
    script = "import sys; from clearance.view import show; show(sys.argv[1], open_browser=False)"
    program = subprocess.Popen(
        [sys.executable, "-c", script, str(tmp_path)], stdout=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(how, signal.SIG_DFL),  # who runs tests may have it ignored
    )  # fmt: skip
    url = re.search(r"http://\S+", program.stdout.readline())[0]
    ask = build_opener(ProxyHandler({})).open
    assert ask(url, timeout=120).status == 200
    program.send_signal(how)
    assert program.wait(timeout=120) == 0
    with pytest.raises(URLError):
        ask(url, timeout=120)
