"""A GPU resource that is kept and reused as long as it fits what is asked for."""

from __future__ import annotations

from collections.abc import Callable
from typing import Generic, Protocol, TypeVar


class Releasable(Protocol):
    def release(self) -> object: ...


T = TypeVar("T", bound=Releasable)


class Reusable(Generic[T]):
    """Holds at most one `T`. The old one is released before a new one is made, so the two never use memory at once."""

    def __init__(self) -> None:
        self.held: T | None = None

    def get(self, fits: Callable[[T], bool], make: Callable[[], T]) -> T:
        """The held resource if there is one and it `fits`. Otherwise the result of `make`, which is then held."""
        if self.held is None or not fits(self.held):
            self.release()
            self.held = make()
        return self.held

    def release(self) -> None:
        held, self.held = self.held, None  # nothing is held, even if `make` fails
        if held is not None:
            held.release()
