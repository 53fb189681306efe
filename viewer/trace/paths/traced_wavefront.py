"""Two wavefronts take turns: one is shaded while the other is traced."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from ..rays.intersect import Answer, Intersector
from .wavefront import Wavefront


@dataclass
class TracedWavefront:
    """A wavefront, and the hits of its rays until it is shaded. `finish` waits for those of the present rays, where
    they are traced; `iterations` counts the steps of its paths."""

    wavefront: Wavefront
    finish: Callable[[], Answer] | None = None
    iterations: int = 0

    @property
    def is_busy(self) -> bool:
        """Whether any of its blocks may not be done yet."""
        return bool(self.wavefront.is_busy.any())


def take_turn(wavefronts: list[TracedWavefront], intersector: Intersector, shade: Callable[[Wavefront, Answer], None],
              flush: Callable[[], None]) -> int:
    """Trace the rays of the first wavefront while the second is shaded; then swap the two. Returns how many rays of the
    second were traced before.

    Everything that is read from the device is read before the shading is submitted, because a read waits for all work
    that was submitted before it.
    """
    first, second = wavefronts
    rays = intersector.fetch(first.wavefront) if first.is_busy else None
    count = 0
    if second.finish is not None:
        answer = second.finish()
        second.finish = None
        count = answer.rays or 0
        intersector.store(second.wavefront, answer)
        shade(second.wavefront, answer)
        second.iterations += 1
        flush()
    if rays is not None:
        first.finish = intersector.begin(rays)
    wavefronts.reverse()
    return count
