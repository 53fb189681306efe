"""Material maps on the GPU: decoded when first sampled, only in the channels that are read, each image once."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor

import moderngl
import numpy as np

from ..gpu.context import Context
from ..gpu.mipmaps import mipmapped_texture
from ..plan import MAPS, Plan, material_map
from ..scene.color import srgb_to_linear
from ..scene.material import Sampler, Texture
from ..scene.scene import Scene
from ..scene.texture_image import TextureImage
from .mip_levels import mip_levels

_FILTERS = {
    ("nearest", None): moderngl.NEAREST,
    ("linear", None): moderngl.LINEAR,
    ("nearest", "nearest"): moderngl.NEAREST_MIPMAP_NEAREST,
    ("linear", "nearest"): moderngl.LINEAR_MIPMAP_NEAREST,
    ("nearest", "linear"): moderngl.NEAREST_MIPMAP_LINEAR,
    ("linear", "linear"): moderngl.LINEAR_MIPMAP_LINEAR,
}
# Grey stands for red, green and blue; alpha is last.
_SWIZZLES = {1: "RRR1", 2: "RRRG", 3: "RGB1", 4: "RGBA"}

Key = tuple[int, str, bool]


class Textures:
    """The textures of one scene."""

    def __init__(self, context: Context, scene: Scene) -> None:
        self._context, self._scene = context, scene
        self._textures: dict[Key, moderngl.Texture] = {}
        self._samplers: dict[Sampler, moderngl.Sampler] = {}
        self._decoding: dict[Key, Future[list[np.ndarray]]] = {}
        self._channels: dict[tuple[int, bool], str] = {}
        self._bytes = 0

    def prefetch(self, plan: Plan) -> None:
        """Begin to decode what `plan` samples, on other threads, while shaders compile on this one."""
        self._note_channels(plan)
        wanted = {}
        for draw in plan.draws:
            for name in draw.maps:
                texture = material_map(self._scene.materials[draw.material], name)
                key = self._key(texture.image, MAPS[name])
                if key not in self._textures and key not in self._decoding:
                    wanted[key] = texture.image
        if wanted:
            pool = ThreadPoolExecutor(2)
            for key, image in wanted.items():
                self._decoding[key] = pool.submit(_decode, image, key[1], key[2])
            pool.shutdown(wait=False)

    def bind(self, texture: Texture, name: str, unit: int) -> None:
        """Bind a material's map to a texture unit with its sampler."""
        self._texture(texture.image, MAPS[name]).use(unit)
        self._sampler(texture.sampler).use(unit)

    @property
    def bytes(self) -> int:
        """About what the textures take, with their mipmaps."""
        return self._bytes

    def _note_channels(self, plan: Plan) -> None:
        """Which channels of each image some map reads, in this plan or one before.

        An image used twice (occlusion and roughness) is stored once.
        """
        reads: dict[tuple[int, bool], set[str]] = {key: set(channels) for key, channels in self._channels.items()}
        for draw in plan.draws:
            material = self._scene.materials[draw.material]
            for name in draw.maps:
                wanted = _CHANNELS[name]
                if name == "base_color" and material.alpha_mode == "opaque":
                    wanted = "RGB"
                image = material_map(material, name).image
                reads.setdefault((id(image), MAPS[name]), set()).update(wanted)
        self._channels |= {key: "R" if letters == {"R"} else "RGBA" if "A" in letters else "RGB"
                           for key, letters in reads.items()}

    def _key(self, image: TextureImage, srgb: bool) -> Key:
        return id(image), self._channels[id(image), srgb], srgb

    def _texture(self, image: TextureImage, srgb: bool) -> moderngl.Texture:
        key = self._key(image, srgb)
        if key not in self._textures:
            decoding = self._decoding.pop(key, None)
            levels = decoding.result() if decoding else _decode(image, *key[1:])
            self._textures[key] = _upload(self._context, levels, srgb)
            self._bytes += sum(level.nbytes for level in levels)
        return self._textures[key]

    def _sampler(self, sampler: Sampler) -> moderngl.Sampler:
        if sampler not in self._samplers:
            # Mirrored repetition is folded in the shader (map_uv), where [0, 1] is all that is left.
            self._samplers[sampler] = self._context.gl.sampler(
                repeat_x=sampler.wrap_s == "repeat",
                repeat_y=sampler.wrap_t == "repeat",
                filter=(_FILTERS[sampler.min_filter, sampler.mip_filter], _FILTERS[sampler.mag_filter, None]),
            )
        return self._samplers[sampler]

    def release(self) -> None:
        for future in self._decoding.values():
            future.cancel()
        for thing in (*self._textures.values(), *self._samplers.values()):
            thing.release()


_CHANNELS = {
    "base_color": "RGBA", "metallic_roughness": "GB", "normal": "RGB", "occlusion": "R",
    "emissive": "RGB", "specular": "A", "specular_color": "RGB",
}


def _decode(image: TextureImage, channels: str, srgb: bool) -> list[np.ndarray]:
    """The mip levels, (H, W, C), in the least channels that hold what is read."""
    pixels = _pixels(image, channels, srgb)
    return mip_levels(pixels, srgb and pixels.dtype == np.uint8)


def _pixels(image: TextureImage, channels: str, srgb: bool) -> np.ndarray:
    """uint8, uint16, or float16, linear then, where sRGB has 16 bits."""
    if channels == "R":
        return image.decode("R")
    pixels = image.decode()
    if channels == "RGB" and pixels.shape[2] == 4:
        pixels = np.ascontiguousarray(pixels[..., :3])
    if srgb and pixels.dtype == np.uint16:
        linear = pixels / 65535.0
        color = slice(None) if pixels.shape[2] in (1, 3) else slice(None, -1)
        linear[..., color] = srgb_to_linear(linear[..., color])
        return linear.astype(np.float16)
    if srgb and pixels.shape[2] < 3:  # OpenGL's sRGB formats have three colours
        grey, alpha = pixels[..., :1], pixels[..., 1:]
        pixels = np.concatenate([grey, grey, grey, alpha], axis=2)
    return pixels


def _upload(context: Context, levels: list[np.ndarray], srgb: bool) -> moderngl.Texture:
    texture = mipmapped_texture(context, levels, srgb and levels[0].dtype == np.uint8)
    components = levels[0].shape[2]
    if components < 3:
        texture.swizzle = _SWIZZLES[components]
    return texture
