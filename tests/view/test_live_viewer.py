"""The viewer: it serves the page of a report as it is, verdict and all, until the program ends."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from pathlib import Path
from urllib.error import URLError
from urllib.request import ProxyHandler, build_opener

import numpy as np
import pytest

from clearance import cli
from clearance.cli import view
from clearance.errors import BadSyntax, MissingFile
from clearance.report.withdrawn import withdraw_report
from clearance.view import PageServer, page_in
from tests.report.browser import chromium, executable
from tests.report.made import replay_of, run_of, write
from tests.report.records import record, with_contacts

SCENES = Path(__file__).parents[2] / "scenes"
RUN = with_contacts(record())


@pytest.mark.browser
@pytest.mark.skipif(executable() is None, reason="no Chromium is installed")
def test_it_shows_the_verdict_and_plays_the_replay():
    replay = replay_of(RUN)
    with PageServer(run_of(RUN).page().encode()) as server, chromium() as page:
        page.open(server.url, "window.clearance")
        page.settle()
        state = page.run("window.clearance.state()")
        ends = replay.lines[replay.i_worst].reshape(2, 3)
        assert state["frame"] == replay.i_worst and np.abs(state["dots"] - ends).max() < 1e-9
        assert page.run("document.querySelector('.verdict').textContent").startswith("Contact")
        asked = {url for url in page.requests if not url.startswith(("data:", "blob:"))}
        assert page.errors == [] and asked == {server.url}


def test_a_folder_is_shown_as_its_page(tmp_path):
    write(RUN, tmp_path / "out")
    with PageServer(page_in(tmp_path / "out")) as server:
        assert server.url.startswith("http://127.0.0.1")
        page = build_opener(ProxyHandler({})).open(server.url, timeout=120).read()
    assert page == (tmp_path / "out" / "report.html").read_bytes()


def test_the_page_itself_may_be_named(tmp_path, monkeypatch):
    (tmp_path / "report.html").write_text("<html></html>")
    seen = []
    monkeypatch.setattr("clearance.view.show", lambda name, page: seen.append(page))
    assert cli.run(["view", str(tmp_path / "report.html")]) == 0
    assert seen == [b"<html></html>"]


def test_a_report_that_a_later_run_has_withdrawn_is_told_as_older(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr("clearance.view.show", lambda name, page: None)
    write(RUN, tmp_path / "out")
    for told in (False, True):
        assert cli.run(["view", str(tmp_path / "out")]) == 0
        assert ("what is shown is older" in capsys.readouterr().err) == told
        withdraw_report(tmp_path / "out")


def test_the_verdict_of_a_case_is_printed_and_its_run_shown(capsys):
    page = view._checked(SCENES / "box_pipe" / "case.yaml")
    told = capsys.readouterr().out
    assert told.startswith("VIOLATED  box_pipe") and "5.123 mm" in told
    assert '<p class="verdict violated">' in page


@pytest.mark.parametrize("name", ["nowhere", "empty"])
def test_a_folder_without_a_report_is_refused_in_one_line(tmp_path, name):
    (tmp_path / "empty").mkdir()
    with pytest.raises(MissingFile) as caught:
        page_in(tmp_path / name)
    assert name in str(caught.value)


def test_a_page_that_is_cut_off_is_refused(tmp_path):
    (tmp_path / "report.html").write_text("<html><body>Clear")
    with pytest.raises(BadSyntax, match="run `clearance check` again"):
        page_in(tmp_path)


@pytest.mark.browser
@pytest.mark.skipif(not hasattr(signal, "SIGHUP"), reason="other signals")
@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_the_server_ends_with_the_program(how):
    script = "from clearance.view import show; show('it', b'a page', open_browser=False)"
    program = subprocess.Popen(
        [sys.executable, "-c", script], stdout=subprocess.PIPE, text=True,
        preexec_fn=lambda: signal.signal(how, signal.SIG_DFL),  # who runs tests may have it ignored
    )  # fmt: skip
    url = re.search(r"http://\S+", program.stdout.readline())[0]
    ask = build_opener(ProxyHandler({})).open
    assert ask(url, timeout=120).status == 200
    program.send_signal(how)
    assert program.wait(timeout=120) == 0
    with pytest.raises(URLError):
        ask(url, timeout=120)
