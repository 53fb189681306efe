"""A wavefront, and the hits of its rays until it is shaded."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..rays.intersect import Answer
from .wavefront import Wavefront


@dataclass
class TracedWavefront:
    """`finish` waits for the hits of the present rays, where they are traced; `iterations` counts the steps of its
    paths."""

    wavefront: Wavefront
    finish: Callable[[], Answer] | None = None
    iterations: int = 0

    @property
    def is_busy(self) -> bool:
        """Whether any of its blocks may not be done yet."""
        return bool(self.wavefront.is_busy.any())
