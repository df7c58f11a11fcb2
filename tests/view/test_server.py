"""Who may look: the browser of this user, on this machine, at a page of ours; and nothing else listens."""

from __future__ import annotations

import os
import re
import socket
import subprocess
import sys
from contextlib import suppress
from pathlib import Path
from urllib.error import HTTPError
from urllib.request import ProxyHandler, Request, build_opener

import pytest

from clearance.view.server import PageServer

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
