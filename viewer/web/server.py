"""A small server of one view: a page, and a socket through which pictures go out and what mouse and keys do comes in.

Both have the token in their addresses, and nothing else is served: no path leads to a file.
"""

from __future__ import annotations

import asyncio
import base64
import errno
import hashlib
import hmac
import html
import json
import logging
import secrets
import socket
import traceback
from collections.abc import Callable
from http import HTTPStatus
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..base.messages import one_line
from ..errors import OutputError, UsageError
from ..measure.report.page import embedded
from .audience import SHOWN, Audience, Client
from .messages import BadMessage
from .view import RemoteView

if TYPE_CHECKING:
    from websockets.asyncio.server import ServerConnection
    from websockets.http11 import Request, Response

MOST_BYTES = 4096
"""Of a message of a client; ours have a few hundred."""
_HERE = Path(__file__).resolve().parent
_PAGE = """<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<link rel="icon" href="data:,">
<style>{style}</style>
<div id="view"></div>
<noscript>This page needs scripts.</noscript>
<script type="application/json" id="config">{config}</script>
<script>{script}</script>
</html>
"""


class ViewServer:
    """Serves `view` at `address` between `start` and `stop`, to all who know the token in it."""

    def __init__(self, view: RemoteView) -> None:
        self.audience = Audience(view)
        self._token = secrets.token_urlsafe(24)
        script = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in ("view.js", "serve.js"))
        style = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in ("view.css", "serve.css"))
        self._page = _PAGE.format(title=html.escape(one_line(view.state.scene.name)), style=style, script=script,
                                  config=embedded({"keys": view.keys(), "help": view.help()})).encode()
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        self._headers = {
            "Cache-Control": "no-store", "Referrer-Policy": "no-referrer", "X-Content-Type-Options": "nosniff",
            "Cross-Origin-Resource-Policy": "same-origin",
            "Content-Security-Policy": f"default-src 'none'; script-src 'sha256-{digest}'; style-src 'unsafe-inline'; "
                                       "img-src data:; connect-src 'self'; base-uri 'none'; "
                                       "form-action 'none'; frame-ancestors 'none'",
        }

    async def run(self, listener: socket.socket, announce: Callable[[str], None],
                  wants_to_stop: Callable[[], bool]) -> None:
        """Serve at `listener` until `wants_to_stop()`. `announce` gets the address. Raises as `RemoteView.step`."""
        from websockets.asyncio.server import serve

        async with serve(
                self._attend, sock=listener, process_request=self._answer, max_size=MOST_BYTES, compression=None,
                server_header=None, ping_interval=20, ping_timeout=120, close_timeout=1, logger=_silent()):
            announce(self._address(*listener.getsockname()[:2]))
            await self.audience.attend(wants_to_stop)

    def _address(self, host: str, port: int) -> str:
        name = socket.gethostname() if host in ("0.0.0.0", "::") else f"[{host}]" if ":" in host else host
        return f"http://{name}:{port}/{self._token}/"

    def _answer(self, connection: ServerConnection, request: Request) -> Response | None:
        """The response to a request; None for one that shall become a socket."""
        token, _, name = request.path.partition("?")[0].removeprefix("/").partition("/")
        if not hmac.compare_digest(token.encode("utf-8", "replace"), self._token.encode()):
            return self._respond(HTTPStatus.FORBIDDEN, b"The address lacks the right token.\n")
        if name == "":
            return self._respond(HTTPStatus.OK, self._page, "text/html; charset=utf-8")
        if name != "view":
            return self._respond(HTTPStatus.NOT_FOUND, b"There is nothing here.\n")
        if not _is_same_origin(request):
            return self._respond(HTTPStatus.FORBIDDEN, b"Only the page of this server may connect.\n")
        return None

    def _respond(self, status: HTTPStatus, body: bytes, kind: str = "text/plain; charset=utf-8") -> Response:
        from websockets.datastructures import Headers
        from websockets.http11 import Response

        headers = Headers(self._headers | {"Content-Type": kind, "Content-Length": str(len(body)),
                                           "Connection": "close"})
        return Response(status.value, status.phrase, headers, body)

    async def _attend(self, connection: ServerConnection) -> None:
        """Listen to one client until it goes."""
        from websockets.exceptions import ConnectionClosed

        async def send(words: dict[str, Any], picture: bytes | None) -> None:
            try:
                await connection.send(json.dumps(words | {"hasPicture": picture is not None}, allow_nan=False))
                if picture is not None:
                    await connection.send(picture)
            except ConnectionClosed:
                pass

        sending: asyncio.Task[None] | None = None

        def deliver(words: dict[str, Any], picture: bytes | None) -> None:
            nonlocal sending
            sending = asyncio.get_running_loop().create_task(send(words, picture))

        client = Client(deliver)
        self.audience.join(client)
        try:
            async for message in connection:
                content = json.loads(message)
                if content == SHOWN and sending is not None:
                    await sending  # else pictures would pile up for one that says so without reading them
                self.audience.hear(client, content)
        except (BadMessage, ValueError, RecursionError):
            await connection.close(1008, "not a message of this page")
        except ConnectionClosed:
            pass
        except Exception:
            traceback.print_exc()  # else it would only be logged, and logs are silent
            raise
        finally:
            self.audience.leave(client)


def listen(host: str, port: int) -> socket.socket:
    """A socket that listens; port 0 is any that is free.

    Raises OutputError for a port that is in use or not allowed, and UsageError for a host that is no address of this
    machine.
    """
    try:
        family, _, _, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        return socket.create_server(address[:2], family=family)
    except OSError as error:
        if error.errno == errno.EADDRINUSE:
            problem = "is in use; choose another by --port, or --port 0 for any that is free"
        elif error.errno == errno.EACCES:
            problem = "is not open to this user; those from 1024 on are"
        else:
            raise UsageError(f"--host {host}: is no address of this machine") from error
        raise OutputError(f"port {port} of {host} {problem}") from error


def _is_same_origin(request: Request) -> bool:
    """Whether a page of this very server asks: browsers say truly whose page it is."""
    origins, hosts = request.headers.get_all("Origin"), request.headers.get_all("Host")
    return len(origins) == len(hosts) == 1 and origins[0] in (f"http://{hosts[0]}", f"https://{hosts[0]}")


def _silent() -> logging.Logger:
    """A logger that keeps requests, whose addresses have the token, out of all logs."""
    logger = logging.Logger("pbr-viewer serve")
    logger.addHandler(logging.NullHandler())
    logger.propagate = False
    return logger
