"""`pbr-viewer serve`: shows a model in the browsers of those who have the address."""

from __future__ import annotations

import asyncio
import ipaddress
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

from ..base.messages import say
from ..base.signals import postponed
from ..errors import UsageError
from ..gpu.context import open_context
from ..interact.playback import Playback
from ..quality import Quality
from ..scene.camera import Camera
from ..scene.scene import Scene
from ..settings import Settings
from .view import RemoteView


def check_server() -> None:
    """Raises UsageError where there is none."""
    if find_spec("websockets") is None:
        raise UsageError("a server needs the package websockets: pip install 'pbr-viewer[serve]'")


def serve_model(scene: Scene, settings: Settings, camera: Camera | None, playback: Playback, quality: Quality,
                options: dict[str, Any], announce: Callable[[str], None]) -> None:
    """Serve until a signal to stop comes. `announce` gets the address.

    Raises ContextError before anything is served, and as `ViewServer.run`.
    """
    from .server import ViewServer

    host, port = options["host"], options["port"]
    view = RemoteView(lambda: open_context(options["backend"]), scene, settings, camera, options["size"],
                      not options["no_cache"], playback, quality)
    view.wake()
    try:
        server = ViewServer(view)

        def tell(address: str) -> None:
            if not is_loopback(host):
                say(f"warning: --host {host} opens this port to all who can reach this machine: who has the address "
                    "sees the model and turns it, and nothing is encrypted")
            announce(address)
            if not options["quiet"]:
                say("Ctrl-C ends it")

        with postponed() as request:
            asyncio.run(server.run(host, port, tell, lambda: request.number is not None))
    finally:
        view.sleep()


def is_loopback(host: str) -> bool:
    """Whether only this machine can reach the address."""
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"
