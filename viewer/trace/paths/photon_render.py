"""Traces photons and adds them to a film, in rounds: the film has all that a photon brings or nothing of it."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..layout import TILE
from ..rays.intersect import Intersector
from .behind_glass import BehindGlass
from .film import Film
from .photon_passes import PhotonPasses
from .traced_wavefront import TracedWavefront
from .wavefront import SUMS, Sums, Wavefront, Work

ROUNDS = 8
"""Rounds of a picture whose number of photons is known, if they are not too small or too large."""
MOST_EACH = 4
"""Most photons of a texel in one round."""
SEQUENCE = 1 << 16
"""Work of a sequence of random numbers (shaders/trace/emit.frag), in photons of a texel."""


class PhotonRender:
    """Two wavefronts of photons take turns, as in `viewer.trace.paths.path_render.PathRender`. `most` is the number of
    photons that the picture may have at last."""

    def __init__(self, passes: PhotonPasses, intersector: Intersector, film: Film,
                 make_wavefront: Callable[[], Wavefront], check_interval: int, most: int, has_glass: bool) -> None:
        self.rays = 0
        self._passes, self._intersector, self._film = passes, intersector, film
        self._check_interval = check_interval
        self._wavefronts = [TracedWavefront(make_wavefront()) for _ in range(2)]
        self._behind_glass = BehindGlass(passes, intersector, make_wavefront()) if has_glass else None
        self._splats = Sums(passes.context.gl, film.size, SUMS)
        self._flush: Callable[[], None] = passes.context.function("glFlush")
        blocks = 2 * len(self._wavefronts[0].wavefront.is_busy)
        self._each = min(max(most // (ROUNDS * blocks * TILE * TILE), 1), MOST_EACH)
        self._round = blocks * TILE * TILE * self._each
        self._issued = 0

    def iterate(self) -> None:
        """Trace the rays of one wavefront while the other is shaded."""
        first, second = self._wavefronts
        if not (first.is_busy or second.is_busy or second.answer):
            for traced in self._wavefronts:
                self._begin(traced)
        if first.iterations % self._check_interval == 0 and first.is_busy and first.iterations:
            first.wavefront.is_busy[:] = self._passes.find_alive(first.wavefront)
        probe = self._behind_glass if self._film.photons == 0 and second.answer is not None else None
        rays = self._intersector.fetch(first.wavefront) if first.is_busy else None
        if second.answer is not None:
            self._intersector.store(second.wavefront, second.answer)
            second.answer = None
            self._passes.shade_onto(second.wavefront, self._splats, probe.rays if probe else None)
            second.iterations += 1
            self._flush()
        if rays is not None:
            first.answer = self._intersector.trace(rays)
            self.rays += first.answer.rays or 0
        if probe is not None:
            probe.measure()
        self._wavefronts = [second, first]
        if not (first.is_busy or second.is_busy or first.answer):
            self._film.add_photons(self._splats, self._round)
            self._splats.framebuffer.clear()

    def _begin(self, traced: TracedWavefront) -> None:
        blocks = np.arange(len(traced.wavefront.is_busy))
        work = []
        for _ in blocks:
            sequence, first = divmod(self._issued, SEQUENCE // self._each * self._each)
            work.append(Work(sequence, 0, first, self._each))
            self._issued += self._each
        traced.wavefront.assign(blocks, work)
        traced.iterations = 0
        self._passes.begin(traced.wavefront, blocks)

    @property
    def behind_glass(self) -> float:
        """The share of the photons' light that is seen only through smooth glass (`BehindGlass.share`)."""
        return 0.0 if self._behind_glass is None else self._behind_glass.share

    def release(self) -> None:
        if self._behind_glass is not None:
            self._behind_glass.release()
        for traced in self._wavefronts:
            traced.wavefront.release()
        self._splats.release()
