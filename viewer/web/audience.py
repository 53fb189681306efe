"""Who looks at a view: each gets pictures as fast as it shows them, and never one for which a newer one is there."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from typing import Any

from .messages import message_of
from .view import RemoteView

BREATH_SECONDS = 0.002
"""Between two slices of work, for what else the event loop has to do; all input that has come comes before a frame."""
SHOWN = {"kind": "shown"}
"""The message by which a client answers that it has shown what it was sent."""
LOOK_SECONDS = 0.25
"""How often `attend` looks whether it shall end, at least."""


class Client:
    """One that looks on. `deliver(words, picture)` sends the words over the picture and, if there is a new one, the
    picture, and returns at once; the client answers when it has shown them. It begins when its size is known."""

    def __init__(self, deliver: Callable[[dict[str, Any], bytes | None], None]) -> None:
        self._deliver = deliver
        self._has_begun = self._is_ready = False
        self._version, self._is_lossless = -1, False
        self._words: dict[str, Any] = {}

    @property
    def is_ready(self) -> bool:
        """Whether it has shown all that it was sent. Nothing is sent before, so nothing piles up for a slow one."""
        return self._is_ready

    def begin(self) -> None:
        """Its size is known."""
        if not self._has_begun:
            self._has_begun = self._is_ready = True

    def answer(self) -> None:
        """It has shown what it was sent."""
        self._is_ready = self._has_begun

    def look(self, view: RemoteView) -> None:
        """Send what is new to it."""
        words, rests = view.words(), view.seconds_until_rest <= 0
        is_new = view.version > 0 and (self._version != view.version or (rests and not self._is_lossless))
        if not self._is_ready or not (is_new or words != self._words):
            return
        picture = view.encoded(rests) if is_new else None
        if is_new:
            self._version, self._is_lossless = view.version, rests
        self._words, self._is_ready = words, False
        self._deliver(words, picture)


class Audience:
    """The clients of one view. While there are none, nothing is drawn or traced."""

    def __init__(self, view: RemoteView) -> None:
        self.view = view
        self._clients: set[Client] = set()
        self._news = asyncio.Event()

    @property
    def is_empty(self) -> bool:
        return not self._clients

    def join(self, client: Client) -> None:
        self._clients.add(client)
        self._news.set()

    def leave(self, client: Client) -> None:
        self._clients.discard(client)
        self.view.forget(client)
        self._news.set()

    def hear(self, client: Client, content: Any) -> None:
        """Take what a client has sent: decoded JSON. Raises BadMessage."""
        if content == SHOWN:
            client.answer()
        else:
            message = message_of(content)
            self.view.handle(client, message)
            if message.kind == "size":
                client.begin()
        self._news.set()

    async def attend(self, wants_to_stop: Callable[[], bool]) -> None:
        """Draw and send until `wants_to_stop()`. Raises as `RemoteView.step`."""
        self._news = asyncio.Event()  # of the loop that runs now
        while not wants_to_stop():
            self._news.clear()
            wait = self._work()
            if wait > 0:
                try:
                    await asyncio.wait_for(self._news.wait(), min(wait, LOOK_SECONDS))
                except TimeoutError:
                    continue
            await asyncio.sleep(BREATH_SECONDS)

    def _work(self) -> float:
        """Do a slice of work, and return for how long there is no more."""
        view = self.view
        if not any(client.is_ready for client in self._clients):
            return LOOK_SECONDS
        view.step()
        for client in self._clients:
            client.look(view)
        return min(view.seconds_until_work, view.seconds_until_rest or LOOK_SECONDS)
