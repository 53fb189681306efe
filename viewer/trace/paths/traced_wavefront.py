"""A wavefront, and the hits of its rays until it is shaded."""

from __future__ import annotations

from dataclasses import dataclass

from ..rays.intersect import Answer
from .wavefront import Wavefront


@dataclass
class TracedWavefront:
    """`answer` has the hits of the present rays, if they were traced; `iterations` counts the steps of its paths."""

    wavefront: Wavefront
    answer: Answer | None = None
    iterations: int = 0

    @property
    def is_busy(self) -> bool:
        """Whether any of its blocks may not be done yet."""
        return bool(self.wavefront.is_busy.any())
