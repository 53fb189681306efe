"""The `fast` and the `raster` denoiser, which combine pictures that are right in different places."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor, wait
from dataclasses import dataclass

import moderngl
import numpy as np

from ...gpu.context import Context
from ...gpu.float_texture import read_texels
from ...gpu.programs import Programs
from ...image.neighbours import LARGEST
from .combine import combined
from .denoiser import NoisyFilm, SplitFilm
from .wavelet import Wavelet

_PAUSE_S = 0.01


class Combining:
    """Filters both parts of the film, and combines them, the samples, and a guide if there is one (`combine`).

    The emission of first hits has little noise and would decide for its neighbourhood, so it is subtracted before that
    and added after it.
    """

    def __init__(self, context: Context, programs: Programs) -> None:
        self._context = context
        self._wavelet = Wavelet(context, programs)
        self._thread = ThreadPoolExecutor(1)
        self._texture: moderngl.Texture | None = None
        self._result: moderngl.Texture | None = None

    @property
    def result(self) -> moderngl.Texture:
        """The picture that was filtered last. It stays valid until the last of the next `steps`."""
        assert self._result is not None
        return self._result

    def filter(self, film: SplitFilm, guide: np.ndarray | None = None) -> moderngl.Texture:
        """As `Denoiser.filter`."""
        for _ in self.steps(film, guide):
            pass
        return self.result

    def steps(self, film: SplitFilm, guide: np.ndarray | None = None) -> Iterator[None]:
        """`filter` in small steps, for a window that handles input in between."""
        if not film.is_split:
            yield from self._wavelet.steps(film)
            self._result = self._wavelet.result
            return
        filtered = []
        for part in film.parts:
            part.develop()
            yield from self._wavelet.steps(part)
            filtered.append(read_texels(self._wavelet.result)[..., :3])
        whole, *parts = (_Part.of(each) for each in (film, *film.parts))
        alpha = read_texels(film.radiance)[..., 3:]
        denoised = self._thread.submit(_denoised, whole, parts, filtered, None if guide is None else guide[::-1])
        while not wait([denoised], _PAUSE_S).done:
            yield
        self._write(np.concatenate([denoised.result(), alpha], axis=-1))

    def _write(self, pixels: np.ndarray) -> None:
        self._context.make_current()
        size = pixels.shape[1], pixels.shape[0]
        if self._texture is None or self._texture.size != size:
            if self._texture is not None:
                self._texture.release()
            self._texture = self._context.gl.texture(size, 4, dtype="f4")
            self._texture.filter = moderngl.NEAREST, moderngl.NEAREST
        self._texture.write(np.ascontiguousarray(pixels, np.float32))
        self._result = self._texture

    def release(self) -> None:
        self._thread.shutdown(wait=False)
        self._wavelet.release()
        if self._texture is not None:
            self._texture.release()
        self._texture = self._result = None


@dataclass(frozen=True, eq=False)
class _Part:
    """Means over samples, (H, W, 3), and their number, (H, W, 1): radiance, emission of first hits, share of hits."""

    radiance: np.ndarray
    emission: np.ndarray
    hits: np.ndarray
    count: np.ndarray

    @classmethod
    def of(cls, film: NoisyFilm) -> _Part:
        total = read_texels(film.sum)
        count = np.maximum(total[..., 3:], 1)
        return cls(total[..., :3] / count, read_texels(film.emission)[..., :3] / count,
                   read_texels(film.albedo)[..., 3:] / count, total[..., 3:])


def _denoised(whole: _Part, parts: list[_Part], filtered: list[np.ndarray], guide: np.ndarray | None) -> np.ndarray:
    """(H, W, 3). Pixels above LARGEST stay as they are and, without a guide, those in which nothing is hit."""
    stays = np.zeros_like(whole.count, bool) if guide is not None else whole.hits == 0
    for part in (whole, *parts):
        stays |= (part.count == 0) | ~(np.abs(part.radiance).max(axis=-1, keepdims=True) < LARGEST)

    def light(radiance: np.ndarray, emission: np.ndarray) -> np.ndarray:
        return np.where(stays, 0, np.maximum(radiance - emission, 0)).astype(np.float32)

    samples = light(parts[0].radiance, parts[0].emission), light(parts[1].radiance, parts[1].emission)
    guides = [(light(filtered[0], parts[0].emission), light(filtered[1], parts[1].emission))]
    if guide is not None:
        clean = np.where(np.abs(guide) < LARGEST, guide, 0)
        guides.insert(0, (light(clean, whole.emission),) * 2)
    share = parts[0].count / np.maximum(whole.count, 1)
    picture = combined(samples, guides, share, whole.hits > 0)  # nothing is lost where nothing is hit
    return np.where(stays, whole.radiance, picture + whole.emission)
