"""A part of a picture's samples, which may have been traced elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True, eq=False)
class Part:
    """`sums` are those of `viewer.trace.paths.film.Film.read`, without `bad` samples; `rays` were traced for them
    in `seconds`."""

    sums: np.ndarray
    rays: int
    seconds: float
    bad: int = 0

    def __add__(self, other: Part) -> Part:
        """Both, with sums in float64."""
        return Part(self.sums + other.sums.astype(np.float64), self.rays + other.rays, self.seconds + other.seconds,
                    self.bad + other.bad)
