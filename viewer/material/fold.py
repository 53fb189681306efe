"""Folds maps of one constant colour into the material's factors, so that they need neither texture nor sampler.

An image must be decoded to find whether it is constant, so only small images are tested. Decoding a large one before
the plan is made would cost more than it could save.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ..scene.color import srgb_to_linear
from ..scene.material import Material
from ..scene.schema import MAPS, Map, Value, multiplied_by
from ..scene.specular_glossiness import with_glossiness
from ..scene.texture_image import TextureImage

MAX_TEXELS = 64

RGBA = tuple[float, float, float, float]


def without_constant_maps(material: Material) -> Material:
    """An equal-looking material, in which maps of one colour are multiplied into the factors.

    A map with channels that multiply no factor is folded only if those channels are neutral. Normal maps and maps of
    anisotropy always stay, because 8 bits cannot represent their neutral directions exactly.
    """
    material = _without_constant_thickness(_without_constant_glossiness(material))
    changes: dict[str, Any] = {}
    for name, source in MAPS.items():
        if source.info.is_applied:
            continue
        texture = source.texture(material)
        color = constant_color(texture.image) if texture is not None else None
        parameters = multiplied_by(name)
        multiplying = "".join(p.map_and_channels[1] for p in parameters)
        others = [c for c in source.info.channels if c not in multiplying]
        if color is None or not _is_neutral(source, color, others):
            continue
        changes[f"{name}_texture"] = None
        for parameter in parameters:
            channels = _linear(source, color, parameter.map_and_channels[1])
            changes[parameter.name] = _times(getattr(material, parameter.name), channels)
    return replace(material, **changes) if changes else material


def _without_constant_glossiness(material: Material) -> Material:
    texture, source = material.specular_glossiness_texture, MAPS["specular_glossiness"]
    color = constant_color(texture.image) if texture is not None else None
    return material if color is None else with_glossiness(material, _linear(source, color, "RGBA"))


def _without_constant_thickness(material: Material) -> Material:
    """`material` whose film is as thick as its map says, if that is of one colour."""
    texture = material.iridescence_thickness_texture
    color = constant_color(texture.image) if texture is not None else None
    if color is None:
        return material
    low, high = material.iridescence_thickness_minimum, material.iridescence_thickness_maximum
    return replace(material, iridescence_thickness_texture=None,
                   iridescence_thickness_maximum=low + (high - low) * color[1])


def constant_color(image: TextureImage) -> RGBA | None:
    """The RGBA that all texels have, as stored and in [0, 1]; None if they differ or are too many to test."""
    return _decoded(image) if image.width * image.height <= MAX_TEXELS else None


@lru_cache(maxsize=256)
def _decoded(image: TextureImage) -> RGBA | None:
    pixels = image.decode("RGBA")
    texels = pixels.reshape(-1, 4)
    return tuple((texels[0] / np.iinfo(pixels.dtype).max).tolist()) if (texels == texels[0]).all() else None


def _is_neutral(source: Map, color: RGBA, channels: Iterable[str]) -> bool:
    return all(color["RGBA".index(c)] == source.info.neutral["RGBA".index(c)] for c in channels)


def _linear(source: Map, color: RGBA, channels: str) -> tuple[float, ...]:
    """The values of `channels`, in linear light; the alpha of an sRGB map is linear already."""
    values = dict(zip("RGBA", color, strict=True))
    if source.info.srgb:
        values |= zip("RGB", srgb_to_linear(np.array(color[:3])).tolist(), strict=True)
    return tuple(values[c] for c in channels)


def _times(factor: Value, channels: tuple[float, ...]) -> Value:
    if isinstance(factor, tuple):
        return tuple(a * b for a, b in zip(factor, channels, strict=True))
    return factor * channels[0]
