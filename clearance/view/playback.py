"""`clearance view`: a replay, or the folder of one, playing in the browser as a report's page plays it.

The page has meshcat's viewer with the line between the witness points, the clearance over time, and links to the
moments that somebody looks for. Not for: making reports.
"""

from __future__ import annotations

import math
import signal
import threading
import webbrowser
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np

from clearance.errors import MissingFile
from clearance.extras import require
from clearance.record.replay import FILE_NAME, Replay, load_replay
from clearance.record.wording import seconds
from clearance.report.blocks import At, Bullets, Inline, Section
from clearance.report.page import replay_page
from clearance.view.server import PageServer


class Playback:
    """A record that is playing; the server runs until `close`, or as a context manager until its
    end."""

    def __init__(self, replay: Replay) -> None:
        require("view", "the live view")
        self.replay = replay
        links = [Inline(text, at=At(time=time)) for text, time in moments_of(replay)]
        self._server = PageServer(replay_page(replay, Section("Moments", [Bullets(links)])))

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


def show(what: Replay | str | Path, open_browser: bool = True) -> None:
    """Plays a replay, or the folder of a report, until the user interrupts; prints the address.

    Raises:
        MissingFile: the folder is not there or holds no report. BadSyntax: its replay is damaged.
    """
    with play(what) as playback, _until_interrupted():
        print(f"{playback.replay.name} is playing at {playback.url} (Ctrl-C ends it)", flush=True)
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


def play(what: Replay | str | Path) -> Playback:
    """A live viewer of a replay, or of the folder of a report, that runs in the background.

    Raises:
        MissingFile: the folder is not there or holds no report. BadSyntax: its replay is damaged.
        Unavailable: a library of the extra `view` is missing.
    """
    return Playback(what if isinstance(what, Replay) else _replay_in(Path(what)))


def _replay_in(folder: Path) -> Replay:
    if not folder.is_dir():
        raise MissingFile(
            "no such folder", where=str(folder), valid="a folder that `clearance check --out` wrote"
        )
    return load_replay(folder / FILE_NAME)


def moments_of(replay: Replay) -> Iterator[tuple[str, float]]:
    """Moments to look at, each with its time [s]: the worst, where each limit is entered first, pick-ups, the
    deepest contact."""
    worst = replay.i_worst
    micrometres = math.floor(replay.worst.clearance * 1e6)  # down: never more than was measured
    time = float(replay.times[worst])
    move = replay.moves[replay.move[worst]] if replay.move[worst] >= 0 else ""
    yield f"worst: {micrometres / 1000:.3f} mm at {seconds(time, move)}", time
    for code, name in ((1, "first near miss"), (2, "first violation"), (3, "first contact")):
        if (replay.status == code).any():
            yield name, float(replay.times[np.argmax(replay.status == code)])
    for carry in replay.carries:
        yield f"{carry.by} takes {carry.part} at {carry.start:.3f} s", carry.start
    if replay.contacts:
        deepest = max(replay.contacts, key=lambda contact: contact.penetration)
        depth = math.ceil(deepest.penetration * 1e6) / 1000
        yield f"deepest contact: {depth:.3f} mm", float(replay.times[deepest.frame])
