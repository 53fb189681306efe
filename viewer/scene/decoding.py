"""Decodes images on other threads, while the calling thread uses OpenGL."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from queue import SimpleQueue
from typing import Any

import numpy as np

from ..scene.color import srgb_to_linear
from ..scene.mask_levels import MaskMap
from ..scene.mip_levels import mip_levels, without_hidden
from ..scene.normal_spread import with_spread
from ..scene.parameter import Encoding
from ..scene.sheen_levels import SheenMap
from ..scene.texture_image import TextureImage

Meaning = Encoding | SheenMap | MaskMap
"""What the numbers of an image are to a map, and to those beside it."""
Key = tuple[TextureImage, str, Meaning]
"""An image, the channels to read (R, RGB, RGBA, or RGBC where the fourth is coverage, and RGBCO where opaque surfaces
show what it hides elsewhere), and what they are."""

_THREADS = 2
_MAX_PENDING = 4
"""The most images that are being decoded or wait to be fetched. One of 2048 x 2048 texels takes 17 MB."""


class Decoder:
    """Begins at once to decode `keys`, the largest file first; `results` yields each when it is ready.

    A key is a tuple whose first element is the image. `decode(*key)` decodes it, by default `decode_levels`.
    """

    def __init__(self, keys: Iterable[tuple[Any, ...]], decode: Callable[..., Any] | None = None) -> None:
        self._decode = decode or decode_levels
        self._waiting = deque(sorted(keys, key=lambda key: -len(key[0].data)))
        self.keys = frozenset(self._waiting)
        self._ready: SimpleQueue[tuple[Any, Any]] = SimpleQueue()
        self._slots = threading.Semaphore(_MAX_PENDING)
        for _ in range(min(_THREADS, len(self.keys))):
            threading.Thread(target=self._work, daemon=True).start()

    def results(self) -> Iterator[tuple[Any, Any]]:
        """Yields each key once with its decoded image, by default the mip levels, in the order they become ready.

        Raises InputError for broken images.
        """
        for _ in self.keys:
            key, levels = self._ready.get()
            self._slots.release()
            if isinstance(levels, BaseException):
                self.cancel()
                raise levels
            yield key, levels
            del levels  # free the memory before waiting for the next image

    def cancel(self) -> None:
        """Start no further images."""
        self._waiting.clear()
        self._slots.release(_THREADS)

    def _work(self) -> None:
        while True:
            self._slots.acquire()
            try:
                key = self._waiting.popleft()
            except IndexError:
                return
            try:
                self._ready.put((key, self._decode(*key)))
            except BaseException as error:
                self._ready.put((key, error))


def encoding_of(meaning: Meaning) -> Encoding:
    """That of the numbers alone."""
    return meaning.encoding if isinstance(meaning, (SheenMap, MaskMap)) else meaning


def decode_levels(image: TextureImage, channels: str, meaning: Meaning) -> list[np.ndarray]:
    """The mip levels of `image`, (H, W, C) each, with the fewest channels that contain `channels`.

    They are uint8 (encoded as sRGB if the image is) or uint16. sRGB images with 16 bits are decoded to linear float16.
    Those of normals have a fourth channel for the spread of the normals (`with_spread`). Those of RGBC have the colours
    that are seen, those of a `SheenMap` what reflects as it does with the maps beside it, and those of a `MaskMap` the
    share that stands.
    """
    if meaning == "normal":
        return with_spread(mip_levels(image.decode("RGB")))
    is_srgb = encoding_of(meaning) == "srgb"
    pixels = _pixels(image, channels, is_srgb)
    if isinstance(meaning, SheenMap):
        return meaning.levels(pixels)
    if isinstance(meaning, MaskMap):
        return meaning.levels(pixels, is_srgb and pixels.dtype == np.uint8)
    levels = mip_levels(pixels, is_srgb and pixels.dtype == np.uint8, covers="C" in channels)
    return without_hidden(levels) if channels == "RGBC" else levels


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
    if srgb and pixels.shape[2] < 3:  # OpenGL has sRGB formats only for three and four channels
        grey, alpha = pixels[..., :1], pixels[..., 1:]
        pixels = np.concatenate([grey, grey, grey, alpha], axis=2)
    return pixels
