"""Denoising of path-traced pictures. A denoised picture is not a measurement: its file is labelled, and no error figure
or golden image is made of it."""

from __future__ import annotations

from typing import Protocol

import moderngl

from ...errors import UsageError
from ...gpu.context import Context
from ...gpu.programs import Programs


class NoisyFilm(Protocol):
    """The textures that a denoiser reads, RGBA32F and of one size. Sums are over the samples of a pixel."""

    @property
    def sum(self) -> moderngl.Texture:
        """Sum of radiance, and the number of samples."""

    @property
    def squares(self) -> moderngl.Texture:
        """Sum of the squares of radiance, and of alpha."""

    radiance: moderngl.Texture
    """The noisy picture: mean radiance with associated alpha."""
    albedo: moderngl.Texture
    """Sum of the albedo of the first hits, and the number of hits."""
    normal: moderngl.Texture
    """Sum of the shading normals of the first hits, and of their depth."""
    emission: moderngl.Texture
    """Sum of the emission of the first hits. It has no noise except at edges, so it is subtracted before the filter and
    added after it. w: how many of the first hits were collisions in media."""


class Denoiser(Protocol):
    """Filters films of any size, one at a time."""

    def filter(self, film: NoisyFilm) -> moderngl.Texture:
        """The denoised picture, RGBA32F, in a texture that the denoiser owns and that is valid until the next call.

        Pixels without hits, and alpha, are unchanged.
        """

    def release(self) -> None: ...


def make_denoiser(context: Context, programs: Programs, kind: str) -> Denoiser:
    """The denoiser of `Settings.denoise`, fast or oidn. Raises UsageError if that one is not installed, or for raster,
    which is no filter of one film (viewer/estimate/mixture.py)."""
    if kind == "raster":
        raise UsageError("denoise raster is for pictures of render: here the raster draws nothing")
    if kind == "oidn":
        from .oidn import OpenImageDenoise

        return OpenImageDenoise(context)
    from .wavelet import Wavelet

    return Wavelet(context, programs)
