"""Images decoded on other threads while this one does what needs OpenGL."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable, Iterable, Iterator
from queue import SimpleQueue
from typing import Any

import numpy as np

from ..scene.color import srgb_to_linear
from ..scene.mip_levels import mip_levels
from ..scene.texture_image import TextureImage

Key = tuple[TextureImage, str, bool]
"""An image, the channels of it that are read (R, RGB or RGBA), and whether its colours are sRGB."""

_THREADS = 2
_ROOM = 4
"""Images in work or waiting to be fetched, 17 MB each where they have 2048 texels a side."""


class Decoder:
    """Begins at once to decode `keys`, the largest first; `results` gives each when it is ready.

    A key begins with the image; `decode` makes of its parts what is asked for.
    """

    def __init__(self, keys: Iterable[tuple[Any, ...]], decode: Callable[..., Any] | None = None) -> None:
        self._decode = decode or decode_levels
        self._waiting = deque(sorted(keys, key=lambda key: -len(key[0].data)))
        self.keys = frozenset(self._waiting)
        self._ready: SimpleQueue[tuple[Any, Any]] = SimpleQueue()
        self._room = threading.Semaphore(_ROOM)
        for _ in range(min(_THREADS, len(self.keys))):
            threading.Thread(target=self._work, daemon=True).start()

    def results(self) -> Iterator[tuple[Any, Any]]:
        """Each key with what was made of it, by default its mip levels, once, in the order they become ready.

        Raises InputError for broken images.
        """
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
