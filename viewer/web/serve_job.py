"""`pbr-viewer serve`: shows a model in the browsers of those who have the address."""

from __future__ import annotations

import asyncio
import ipaddress
import socket
from collections.abc import Callable
from importlib.util import find_spec

from ..base.messages import say
from ..base.signals import postponed
from ..errors import UsageError
from .view import RemoteView


def check_server() -> None:
    """Raises UsageError where there is none."""
    if find_spec("websockets") is None:
        raise UsageError("a server needs the package websockets: pip install 'pbr-viewer[serve]'")


def serve_model(view: RemoteView, listener: socket.socket, quiet: bool, announce: Callable[[str], None]) -> None:
    """Serve `view` at `listener` until a signal to stop comes. `announce` gets the address.

    Raises ContextError before anything is served, and as `RemoteView.step`.
    """
    from .server import ViewServer

    def tell(address: str) -> None:
        host = listener.getsockname()[0]
        if not ipaddress.ip_address(host).is_loopback:
            say(f"warning: --host {host} opens this port to all who can reach this machine: who has the address sees "
                "the model and turns it, and nothing is encrypted")
        announce(address)
        if not quiet:
            say("Ctrl-C ends it")

    try:
        view.wake()
        with postponed() as request:
            asyncio.run(ViewServer(view).run(listener, tell, lambda: request.number is not None))
    finally:
        view.sleep()
