"""`clearance view`: the page of a report, served to the browser of this user.

The page has the verdict, the clearance over time, and meshcat's viewer with the line between the witness points.
Not for: making reports.
"""

from __future__ import annotations

import signal
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from clearance.errors import BadSyntax, MissingFile
from clearance.view.server import PageServer

PAGE = "report.html"


class Playback:
    """A page that is served until `close`, or as a context manager until its end."""

    def __init__(self, page: bytes) -> None:
        self._server = PageServer(page)

    @property
    def url(self) -> str:
        """The address to open in a browser."""
        return self._server.url

    def wait(self) -> None:
        """Returns when the user interrupts, or when this process is asked to end. To be called in the main
        thread."""
        with _until_interrupted():
            threading.Event().wait()

    def close(self) -> None:
        """Ends the server."""
        self._server.close()

    def __enter__(self) -> Playback:
        return self

    def __exit__(self, *problem: object) -> None:
        self.close()


def show(name: str, page: bytes, open_browser: bool = True) -> None:
    """Serves a page until the user interrupts; prints its address."""
    with Playback(page) as playback, _until_interrupted():
        print(f"{name} is playing at {playback.url} (Ctrl-C ends it)", flush=True)
        if open_browser:
            webbrowser.open(playback.url, new=2)
        playback.wait()


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
