"""The switches of a surface that follow from its alpha mode and from one of its maps."""

from __future__ import annotations

from ..scene.material import Texture
from ..scene.schema import MAP_SWITCHES

ALPHA_MODES = ("opaque", "mask", "blend")
"""In the order of the shaders' switch ALPHA_MODE."""


def map_switches(macro: str, texture: Texture | None) -> dict[str, int]:
    """The switches of a map, whose meaning is in shaders/raster/attributes.glsl. Shaders do mirrored repetition."""
    if texture is None:
        return {f"{macro}_{ending}": 0 for ending in MAP_SWITCHES}
    mirror = (texture.sampler.wrap_s == "mirror") | (texture.sampler.wrap_t == "mirror") << 1
    return {f"{macro}_MAP": 1, f"{macro}_UV": texture.uv_set, f"{macro}_TRANSFORM": int(texture.transform is not None),
            f"{macro}_MIRROR": mirror}
