"""How small a picture has to be while it moves, so that a slow machine follows the hand."""

from __future__ import annotations

import math

FRAME_SECONDS = 1 / 15
"""What a frame should take, with reading and encoding it. More of it looks like single pictures."""
MOST_STEPS = 3
"""Each step halves the pixels. After three, details are as wide as three pixels, and less hardly saves time."""
SLOWER, FASTER = 0.3, -1.5
"""Logarithms to base 2 of a frame's time in units of FRAME_SECONDS beyond which the size changes. They lie more than a
step apart, so the size does not change back and forth."""


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
