"""Maps of one colour: multiplied into the material's factors, they need neither texture nor sampler.

Which images they are is told by decoding them, so only small ones are looked at: a larger one costs more to decode
before the plan is made than it could save.
"""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache
from typing import Any

import numpy as np

from ..errors import InputError
from ..scene.color import srgb_to_linear
from ..scene.material import Material
from ..scene.texture_image import TextureImage

MOST_TEXELS = 64


def without_constant_maps(material: Material) -> Material:
    """`material` as it looks, with those of its maps that have one colour in its factors.

    Normal maps stay, for 8 bits cannot hold a normal that leans nowhere, and so does an occlusion that is not 1, which
    has no factor.
    """
    found = {name: _color(material, name) for name in _FACTORS}
    changes: dict[str, Any] = {}
    for name, color in found.items():
        if color is not None:
            changes |= {f"{name}_texture": None} | _FACTORS[name](material, color)
    return replace(material, **changes) if changes else material


def constant_color(image: TextureImage) -> tuple[float, float, float, float] | None:
    """The RGBA of all texels, as stored and in [0, 1]; None where they differ or are too many to look at."""
    return _decoded(image) if image.width * image.height <= MOST_TEXELS else None


@lru_cache(maxsize=256)
def _decoded(image: TextureImage) -> tuple[float, float, float, float] | None:
    try:
        pixels = image.decode("RGBA")
    except InputError:
        return None  # whoever needs it will say so
    texels = pixels.reshape(-1, 4)
    return tuple((texels[0] / np.iinfo(pixels.dtype).max).tolist()) if (texels == texels[0]).all() else None


def _color(material: Material, name: str) -> tuple[float, float, float, float] | None:
    texture = getattr(material, f"{name}_texture")
    color = constant_color(texture.image) if texture is not None else None
    return None if name == "occlusion" and color is not None and color[0] < 1 else color


def _times(factor: tuple[float, ...], color: tuple[float, ...]) -> tuple[float, ...]:
    """A factor, RGB or RGBA, times an sRGB colour, whose alpha is linear."""
    linear = [*srgb_to_linear(np.array(color[:3])).tolist(), color[3]]
    return tuple(a * b for a, b in zip(factor, linear))


_FACTORS = {
    "base_color": lambda m, c: {"base_color": _times(m.base_color, c)},
    "metallic_roughness": lambda m, c: {"perceptual_roughness": m.perceptual_roughness * c[1],
                                        "metallic": m.metallic * c[2]},
    "occlusion": lambda m, c: {},
    "emissive": lambda m, c: {"emissive": _times(m.emissive, c)},
    "specular": lambda m, c: {"specular": m.specular * c[3]},
    "specular_color": lambda m, c: {"specular_color": _times(m.specular_color, c)},
    "transmission": lambda m, c: {"transmission": m.transmission * c[0]},
    "thickness": lambda m, c: {"thickness": m.thickness * c[1]},
}
