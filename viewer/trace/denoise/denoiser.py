"""Denoising of path-traced pictures. A denoised picture is not a measurement: its file is labelled, and no error figure
or golden image is made of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

import moderngl
import numpy as np

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


    def develop(self) -> None:
        """Compute `radiance`."""


class SplitFilm(NoisyFilm, Protocol):
    """A film that may have its samples in two parts, too."""

    @property
    def is_split(self) -> bool:
        """Whether it has, with samples in both everywhere."""

    @property
    def parts(self) -> Sequence[NoisyFilm]: ...


class Denoiser(Protocol):
    """Filters films of any size, one at a time."""

    def filter(self, film: SplitFilm, guide: np.ndarray | None = None) -> moderngl.Texture:
        """The denoised picture, RGBA32F, in a texture that the denoiser owns and that is valid until the next call.

        `guide` is a picture without noise that shows about the same, linear radiance (H, W, 3) with row 0 at the top.
        Only `raster` has one. Without it pixels without hits are unchanged, and alpha is in any case; but
        `oidn` filters both about media.
        """

    def release(self) -> None: ...


def make_denoiser(context: Context, programs: Programs, kind: str) -> Denoiser:
    """The denoiser of `Settings.denoise`, but off. Raises UsageError if it is not installed."""
    if kind == "oidn":
        from .oidn import OpenImageDenoise

        return OpenImageDenoise(context)
    from .fast import Combining

    return Combining(context, programs)
