"""The viewer serves the page of a report to the browser of this user, on this machine, and to nobody else."""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from urllib.error import HTTPError, URLError
from urllib.request import ProxyHandler, Request, build_opener

import numpy as np
import pytest

from clearance import cli
from clearance.cli import view
from clearance.errors import BadSyntax, MissingFile
from clearance.report.withdrawn import withdraw_report
from clearance.view import page_in
from clearance.view.server import PageServer
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


ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def server():
    made = PageServer(b"<p>a page</p>")
    yield made
    made.close()


def status(url: str, **headers: str) -> int:
    try:
        return build_opener(ProxyHandler({})).open(Request(url, headers=headers), timeout=20).status
    except HTTPError as error:
        return error.code


def test_who_asks_gets_the_page_and_it_guards_itself(server):
    own = f"http://127.0.0.1:{server.port}"
    for headers in ({}, {"Origin": own}):
        found = build_opener(ProxyHandler({})).open(Request(server.url, headers=headers))
        assert found.read() == b"<p>a page</p>" and found.headers["Cache-Control"] == "no-store"
        assert found.headers["X-Frame-Options"] == "DENY" and "Server" not in found.headers


def test_only_the_loopback_address_listens(server):
    """127.0.0.2 and ::1 are this machine too: what listens on every address answers there."""
    for family, address in ((socket.AF_INET, "127.0.0.2"), (socket.AF_INET6, "::1")):
        try:
            asked = socket.socket(family)
        except OSError:
            continue
        with asked, pytest.raises(OSError):
            asked.connect((address, server.port))


@pytest.mark.parametrize("place", ["", "nothing"])
@pytest.mark.parametrize(
    "headers",
    [
        {"Host": "rebound.example"}, {"Host": "rebound.example:{port}"}, {"Host": "localhost:{port}"},
        {"Host": "127.0.0.1"}, {"Host": ""}, {"Origin": "http://rebound.example:{port}"},
        {"Origin": "http://127.0.0.1"}, {"Origin": "https://127.0.0.1:{port}"}, {"Origin": "null"},
    ],
)  # fmt: skip
def test_a_foreign_host_or_origin_is_refused(server, place, headers):
    headers = {name: text.format(port=server.port) for name, text in headers.items()}
    assert status(server.url + place, **headers) in (
        (400, 403) if headers.get("Host") == "" else (403,)
    )


def test_who_does_not_know_the_secret_sees_nothing(server):
    base = f"http://127.0.0.1:{server.port}/"
    secret = server.url.removeprefix(base)
    for wrong in ("", "static/", "scene", "x" * len(secret[:-1]) + "/", secret[:-2] + "/"):
        assert status(base + wrong) == 404
    assert len(secret) > 30


def test_two_servers_have_two_secrets(server):
    other = PageServer(b"")
    other.close()
    other.close()
    assert other.url.split("/")[3] != server.url.split("/")[3]


TRAP = (
    "import pathlib; pathlib.Path(__file__).with_suffix('.trapped').touch(); raise SystemExit(99)\n"
)
TRAPPED = ("zmq", "tornado", "meshcat", "click", "numpy", "umsgpack", "IPython", "PIL")


@pytest.fixture
def viewing(tmp_path):
    """`clearance view` of a received folder, standing in it."""
    (tmp_path / "report.html").write_text("<p>a page</p></html>\n")
    for name in TRAPPED:
        (tmp_path / f"{name}.py").write_text(TRAP)
    program = subprocess.Popen(
        [sys.executable, "-m", "clearance", "view", "."], cwd=tmp_path, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, text=True, env={**os.environ, "PYTHONPATH": str(ROOT), "BROWSER": "true"},
    )  # fmt: skip
    yield program
    program.kill()
    program.communicate()


@pytest.mark.cold
@pytest.mark.skipif(not Path("/proc/net/tcp").exists(), reason="another way to list sockets")
def test_nothing_in_the_folder_is_run_and_the_program_listens_at_one_address_only(
    viewing, tmp_path
):
    told = viewing.stdout.readline()
    assert re.search(r"http://127\.0\.0\.1:\d+/", told), viewing.stderr.read()
    assert [path.name for path in tmp_path.glob("*.trapped")] == []
    port = int(re.search(r":(\d+)/", told)[1])
    folder = Path("/proc") / str(viewing.pid)
    own = set()
    for path in (folder / "fd").iterdir():
        with suppress(FileNotFoundError):  # closed meanwhile
            own.add(os.readlink(path))
    tables = [(folder / "net" / name).read_text().splitlines()[1:] for name in ("tcp", "tcp6")]
    rows = [row.split() for table in tables for row in table]
    listening = [row[1] for row in rows if row[3] == "0A" and f"socket:[{row[9]}]" in own]
    assert listening == [f"0100007F:{port:04X}"]
