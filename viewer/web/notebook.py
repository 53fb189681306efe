"""A view in a cell of a notebook, drawn by its kernel."""

from __future__ import annotations

import asyncio
import base64
from pathlib import Path
from typing import Any

import anywidget
import traitlets

from ..errors import ViewerError
from .audience import Audience, Client
from .messages import BadMessage
from .view import RemoteView

MOST_AWAKE = 4
"""Views that hold an OpenGL context. A page that is closed does not say so, and a cell that is run again makes another
view. So the one that nobody has looked at for the longest frees what it holds, until it is looked at again."""
_HERE = Path(__file__).resolve().parent
_awake: list[NotebookView] = []
"""The one that was looked at last is the last."""


class NotebookView(anywidget.AnyWidget):
    """Shows `view` wherever the widget is displayed, and a still where widgets are not, as in exported notebooks.

    It is drawn on the thread of the kernel, between the messages that the kernel handles, and not while a cell runs.
    """

    _esm = "\n".join((_HERE / name).read_text(encoding="utf-8") for name in ("view.js", "notebook.js"))
    _css = (_HERE / "view.css").read_text(encoding="utf-8")
    config = traitlets.Dict().tag(sync=True)

    def __init__(self, view: RemoteView) -> None:
        self._audience = Audience(view)
        self._clients: dict[str, Client] = {}
        self._attending: asyncio.Task[None] | None = None
        self._still = base64.b64encode(view.still()).decode()
        self._keep_awake()
        super().__init__(config={"keys": view.keys(), "help": view.help(), "size": view.size})
        self.on_msg(self._take)

    def sleep(self) -> None:
        """Free what OpenGL holds, until it is looked at again."""
        if self in _awake:
            _awake.remove(self)
        self._audience.view.sleep()

    def _take(self, _: object, content: Any, buffers: object) -> None:
        """A message of one of the places where the widget is shown."""
        name, message = content.get("view"), content.get("message")
        if not isinstance(name, str) or not isinstance(message, dict):
            return
        if message.get("kind") == "bye":
            if name in self._clients:
                self._audience.leave(self._clients.pop(name))
            return
        if name not in self._clients:
            self._clients[name] = Client(lambda words, picture: self.send(
                {"view": name, "words": words}, None if picture is None else [picture]))
            self._audience.join(self._clients[name])
        if message.get("kind") != "hello":
            try:
                self._audience.hear(self._clients[name], message)
            except BadMessage:
                return
        self._keep_awake()
        if self._attending is None:
            self._attending = asyncio.get_running_loop().create_task(self._attend())

    async def _attend(self) -> None:
        """Draw until nobody looks, or until others have been looked at since."""
        try:
            await self._audience.attend(lambda: self._audience.is_empty or self not in _awake)
        except (ViewerError, MemoryError) as error:
            text = str(error) or "out of memory"
            for name in self._clients:
                self.send({"view": name, "words": {"message": text, "isError": True}})
        finally:
            self._attending = None
            self.sleep()

    def _keep_awake(self) -> None:
        if self in _awake:
            _awake.remove(self)
        _awake.append(self)
        for other in _awake[:-MOST_AWAKE]:
            _awake.remove(other)
            if other._attending is None:
                other.sleep()  # else its task ends, and does

    def _repr_mimebundle_(self, **kwargs: Any) -> Any:
        bundle = super()._repr_mimebundle_(**kwargs)
        if bundle is None:
            return None
        data, metadata = bundle
        return data | {"image/jpeg": self._still}, metadata
