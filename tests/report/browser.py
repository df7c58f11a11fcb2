"""A headless Chromium for tests, driven over its DevTools protocol. Not for: anything but looking and clicking."""

from __future__ import annotations

import asyncio
import atexit
import base64
import functools
import itertools
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from clearance.record.record import Record
from clearance.run import Run
from tests.report.made import write

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
FLAGS = (
    "--headless", "--no-sandbox", "--disable-quic", "--no-first-run", "--mute-audio",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
    "--disable-gpu", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--hide-scrollbars", "--remote-debugging-port=0",
)  # fmt: skip
PATIENCE = 90.0
"""[s] most time for any one thing: software WebGL on a busy machine is slow."""


def executable() -> str | None:
    """The browser to use: `CLEARANCE_CHROMIUM`, or the first of `NAMES` that is installed."""
    given = os.environ.get("CLEARANCE_CHROMIUM")
    return given or next((path for path in map(shutil.which, NAMES) if path), None)


class Page:
    """One tab. `errors` collects what the page wrote to the console as an error, and uncaught exceptions."""

    def __init__(self, loop: asyncio.AbstractEventLoop, socket: Any) -> None:
        self._loop, self._socket, self._ids = loop, socket, itertools.count(1)
        self.errors: list[str] = []
        self.requests: list[str] = []
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """The result of one protocol command."""
        return self._loop.run_until_complete(
            asyncio.wait_for(self._call(method, parameters), PATIENCE)
        )

    async def _call(self, method: str, parameters: dict[str, Any]) -> dict[str, Any]:
        wanted = next(self._ids)
        await self._socket.write_message(
            json.dumps({"id": wanted, "method": method, "params": parameters})
        )
        while True:
            text = await self._socket.read_message()
            assert text is not None, f"the browser went away during {method}"
            message = json.loads(text)
            if message.get("id") == wanted:
                assert "error" not in message, f"{method}: {message['error']}"
                return message["result"]
            self._note(message)

    def _note(self, message: dict[str, Any]) -> None:
        method, told = message.get("method"), message.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.errors.append(json.dumps(told["exceptionDetails"]))
        elif method == "Runtime.consoleAPICalled" and told["type"] in ("error", "assert"):
            self.errors.append(json.dumps(told["args"]))
        elif method == "Log.entryAdded" and told["entry"]["level"] == "error":
            self.errors.append(told["entry"]["text"])
        elif method == "Network.requestWillBeSent":
            self.requests.append(told["request"]["url"])

    def open(self, url: str, ready: str, width: int = 1280, height: int = 800) -> None:
        """Loads `url` and waits until the script expression `ready` is true."""
        self.size(width, height)
        self.call("Page.bringToFront")  # only the tab in front draws
        self.call("Page.navigate", url=url)
        self.wait(ready)

    def size(self, width: int, height: int) -> None:
        """Sets the size of the window."""
        self.call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=False,
        )

    def wait(self, ready: str) -> None:
        """Waits until the script expression `ready` is true."""
        end = time.monotonic() + PATIENCE
        while not self.run(f"Boolean({ready})"):
            assert time.monotonic() < end, f"waited in vain for {ready}; errors: {self.errors}"
            time.sleep(0.1)

    def run(self, script: str) -> Any:
        """The value of a script expression."""
        answer = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer["exceptionDetails"]
        return answer["result"].get("value")

    def click(self, x: float, y: float) -> None:
        """Moves the mouse to a point of the window and clicks, as a hand does."""
        self.call("Input.dispatchMouseEvent", type="mouseMoved", x=x, y=y)
        time.sleep(0.3)
        for kind in ("mousePressed", "mouseReleased"):
            self.call("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)

    def settle(self) -> None:
        """Waits for two drawn frames."""
        self.call("Page.bringToFront")
        self.run(
            "new Promise((done) => "
            "requestAnimationFrame(() => requestAnimationFrame(() => done(true))))"
        )

    def box(self, selector: str) -> dict[str, float]:
        """Where an element stands in the window: x, y, width, height."""
        return self.run(
            f"(() => {{const r = document.querySelector({selector!r}).getBoundingClientRect();"
            "return {x: r.x, y: r.y, width: r.width, height: r.height}})()"
        )

    def picture(self, selector: str | None = None, whole: bool = False) -> bytes:
        """A PNG of the window, of one element of it, or of the whole page."""
        clip = {"clip": {**self.box(selector), "scale": 1}} if selector else {}
        return base64.b64decode(
            self.call("Page.captureScreenshot", format="png", captureBeyondViewport=whole, **clip)[
                "data"
            ]
        )

    def pixels(self, selector: str) -> np.ndarray:
        """(h, w, 3) uint8 of an element."""
        import io

        from PIL import Image

        return np.asarray(Image.open(io.BytesIO(self.picture(selector))).convert("RGB"))

    def pdf(self) -> bytes:
        """The page as it prints."""
        return base64.b64decode(
            self.call("Page.printToPDF", printBackground=True, preferCSSPageSize=True)["data"]
        )


@contextmanager
def chromium() -> Iterator[Page]:
    """A fresh tab of the browser; it is gone afterwards."""
    from tornado.websocket import websocket_connect

    tab = _asked("new", "PUT")
    loop = asyncio.new_event_loop()
    try:
        socket = loop.run_until_complete(_connect(websocket_connect, tab["webSocketDebuggerUrl"]))
        yield Page(loop, socket)
    finally:
        _asked(f"close/{tab['id']}")
        loop.close()


@contextmanager
def opened(made: Record | Run, folder: Path) -> Iterator[Page]:
    """The page of a report that is written below a folder, drawn; its `report` is where it is."""
    write(made, folder / "out")
    with chromium() as page:
        page.report = (folder / "out" / "report.html").as_uri()
        page.open(page.report, "window.clearance")
        page.settle()
        yield page


def show(page: Page, step: int) -> dict:
    """The state of the page of a run once it shows a step."""
    page.run(f"window.clearance.showFrame(window.clearance.frameOfStep({step}))")
    page.settle()
    return page.run("window.clearance.state()")


@functools.cache
def _started() -> int:
    """The port of the browser of this process, with which it ends."""
    profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
    browser = subprocess.Popen(
        [executable(), *FLAGS, f"--user-data-dir={profile.name}", "about:blank"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    for end in (profile.cleanup, browser.wait, browser.terminate):  # in the other order
        atexit.register(end)
    return _port(Path(profile.name), browser)


async def _connect(connect: Any, url: str) -> Any:
    return await connect(url, max_message_size=1 << 28)


def _port(profile: Path, browser: subprocess.Popen) -> int:
    end = time.monotonic() + PATIENCE
    told = profile / "DevToolsActivePort"
    while not (told.exists() and told.read_text().strip()):
        assert browser.poll() is None, f"the browser ended with {browser.returncode}"
        assert time.monotonic() < end, "the browser did not open its port"
        time.sleep(0.1)
    return int(told.read_text().split()[0])


def _asked(what: str, method: str = "GET") -> Any:
    """The browser's answer about a tab."""
    from urllib.request import ProxyHandler, Request, build_opener

    request = Request(f"http://127.0.0.1:{_started()}/json/{what}", method=method)
    with build_opener(ProxyHandler({})).open(request, timeout=PATIENCE) as answer:
        text = answer.read()
    return json.loads(text) if method == "PUT" else text
