"""How small a picture has to be while it moves, so that a slow machine follows the hand."""

from __future__ import annotations

import math
from time import monotonic

FRAME_SECONDS = 1 / 15
"""What a frame should take, with showing it, or with reading and encoding it. More of it looks like single pictures."""
MOST_STEPS = 3
"""Each step halves the pixels. After three, details are as wide as three pixels, and less hardly saves time."""
SLOWER, FASTER = 0.3, -1.5
"""Logarithms to base 2 of a frame's time in units of FRAME_SECONDS beyond which the size changes. They lie more than a
step apart, so the size does not change back and forth."""
STILL_SECONDS = 0.1
"""A picture that has not moved for so long is drawn at its whole size. The events of a mouse that moves follow each
other faster."""


class Pace:
    """Learns from the frames that it is told of."""

    def __init__(self) -> None:
        self._steps = 0

    def size(self, whole: tuple[int, int]) -> tuple[int, int]:
        """Of the next frame that moves, in pixels, for pictures that have `whole` at rest."""
        scale = 2 ** (-self._steps / 2)
        return max(round(whole[0] * scale), 1), max(round(whole[1] * scale), 1)

    def took(self, seconds: float) -> None:
        """The last frame that moved took so long."""
        excess = math.log2(max(seconds, 1e-9) / FRAME_SECONDS)
        if excess > SLOWER:
            self._steps = min(self._steps + math.ceil(excess - SLOWER), MOST_STEPS)
        elif excess < FASTER:
            self._steps = max(self._steps - 1, 0)


class FrameSize:
    """Chooses the size of each frame of a view."""

    def __init__(self) -> None:
        self.size = self._whole = 0, 0
        """Of the last frame, in pixels."""
        self._pace = Pace()
        self._moved_at = -math.inf
        self._began_at: float | None = None

    def begin(self, whole: tuple[int, int], moves: bool) -> tuple[int, int]:
        """The size of the frame that begins now, of a view that has `whole` at rest, and that moves or does not."""
        self._began_at = monotonic() if moves else None
        if self._began_at is not None:
            self._moved_at = self._began_at
            self.size = self._pace.size(whole)
        elif whole != self._whole or self.seconds_until_still <= 0:
            self.size = whole
        self._whole = whole
        return self.size

    def shown(self) -> None:
        """All the work for the frame is done."""
        if self._began_at is not None:
            self._moved_at = monotonic()
            self._pace.took(self._moved_at - self._began_at)
            self._began_at = None

    @property
    def is_whole(self) -> bool:
        return self.size == self._whole

    @property
    def seconds_until_still(self) -> float:
        """Negative since the view has been at rest."""
        return self._moved_at + STILL_SECONDS - monotonic()
