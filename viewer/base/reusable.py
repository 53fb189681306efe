"""A resource that is reused as long as it fits."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar


class Releasable(Protocol):
    def release(self) -> object: ...


T = TypeVar("T", bound=Releasable)


class Reusable(Generic[T]):
    """Holds at most one `T`. The old one is released before a new one is made, so that both need not fit in memory."""

    def __init__(self) -> None:
        self.held: T | None = None

    def get(self, fits: Callable[[T], bool], make: Callable[[], T]) -> T:
        """What is held if there is something and it `fits`; else what `make` returns, which is held from now on."""
        if self.held is None or not fits(self.held):
            self.release()
            self.held = make()
        return self.held

    def release(self) -> None:
        held, self.held = self.held, None  # nothing is held, even if `make` fails
        if held is not None:
            held.release()
