"""A server for one page, in a thread of this process, for the browser of this user alone.

It listens on the loopback address only; its address holds a secret that no other user of the machine knows; and it
answers to no other name of the machine and to no other page's script, so that a foreign page in the same browser
cannot read the scene, whatever name its site gives our address (DNS rebinding). It is a thread, not a process: no
end of this process leaves it behind. Not for: making reports.
"""

from __future__ import annotations

import secrets
import signal
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

from clearance.errors import BadSyntax, MissingFile

PAGE = "report.html"
LOOPBACK = "127.0.0.1"

GUARDS = {
    "Cache-Control": "no-store",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "DENY",
}
"""Headers of every answer."""


class PageServer:
    """Serves a page until `close`, or as a context manager until its end; `url` is its address."""

    def __init__(self, page: bytes) -> None:
        self._server = _Server(page)
        self.port: int = self._server.server_port
        self.url = f"http://{self._server.host}{self._server.place}"
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Ends the server; a second call does nothing."""
        if self._thread.is_alive():
            self._server.shutdown()
            self._thread.join()
            self._server.server_close()

    def __enter__(self) -> PageServer:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, content: bytes) -> None:
        super().__init__((LOOPBACK, 0), _Handler)
        self.content = content
        self.host = f"{LOOPBACK}:{self.server_port}"
        self.place = f"/{secrets.token_urlsafe(24)}/"


class _Handler(BaseHTTPRequestHandler):
    """Answers only who has asked for the address by its number, from a page of ours or from none."""

    server: _Server
    timeout = 60

    def do_GET(self) -> None:
        """The page, to who may see it and knows where it is."""
        status = self._status()
        content = self.server.content if status is HTTPStatus.OK else status.phrase.encode()
        self.send_response_only(status)
        kind = "text/html" if status is HTTPStatus.OK else "text/plain"
        headers = {"Content-Type": f"{kind}; charset=utf-8", "Content-Length": str(len(content))}
        for name, value in {**headers, **GUARDS}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(content)

    def _status(self) -> HTTPStatus:
        host, origin = self.server.host, self.headers.get("Origin")
        if self.headers.get_all("Host") != [host] or origin not in (None, f"http://{host}"):
            return HTTPStatus.FORBIDDEN
        known = secrets.compare_digest(self.path.encode(), self.server.place.encode())
        return HTTPStatus.OK if known else HTTPStatus.NOT_FOUND

    def log_message(self, format: str, *args: object) -> None:
        """Nothing is written of who has asked."""


def show(name: str, page: bytes, open_browser: bool = True) -> None:
    """Serves a page until the user interrupts; prints its address."""
    with PageServer(page) as server, _until_interrupted():
        print(f"{name} is playing at {server.url} (Ctrl-C ends it)", flush=True)
        if open_browser:
            webbrowser.open(server.url, new=2)
        threading.Event().wait()


@contextmanager
def _until_interrupted() -> Iterator[None]:
    """Ends the block, without an error, at Ctrl-C or where this process is asked to end."""
    before = signal.signal(signal.SIGTERM, signal.default_int_handler)
    try:
        yield
    except KeyboardInterrupt:
        return
    finally:
        signal.signal(signal.SIGTERM, before)


def page_in(folder: Path) -> bytes:
    """The page in the folder of a report.

    Raises:
        MissingFile: the folder is not there or holds no report. BadSyntax: its page is cut off.
    """
    written = "a folder that `clearance check --out` wrote"
    if not folder.is_dir():
        raise MissingFile("no such folder", where=str(folder), valid=written)
    path = folder / PAGE
    if not path.is_file():
        raise MissingFile("no report here", where=str(path), valid=written)
    page = path.read_bytes()
    if not page.rstrip().endswith(b"</html>"):
        raise BadSyntax("the page is cut off", where=str(path), valid="run `clearance check` again")
    return page
