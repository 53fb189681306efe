"""Images decoded on other threads while this one does what needs OpenGL."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from queue import SimpleQueue
from typing import Any

import numpy as np

from ..material.maps import CHANNELS, MAPS, material_map
from ..plan.planner import Plan, plan_scene
from ..scene.color import srgb_to_linear
from ..scene.mip_levels import mip_levels
from ..scene.scene import Scene
from ..scene.texture_image import TextureImage
from ..settings import Settings

Key = tuple[TextureImage, str, bool]
"""An image, the channels of it that are read (R, RGB or RGBA), and whether its colours are sRGB."""

_THREADS = 2
_ROOM = 4
"""Images in work or waiting to be fetched, 17 MB each where they have 2048 texels a side."""


class Decoder:
    """Begins at once to decode `keys`, the largest first; `results` gives each when it is ready.

    A key begins with the image; `decode` makes of its parts what is asked for.
    """

    def __init__(self, keys: Iterable[Key], decode: Callable[..., Any] | None = None) -> None:
        self._decode = decode or decode_levels
        self._waiting = deque(sorted(keys, key=lambda key: -len(key[0].data)))
        self.keys = frozenset(self._waiting)
        self._ready: SimpleQueue[tuple[Key, list[np.ndarray] | BaseException]] = SimpleQueue()
        self._room = threading.Semaphore(_ROOM)
        for _ in range(min(_THREADS, len(self.keys))):
            threading.Thread(target=self._work, daemon=True).start()

    def results(self) -> Iterator[tuple[Key, list[np.ndarray]]]:
        """Each key with its mip levels, once, in the order they become ready. Raises InputError for broken images."""
        for _ in self.keys:
            key, levels = self._ready.get()
            self._room.release()
            if isinstance(levels, BaseException):
                self.cancel()
                raise levels
            yield key, levels
            del levels  # before the next one is waited for

    def cancel(self) -> None:
        """Begin no more."""
        self._waiting.clear()
        self._room.release(_THREADS)

    def _work(self) -> None:
        while True:
            self._room.acquire()
            try:
                key = self._waiting.popleft()
            except IndexError:
                return
            try:
                self._ready.put((key, self._decode(*key)))
            except BaseException as error:
                self._ready.put((key, error))


def decode_ahead(scene: Scene, settings: Settings) -> Decoder:
    """Begin with the images that a picture of `scene` will sample, before there is a context to draw it with."""
    # Which maps are sampled depends neither on the target nor on the lights.
    plan = plan_scene(scene, settings, (), samples=1, half_target=False, orthographic=False)
    return Decoder(sampled_images(scene, plan, channels_read(scene, plan, {})))


def channels_read(
    scene: Scene, plan: Plan, before: Mapping[tuple[TextureImage, bool], str]
) -> dict[tuple[TextureImage, bool], str]:
    """The channels of each image that some map reads, in this plan or `before`: R, RGB or RGBA.

    An image used twice (occlusion and roughness) is stored once.
    """
    reads = {image: set(channels) for image, channels in before.items()}
    for draw in plan.draws:
        material = scene.materials[draw.material]
        for name in draw.maps:
            opaque = name == "base_color" and material.alpha_mode == "opaque"
            image = material_map(material, name).image
            reads.setdefault((image, MAPS[name]), set()).update("RGB" if opaque else CHANNELS[name])
    return {image: "R" if letters == {"R"} else "RGBA" if "A" in letters else "RGB"
            for image, letters in reads.items()}


def sampled_images(scene: Scene, plan: Plan, channels: Mapping[tuple[TextureImage, bool], str]) -> set[Key]:
    """What has to be decoded for `plan`, given what `channels_read` says."""
    images = {(material_map(scene.materials[draw.material], name).image, MAPS[name])
              for draw in plan.draws for name in draw.maps}
    return {(image, channels[image, srgb], srgb) for image, srgb in images}


def decode_levels(image: TextureImage, channels: str, srgb: bool) -> list[np.ndarray]:
    """The mip levels, (H, W, C), in the least channels that hold what is read.

    uint8 (sRGB if asked for), uint16, or where sRGB has 16 bits float16, linear.
    """
    pixels = _pixels(image, channels, srgb)
    return mip_levels(pixels, srgb and pixels.dtype == np.uint8)


def _pixels(image: TextureImage, channels: str, srgb: bool) -> np.ndarray:
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
