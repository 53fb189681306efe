"""Traces photons and adds them to sums, in rounds: these have all that a photon brings or nothing of it."""

from __future__ import annotations

import math
import time
from collections.abc import Callable

import numpy as np

from ..layout import TILE
from ..rays.intersect import Intersector
from .photon_passes import PhotonPasses
from .photon_sums import PhotonSums
from .traced_wavefront import TracedWavefront, take_turn
from .wavefront import SUMS, Sums, Work
from .wavefront_maker import WavefrontMaker

MOST_EACH = 4
"""Most photons of a texel in one round."""
GROWTH = 0.5
"""A round begins when the film lacks so many times its photons, and brings what it lacks. So there are few rounds, each
of which waits for its longest paths, and the film never has much fewer photons than samples."""
SEQUENCE = 1 << 16
"""Work of a sequence of random numbers (shaders/trace/emit.frag), in photons of a texel."""
WEIGHED = 1 << 18
"""So many photons tell how much of their light the picture lacks."""


class PhotonRender:
    """Two wavefronts of photons take turns, as in `viewer.trace.paths.path_render.PathRender`. Those for samples that
    are numbered from `first` on are others than those for the samples before."""

    def __init__(self, passes: PhotonPasses, intersector: Intersector, sums: PhotonSums, maker: WavefrontMaker,
                 first: int = 0) -> None:
        self.rays = 0
        self._passes, self._intersector, self.sums = passes, intersector, sums
        self._check_interval = maker.check_interval
        self._wavefronts = [TracedWavefront(maker.make(sees_backs=True)) for _ in range(2)]
        self._arriving = Sums(passes.context.gl, (1, 1), 1)
        self._splats = Sums(passes.context.gl, sums.size, SUMS)
        self._flush: Callable[[], None] = passes.context.function("glFlush")
        self._round = 0
        self._numbers = Numbers(first)

    @property
    def _block_count(self) -> int:
        """Of one wavefront."""
        return len(self._wavefronts[0].wavefront.is_busy)

    def is_due(self, samples: int, is_last: bool) -> bool:
        """Whether to go on with a round, or to begin one for a film of so many samples; `is_last` says that it will get
        no more. The first comes when there is a sample a pixel, about."""
        if self._round:
            return True
        lacking = samples - self.sums.count
        wanted = max(math.prod(self.sums.size), GROWTH * self.sums.count)
        return lacking >= (1 if is_last else min(wanted, 2 * self._block_count * TILE * TILE * MOST_EACH))

    def iterate(self, samples: int) -> None:
        """Trace the rays of one wavefront while the other is shaded. A round that begins brings as many photons as a
        film of so many samples lacks, if they fit."""
        first, second = self._wavefronts
        if not self._round:
            self._begin(samples - self.sums.count)
        if first.iterations % self._check_interval == 0 and first.is_busy and first.iterations:
            first.wavefront.is_busy[:] = self._passes.find_alive(first.wavefront)
        arriving = self._arriving if self.sums.count < WEIGHED else None
        self.rays += take_turn(self._wavefronts, self._intersector, lambda wavefront, _: self._passes.shade_onto(
            wavefront, self._splats, arriving), self._flush)
        if not (first.is_busy or second.is_busy or first.finish):
            self.sums.add(self._splats, self._round)
            self._splats.framebuffer.clear()
            self._round = 0

    def _begin(self, lacking: int) -> None:
        """Begin a round of about so many photons, in whole blocks."""
        wanted = -(-lacking // (TILE * TILE))
        each = min(max(-(-wanted // (2 * self._block_count)), 1), MOST_EACH)
        count = min(max(-(-wanted // each), 1), 2 * self._block_count)
        for traced, part in zip(self._wavefronts, (count - count // 2, count // 2), strict=True):
            blocks = np.arange(part)
            traced.iterations = 0
            if part:
                traced.wavefront.assign(blocks, [self._numbers.next(each) for _ in blocks])
                self._passes.begin(traced.wavefront, blocks)
        self._round = count * TILE * TILE * each

    def step(self, seconds: float, goal: int) -> None:
        """Trace for about this time, and at least one iteration, until there are `goal` photons."""
        start = time.perf_counter()
        self._passes.context.make_current()
        while self.is_due(goal, True):
            self.iterate(goal)
            if time.perf_counter() - start >= seconds:
                break

    @property
    def lost_share(self) -> float:
        """Of the photons' light that comes to the eye, the share whose last surface is smooth: light that is seen in
        mirrors or through smooth glass, and so is not in the picture. 0 if there is none."""
        light = self._arriving.framebuffer.read(components=4, dtype="f4")
        rough, smooth = np.frombuffer(light, np.float32)[:2].tolist()
        return smooth / (rough + smooth) if smooth > 0 else 0.0

    def stats(self) -> dict[str, object]:
        """For JSON: how many photons there are, how many splats were left out, and `lost_share`."""
        return {"photons": self.sums.count, "bad_splats": self.sums.bad, "photons_lost": self.lost_share}

    def release(self) -> None:
        self._arriving.release()
        for traced in self._wavefronts:
            traced.wavefront.release()
        self._splats.release()


class Numbers:
    """Hands out random numbers: each work item has those of `each` photons of a texel, which no other has.

    The first ones are of this `sequence`. One is enough for a photon in each of 16 million pixels.
    """

    def __init__(self, sequence: int = 0) -> None:
        self._sequence, self._first = sequence, 0

    def next(self, each: int) -> Work:
        """All of one sequence: if it has less than `each` left, they are not used."""
        if self._first + each > SEQUENCE:
            self._sequence, self._first = self._sequence + 1, 0
        work = Work(self._sequence, 0, self._first, each)
        self._first += each
        return work
