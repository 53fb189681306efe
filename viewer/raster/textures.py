"""Material maps on the GPU. An image is decoded when a plan first samples it, with only the channels that are read."""

from __future__ import annotations

import time

import moderngl
import numpy as np

from ..base.heap import trim_heap
from ..gpu.context import Context
from ..gpu.float_texture import float_texture
from ..gpu.mipmaps import mipmapped_texture
from ..plan.model import Draw, Plan
from ..scene.color import srgb_to_linear
from ..scene.decoding import Decoder, Key, Meaning, encoding_of
from ..scene.material import Sampler, Texture
from ..scene.parameter import WHITE
from ..scene.schema import MAPS
from ..scene.texture_image import TextureImage
from .sampled_images import channels_read, meaning_of, sampled_images

_FILTERS = {
    ("nearest", None): moderngl.NEAREST,
    ("linear", None): moderngl.LINEAR,
    ("nearest", "nearest"): moderngl.NEAREST_MIPMAP_NEAREST,
    ("linear", "nearest"): moderngl.LINEAR_MIPMAP_NEAREST,
    ("nearest", "linear"): moderngl.NEAREST_MIPMAP_LINEAR,
    ("linear", "linear"): moderngl.LINEAR_MIPMAP_LINEAR,
}
# With one or two channels the first is grey, which becomes red, green and blue, and the second is alpha.
_SWIZZLES = {1: "RRR1", 2: "RRRG", 3: "RGB1", 4: "RGBA"}


class Textures:
    """The textures of a scene's images. Textures of images that the next scene has too are kept."""

    def __init__(self, context: Context) -> None:
        self._context = context
        self._textures: dict[Key, moderngl.Texture] = {}
        self._blanks: dict[str, moderngl.Texture] = {}
        self._examples: dict[str, Key] = {}
        self._samplers: dict[Sampler, moderngl.Sampler] = {}
        self._decoders: list[Decoder] = []
        self._channels: dict[tuple[TextureImage, Meaning], str] = {}
        self._sizes: dict[Key, int] = {}
        self._means: dict[Key, np.ndarray] = {}
        self._normal_maps: set[TextureImage] = set()
        self._roots: dict[TextureImage, moderngl.Texture] = {}
        self.seconds = 0.0
        """Spent in `upload`, with waiting for decoders."""

    @property
    def bytes(self) -> int:
        """About how many bytes the textures take, with their mipmaps."""
        return sum(self._sizes.values())

    @property
    def grooved(self) -> frozenset[TextureImage]:
        """The normal maps of bases, of those uploaded, that are full of grooves (viewer/scene/normal_spread.py)."""
        return frozenset(self._roots)

    def keep(self, images: set[TextureImage], ahead: Decoder | None) -> None:
        """Release the textures of all images except `images`. `ahead` is a decoder that has already started with some
        of the new ones."""
        self._cancel()
        self._decoders = [ahead] if ahead is not None else []
        self._channels = {key: letters for key, letters in self._channels.items() if key[0] in images}
        self._examples = {name: key for name, key in self._examples.items() if key[0] in images}
        self._normal_maps &= images
        self._release_unread()

    def prefetch(self, plan: Plan) -> None:
        """Start decoding the images that `plan` samples on other threads, while this thread compiles shaders."""
        self._channels = channels_read(plan, self._channels)
        self._release_unread()
        for draw in plan.draws:
            for name in draw.maps:
                image, meaning = MAPS[name].texture(draw.surface).image, meaning_of(draw, name)
                if name == "normal" and image not in self._normal_maps:
                    self._normal_maps.add(image)
                    self._release_of(image)  # what a coat's map has not kept of its grooves
                self._examples.setdefault(name, (image, self._channels[image, meaning], meaning))
        known = set(self._textures).union(*(decoder.keys for decoder in self._decoders))
        self._decoders.append(Decoder(sampled_images(plan, self._channels) - known))

    def upload(self) -> None:
        """Upload all prefetched images as textures, in the order in which they are decoded."""
        started = time.perf_counter()
        while self._decoders:
            for key, levels in self._decoders.pop(0).results():
                if key not in self._textures:  # the texture may exist already, from an earlier scene
                    if levels[0].shape[2] > 4 and key[0] in self._normal_maps:
                        self._roots[key[0]] = mipmapped_texture(self._context, [level[..., 4:] for level in levels])
                    levels = [level[..., :4] for level in levels]
                    is_srgb = encoding_of(key[2]) == "srgb"
                    self._textures[key] = _upload(self._context, levels, is_srgb)
                    self._sizes[key] = sum(level.nbytes for level in levels)
                    self._means[key] = _mean(levels[-1], is_srgb)
                del levels
                trim_heap()  # OpenGL has its own copy now
        self.seconds += time.perf_counter() - started

    def mean(self, draw: Draw, name: str) -> np.ndarray:
        """The mean of a map of a draw: linear red, green and blue, and alpha, (4,) float64. A prefetched plan must
        sample the map."""
        return self._means[self._key(draw, name)]

    def bind(self, draw: Draw, name: str, unit: int) -> None:
        """Bind a map of a draw to a texture unit, with its sampler. A prefetched plan must sample the map."""
        self._textures[self._key(draw, name)].use(unit)
        self._sampler(MAPS[name].texture(draw.surface).sampler).use(unit)

    def _key(self, draw: Draw, name: str) -> Key:
        image, meaning = MAPS[name].texture(draw.surface).image, meaning_of(draw, name)
        return image, self._channels[image, meaning], meaning

    def bind_root(self, texture: Texture, unit: int) -> None:
        """Bind the square root of the covariance of a normal map that is among `grooved`."""
        self._roots[texture.image].use(unit)
        self._sampler(texture.sampler).use(unit)

    def bind_blank(self, name: str, unit: int) -> None:
        """Bind a texture of the map's neutral colour, for a map that a material does not have."""
        if name not in self._blanks:
            self._blanks[name] = self._blank(name)
        self._blanks[name].use(unit)
        self._sampler(Sampler()).use(unit)

    def _blank(self, name: str) -> moderngl.Texture:
        neutral = MAPS[name].info.neutral
        if neutral != WHITE:  # 8 bits cannot represent it exactly
            return float_texture(self._context.gl, np.float32([[neutral]]))
        # Use the format of the scene's maps: Mesa's software rasteriser compiles a program for each format it samples.
        srgb = MAPS[name].info.srgb
        key = self._examples.get(name)
        components = self._textures[key].components if key in self._textures else 3
        white = [np.full((side, side, components), 255, np.uint8) for side in (2, 1)]
        return _upload(self._context, white, srgb)

    def _sampler(self, sampler: Sampler) -> moderngl.Sampler:
        if sampler not in self._samplers:
            # The shader does mirrored repetition (map_uv); its coordinates are then in [0, 1].
            self._samplers[sampler] = self._context.gl.sampler(
                repeat_x=sampler.wrap_s == "repeat",
                repeat_y=sampler.wrap_t == "repeat",
                filter=(_FILTERS[sampler.min_filter, sampler.mip_filter], _FILTERS[sampler.mag_filter, None]),
            )
        return self._samplers[sampler]

    def _release_unread(self) -> None:
        """Release the textures that no map reads any more: their image or their set of channels is not in use."""
        self._release([key for key in self._textures if self._channels.get((key[0], key[2])) != key[1]])

    def _release_of(self, image: TextureImage) -> None:
        """Release the texture of a normal map, if there is one, so that its image is decoded again."""
        self._release([key for key in self._textures if key[0] is image and key[2] == "normal"])

    def _release(self, keys: list[Key]) -> None:
        for key in keys:
            self._textures.pop(key).release()
            del self._sizes[key], self._means[key]
            if key[2] == "normal" and key[0] in self._roots:
                self._roots.pop(key[0]).release()

    def _cancel(self) -> None:
        for decoder in self._decoders:
            decoder.cancel()

    def release(self) -> None:
        self._cancel()
        textures = *self._textures.values(), *self._roots.values(), *self._blanks.values()
        for thing in (*textures, *self._samplers.values()):
            thing.release()


def _upload(context: Context, levels: list[np.ndarray], srgb: bool) -> moderngl.Texture:
    texture = mipmapped_texture(context, levels, srgb and levels[0].dtype == np.uint8)
    components = levels[0].shape[2]
    if components < 3:
        texture.swizzle = _SWIZZLES[components]
    return texture


def _mean(level: np.ndarray, srgb: bool) -> np.ndarray:
    """Red, green, blue and alpha of the smallest level."""
    values = level.reshape(-1, level.shape[2]).astype(np.float64)
    if level.dtype.kind == "u":
        values /= np.iinfo(level.dtype).max
    colors = values[:, :3] if values.shape[1] > 2 else values[:, [0, 0, 0]]
    alpha = values[:, -1:] if values.shape[1] in (2, 4) else np.ones((len(values), 1))
    return np.concatenate([srgb_to_linear(colors) if srgb else colors, alpha], axis=1).mean(axis=0)
