"""Mip levels of the maps of a cloth that reflect what its texels do: its sheen, and the base that shows below.

A pixel that sees many texels sees the mean of what they reflect, not what their mean colour and roughness would. Fibres
of the colour c reflect c E(r), and let T = 1 - max(c) E(r) through to the base (shaders/bsdf/layer/sheen.glsl). So each
level has

    roughness  r' = mean(w r) / mean(w), where w is the sum of the channels of c E(r)
    colour     c' = mean(c E(r)) / E(r')
    base       b' = mean(T b) / mean(T)

with E the mean of the directional albedo of Charlie's lobe over all views. Smooth fibres reflect little, so that their
roughness counts little, too.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from typing import Literal, cast

import numpy as np

from .color import srgb_to_linear
from .material import RGB, SHEEN, Material
from .mip_levels import even_bands, means_of_four, mip_levels, srgb_codes
from .parameter import Encoding
from .schema import MAPS
from .texture_image import TextureImage

Name = Literal["base_color", "sheen_color", "sheen_roughness"]

_SMOOTHEST = 0.2  # CHARLIE_SMOOTHEST of shaders/bsdf/charlie.glsl
_NONE = np.float32(1e-6)
"""The weight of texels without sheen: where there are no others, their roughness is averaged as it is."""
_STEPS = 8
"""Of factors, rounded up. They may move, and the levels are not made anew for each frame."""


@dataclass(frozen=True)
class SheenMap:
    """One of the maps of a material whose sheen has maps, all of which lie alike on the surface.

    `color` is the image of the colour of its fibres, and `roughness` that of their roughness, if there is one. The
    factors multiply them.
    """

    name: Name
    color: TextureImage
    roughness: TextureImage | None
    color_factor: RGB
    roughness_factor: float

    @property
    def encoding(self) -> Encoding:
        return MAPS[self.name].info.encoding

    def levels(self, pixels: np.ndarray) -> list[np.ndarray]:
        """`pixels` of this map, (H, W, C) uint8, uint16 or, of sRGB images with 16 bits, linear float16, and all
        smaller levels. Channels that the map does not read are averaged as they are."""
        is_coded = self.encoding == "srgb" and pixels.dtype == np.uint8
        levels = mip_levels(pixels, is_coded)
        first = 0 if self.name != "sheen_roughness" else 3 if pixels.shape[2] == 4 else 1
        for level, values in zip(levels[1:], self._values(pixels)):
            if is_coded:
                values = srgb_codes(np.minimum(values, 1))
            elif level.dtype.kind == "u":
                values = np.rint(np.minimum(values, 1) * np.iinfo(level.dtype).max)
            level[..., first:first + values.shape[2]] = values
        return levels

    def _values(self, pixels: np.ndarray) -> Iterator[np.ndarray]:
        """Those of the map, (H, W, 1 or 3) float32, in all levels but the first."""
        color, roughness = self.color.decode("RGB"), self._codes_of_roughness()
        means = np.concatenate([means_of_four(self._products(pixels[rows], color[rows], roughness[rows]))
                                for rows in even_bands(pixels)])
        while True:
            yield self._of_means(means)
            if max(means.shape[:2]) == 1:
                return
            means = means_of_four(means)

    def _codes_of_roughness(self) -> np.ndarray:
        if self.roughness is None:
            return np.full((self.color.height, self.color.width, 1), 255, np.uint8)
        return self.roughness.decode("RGBA")[..., 3:]

    def _products(self, pixels: np.ndarray, color: np.ndarray, roughness: np.ndarray) -> np.ndarray:
        """What is averaged, (H, W, 4) float32."""
        rough = np.float32(self.roughness_factor) * _numbers(roughness)
        sheen = _light(color) * np.array(self.color_factor, np.float32) * mean_albedo(rough)
        if self.name == "base_color":
            passed = 1 - sheen.max(axis=2, keepdims=True)
            base = _light(pixels[..., :3]) if pixels.dtype.kind == "u" else pixels[..., :3].astype(np.float32)
            return np.concatenate([passed * base, passed], axis=2)
        return np.concatenate([sheen, (sheen.sum(axis=2, keepdims=True) + _NONE) * rough], axis=2)

    def _of_means(self, means: np.ndarray) -> np.ndarray:
        first, last = means[..., :3], means[..., 3:]
        if self.name == "base_color":
            return first / np.maximum(last, _NONE)
        rough = last / (first.sum(axis=2, keepdims=True) + _NONE)
        if self.name == "sheen_roughness":
            return rough / np.float32(self.roughness_factor)
        return np.minimum(first / np.maximum(mean_albedo(rough) * np.array(self.color_factor, np.float32), _NONE), 1)


def sheen_map(name: str, material: Material) -> SheenMap | None:
    """The map of a material that has a sheen, if its levels depend on the maps of that.

    None where they do not: the fibres have no map of their colour, or no roughness, without which they reflect nothing;
    a map of as many texels does not lie on the surface as they do; or a base colour has alpha, which weighs it.
    """
    color, roughness = material.sheen_color_texture, material.sheen_roughness_texture
    if roughness is not None and not roughness.image.has_alpha:  # which it is in
        roughness = None
    if name not in ("base_color", "sheen_color", "sheen_roughness") or not SHEEN.is_on(material) or color is None:
        return None
    if material.sheen_roughness == 0:
        return None
    if material.alpha_mode != "opaque" if name == "base_color" else roughness is None:
        return None
    textures = [t for t in (color, roughness, MAPS[name].texture(material)) if t is not None]
    places = {(t.image.width, t.image.height, t.uv_set, t.transform, t.sampler.wrap_s, t.sampler.wrap_t)
              for t in textures}
    if len(places) > 1:
        return None
    red, green, blue = (_in_steps(factor) for factor in material.sheen_color)
    return SheenMap(cast(Name, name), color.image, roughness.image if roughness else None, (red, green, blue),
                    _in_steps(material.sheen_roughness))


def mean_albedo(perceptual_roughness: np.ndarray) -> np.ndarray:
    """The mean of E over all views, by the cosine: a cubic, within 0.0015 of that of charlie_albedo in
    shaders/bsdf/charlie.glsl."""
    r = np.maximum(perceptual_roughness, np.float32(_SMOOTHEST))
    cubic = ((-0.527893 * r + 0.888199) * r - 0.093653) * r + 0.035681
    return cubic * np.minimum(perceptual_roughness / np.float32(_SMOOTHEST), 1)


def _in_steps(factor: float) -> float:
    return math.ceil(factor * _STEPS) / _STEPS


def _numbers(codes: np.ndarray) -> np.ndarray:
    return codes.astype(np.float32) / np.iinfo(codes.dtype).max


def _light(codes: np.ndarray) -> np.ndarray:
    return _table(np.iinfo(codes.dtype).max).take(codes)


@cache
def _table(full: int) -> np.ndarray:
    return srgb_to_linear(np.arange(full + 1) / full).astype(np.float32)
