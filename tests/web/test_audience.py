"""How fast each client gets pictures: as fast as it shows them."""

from __future__ import annotations

import asyncio
import math
import time
from typing import Any, cast

import pytest
from waiting import PATIENCE_S

from viewer.web.audience import SHOWN, Audience, Client
from viewer.web.view import REST_SECONDS, RemoteView

SIZE = {"kind": "size", "width": 10, "height": 10}


class Counted:
    """A view whose pictures are their numbers. It moves until it has made `end` of them."""

    def __init__(self, end: float = math.inf) -> None:
        self.version, self.changed_at, self.end = 0, -math.inf, end

    @property
    def seconds_until_work(self) -> float:
        return 0.0 if self.version < self.end else math.inf

    @property
    def seconds_until_rest(self) -> float:
        return max(self.changed_at + REST_SECONDS - time.monotonic(), 0.0)

    def step(self) -> None:
        if self.version < self.end:
            self.version, self.changed_at = self.version + 1, time.monotonic()

    def encoded(self, lossless: bool) -> bytes:
        return f"{'png' if lossless else 'jpeg'} {self.version}".encode()

    def words(self) -> dict[str, object]:
        return {"status": ""}

    def handle(self, client: object, message: object) -> None:
        pass

    forget = words


class Seat:
    """A client, and all the pictures that it was sent. `answers`: it shows them at once."""

    def __init__(self, audience: Audience, answers: bool = True, begins: bool = True) -> None:
        self.got: list[str] = []
        self._audience, self._answers = audience, answers
        self.client = Client(self._deliver)
        audience.join(self.client)
        if begins:
            audience.hear(self.client, SIZE)

    def _deliver(self, words: dict[str, Any], picture: bytes | None) -> None:
        self.got += [picture.decode()] if picture is not None else []
        if self._answers:
            asyncio.get_running_loop().call_soon(self.answer)

    def answer(self) -> None:
        self._audience.hear(self.client, SHOWN)


def run(audience: Audience, condition) -> None:
    """Attend until the condition holds."""
    end = time.monotonic() + PATIENCE_S
    asyncio.run(audience.attend(lambda: condition() or time.monotonic() > end))
    assert condition()


@pytest.fixture(autouse=True)
def _looks_often(monkeypatch):
    """Whoever counts its looks need not wait long for them."""
    monkeypatch.setattr("viewer.web.audience.LOOK_SECONDS", 0.02)


def make(end: float = math.inf) -> tuple[Counted, Audience]:
    view = Counted(end)
    view.forget = lambda client: None  # type: ignore[method-assign, assignment]
    return view, Audience(cast(RemoteView, view))


def test_a_slow_client_gets_fewer_pictures_and_then_the_newest():
    view, audience = make()
    fast, slow = Seat(audience), Seat(audience, answers=False)
    run(audience, lambda: view.version >= 20)
    assert slow.got == ["jpeg 1"] and fast.got == [f"jpeg {k}" for k in range(1, view.version + 1)]
    slow.answer()
    run(audience, lambda: len(slow.got) == 2)
    assert slow.got[1] == f"jpeg {view.version}"


def test_nothing_is_drawn_while_nobody_looks_or_can_show_it():
    view, audience = make()
    looks = iter(range(10**6))
    run(audience, lambda: next(looks) >= 3)
    assert view.version == 0
    waiting, hidden = Seat(audience, answers=False), Seat(audience, begins=False)
    run(audience, lambda: next(looks) >= 12)
    assert view.version == 1 and waiting.got == ["jpeg 1"] and hidden.got == []
    hidden.answer()  # it was sent nothing
    run(audience, lambda: next(looks) >= 16)
    assert view.version == 1
    audience.leave(waiting.client)
    audience.leave(hidden.client)
    assert audience.is_empty


def test_a_picture_at_rest_comes_once_more_without_loss():
    view, audience = make(end=3)
    seat = Seat(audience)
    run(audience, lambda: len(seat.got) == 4)
    assert seat.got == ["jpeg 1", "jpeg 2", "jpeg 3", "png 3"]
    assert time.monotonic() - view.changed_at >= REST_SECONDS
    late = Seat(audience)
    looks = iter(range(10**6))
    run(audience, lambda: next(looks) >= 8)
    assert late.got == ["png 3"] and len(seat.got) == 4
