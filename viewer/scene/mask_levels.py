"""Mip levels of the base colour of an alpha mask: their alpha is the share that alpha leaves standing.

A pixel that sees many texels sees the share of them whose alpha reaches the cutoff, and only their colours. The mean
alpha does not tell it: wires that cover a fifth of a fence have a mean below any usual cutoff, and would vanish. To
scale the alpha of each level until as many texels reach the cutoff as in the first (Castano 2010, "Computing Alpha
Mipmaps") keeps the share of the whole image, but not that of its parts; to keep it by dithering (Yuksel 2018, "Alpha
Distribution for Alpha Testing") draws texels, which flicker where they are smaller than pixels. The share itself says
what four samples of a pixel, or the pixels of a neighbourhood, shall cover (shaders/raster/alpha_mask.glsl).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .material import Material
from .mip_levels import mip_levels, without_hidden
from .parameter import Encoding

_STEPS = 100
"""Of cutoffs from 0 to 1. They may move, and the levels are not made anew for each frame."""
_OFFSETS = -0.375, -0.125, 0.125, 0.375
"""Of the points in a texel, 4 x 4 of them, at which interpolated alpha is compared with the cutoff."""
_BATCH = 1 << 16
"""Texels at a time, so that intermediate arrays stay in the processor's cache."""


@dataclass(frozen=True)
class MaskMap:
    """A base colour whose texels stand where their alpha is at least `cutoff`; `interpolates` alpha if it is seen
    near."""

    cutoff: float
    interpolates: bool
    encoding: Encoding = "srgb"

    def levels(self, pixels: np.ndarray, srgb: bool) -> list[np.ndarray]:
        """`pixels`, (H, W, 2 or 4) as `mip_levels` takes them, and all smaller levels. The first has the alpha that it
        had. Where nothing stands, colours are those of the next smaller level."""
        share = standing_share(pixels[..., -1], self.cutoff, self.interpolates)
        if (share[pixels[..., -1] == 0] > 0).any():  # a part of what stands has a colour that is hidden, mostly black
            pixels = without_hidden(mip_levels(pixels, srgb, covers=True))[0]
        standing = pixels.copy()
        standing[..., -1] = share
        return without_hidden([pixels, *mip_levels(standing, srgb, covers=True)[1:]])


def mask_map(name: str, material: Material) -> MaskMap | None:
    """How the levels of a material's map are made, if it is the base colour of a mask and has alpha and levels."""
    texture = material.base_color_texture
    if name != "base_color" or material.alpha_mode != "mask" or texture is None or not texture.image.has_alpha:
        return None
    factor = material.base_color[3]
    if texture.sampler.mip_filter is None or not 0 < material.alpha_cutoff <= factor:
        return None  # all stands, or nothing
    step = max(round(_STEPS * material.alpha_cutoff / factor), 1)
    return MaskMap(step / _STEPS, texture.sampler.mag_filter == "linear")


def standing_share(alpha: np.ndarray, cutoff: float, interpolates: bool = True) -> np.ndarray:
    """The share of each texel of (H, W) `alpha` in which it is at least `cutoff`, in its dtype: uint8, uint16 or
    floats. Beyond the border alpha goes on as it is there."""
    full = np.iinfo(alpha.dtype).max if alpha.dtype.kind == "u" else 1
    share = np.where(alpha >= cutoff * full, alpha.dtype.type(full), alpha.dtype.type(0))
    if not interpolates:
        return share
    around = np.pad(share, 1, mode="edge")
    differs = np.zeros(alpha.shape, bool)
    for row, column in np.ndindex(3, 3):
        differs |= around[row:row + alpha.shape[0], column:column + alpha.shape[1]] != share
    rows, columns = np.nonzero(differs)  # elsewhere the share is all or nothing
    for first in range(0, len(rows), _BATCH):
        part = slice(first, first + _BATCH)
        near = _neighbours(alpha, rows[part], columns[part]) * np.float32(1 / full)
        mean = _share(near, np.float32(cutoff))
        share[rows[part], columns[part]] = np.rint(mean * full) if alpha.dtype.kind == "u" else mean
    return share


def _neighbours(alpha: np.ndarray, rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """Alpha at N texels and around them, (3, 3, N) float32."""
    last_row, last_column = alpha.shape[0] - 1, alpha.shape[1] - 1
    near = np.empty((3, 3, len(rows)), np.float32)
    for i, j in np.ndindex(3, 3):
        near[i, j] = alpha[np.clip(rows + (i - 1), 0, last_row), np.clip(columns + (j - 1), 0, last_column)]
    return near


def _share(near: np.ndarray, cutoff: np.float32) -> np.ndarray:
    """The share of the points at which interpolated alpha is at least the cutoff, (N,) float32."""
    count = np.zeros(near.shape[2], np.float32)
    for across in _OFFSETS:
        beside = near[:, 1] + abs(across) * (near[:, 1 + int(np.sign(across))] - near[:, 1])
        for down in _OFFSETS:
            count += beside[1] + abs(down) * (beside[1 + int(np.sign(down))] - beside[1]) >= cutoff
    return count / len(_OFFSETS) ** 2
