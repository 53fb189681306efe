"""Taking the noise out of a path-traced picture. What comes out is no measurement: it is labelled, and no error figure
or golden image is made of it."""

from __future__ import annotations

from typing import Protocol

import moderngl

from ...gpu.context import Context
from ...gpu.programs import Programs


class NoisyFilm(Protocol):
    """The textures a denoiser looks at, RGBA32F and of one size; sums are over the samples of a pixel."""

    radiance: moderngl.Texture
    """The picture: mean radiance with associated alpha."""
    sum: moderngl.Texture
    """Radiance, and the number of samples."""
    squares: moderngl.Texture
    albedo: moderngl.Texture
    """The first hits' reflectance, and how many there were."""
    normal: moderngl.Texture
    """The first hits' shading normals, and their depth."""
    emission: moderngl.Texture
    """What the first hits shine by themselves: without noise but for the edges, so it is left out and put back."""


class Denoiser(Protocol):
    """Filters films, one after the other, of any size."""

    def filter(self, film: NoisyFilm) -> moderngl.Texture:
        """The picture without noise, RGBA32F, in a texture of the denoiser's own, valid until the next call.

        Pixels where nothing was hit, and alpha, are as they were.
        """

    def release(self) -> None: ...


def make_denoiser(context: Context, programs: Programs, kind: str) -> Denoiser:
    """The denoiser of `Settings.denoise`, fast or oidn. Raises UsageError where that one is not installed."""
    if kind == "oidn":
        from .oidn import OpenImageDenoise

        return OpenImageDenoise(context)
    from .wavelet import Wavelet

    return Wavelet(context, programs)
