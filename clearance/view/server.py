"""A server for one page and what it draws, in a thread of this process, for the browser of this user alone.

It listens on the loopback address only; its address holds a secret that no other user of the machine knows; and it
answers to no other name of the machine and to no other page's script, so that a foreign page in the same browser
cannot read the scene, whatever name its site gives our address (DNS rebinding). It is a thread, not a process: no
end of this process leaves it behind. Not for: what is drawn (`viewer`).
"""

from __future__ import annotations

import asyncio
import secrets
import threading
from collections.abc import Sequence

import tornado.httpserver
import tornado.netutil
import tornado.web
import tornado.websocket

LOOPBACK = "127.0.0.1"


class PageServer:
    """Serves a page, its script, and a websocket that gives every browser the same messages.

    Args:
        page: HTML; it finds the script as `script.js` and the websocket as `scene` beside itself.
        messages: what the websocket sends, in order.
    """

    def __init__(self, page: str, script: bytes, messages: Sequence[bytes]) -> None:
        sockets = tornado.netutil.bind_sockets(0, LOOPBACK)
        self.port: int = sockets[0].getsockname()[1]
        secret = secrets.token_urlsafe(24)
        self.url = f"http://{LOOPBACK}:{self.port}/{secret}/"
        known = {"host": f"{LOOPBACK}:{self.port}"}
        app = tornado.web.Application(
            [
                (
                    f"/{secret}/",
                    _PageHandler,
                    {**known, "content": page.encode(), "kind": "text/html"},
                ),
                (
                    f"/{secret}/script.js",
                    _PageHandler,
                    {**known, "content": script, "kind": "text/javascript"},
                ),
                (f"/{secret}/scene", _SceneHandler, {**known, "messages": messages}),
            ],
            default_handler_class=_NotFoundHandler,
            default_handler_args=known,
            log_function=lambda handler: None,
        )
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(app, sockets), daemon=True)
        self._thread.start()
        self._started.wait()

    def _run(self, app: tornado.web.Application, sockets: list) -> None:
        asyncio.run(self._serve(app, sockets))

    async def _serve(self, app: tornado.web.Application, sockets: list) -> None:
        self._loop, self._ended = asyncio.get_running_loop(), asyncio.Event()
        server = tornado.httpserver.HTTPServer(app)
        server.add_sockets(sockets)
        self._started.set()
        await self._ended.wait()
        server.stop()
        await server.close_all_connections()

    def close(self) -> None:
        """Ends the server; a second call does nothing."""
        if self._thread.is_alive():
            self._loop.call_soon_threadsafe(self._ended.set)
            self._thread.join()


class _GuardedHandler(tornado.web.RequestHandler):
    """Answers only who has asked for the address by its number, from a page of ours or from none."""

    _host: str

    def prepare(self) -> None:
        origin = self.request.headers.get("Origin")
        if self.request.headers.get_list("Host") != [self._host] or origin not in (
            None,
            f"http://{self._host}",
        ):
            raise tornado.web.HTTPError(403)

    def set_default_headers(self) -> None:
        self.clear_header("Server")
        self.set_header("Cache-Control", "no-store")
        self.set_header("Cross-Origin-Resource-Policy", "same-origin")
        self.set_header("Referrer-Policy", "no-referrer")
        self.set_header("X-Content-Type-Options", "nosniff")
        self.set_header("X-Frame-Options", "DENY")


class _PageHandler(_GuardedHandler):
    def initialize(self, host: str, content: bytes, kind: str) -> None:
        self._host, self._content, self._kind = host, content, kind

    def get(self) -> None:
        self.set_header("Content-Type", f"{self._kind}; charset=utf-8")
        self.finish(self._content)


class _NotFoundHandler(_GuardedHandler):
    def initialize(self, host: str) -> None:
        self._host = host

    def prepare(self) -> None:
        super().prepare()
        raise tornado.web.HTTPError(404)


class _SceneHandler(_GuardedHandler, tornado.websocket.WebSocketHandler):
    def initialize(self, host: str, messages: Sequence[bytes]) -> None:
        self._host, self._messages = host, messages

    def check_origin(self, origin: str) -> bool:
        return origin == f"http://{self._host}"

    async def open(self) -> None:
        try:
            for message in self._messages:
                await self.write_message(message, binary=True)
        except tornado.websocket.WebSocketClosedError:
            return

    def on_message(self, message: str | bytes) -> None:
        """What a browser says changes nothing."""
