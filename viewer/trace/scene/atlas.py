"""All texture images of a scene as pages of one texture, so that one program can read the maps of every material."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from dataclasses import dataclass
from functools import partial
from math import isqrt
from typing import Literal

import moderngl
import numpy as np

from ...base.counted import counted
from ...base.heap import trim_heap
from ...gpu.context import Context
from ...scene.color import srgb_to_linear
from ...scene.decoding import Decoder
from ...scene.mip_levels import mip_levels, without_hidden
from ...scene.texture_image import TextureImage

Page = tuple[int, int, int, int]
"""x, y, width, height in texels."""

MAX_TEXELS = 1 << 27
"""Most texels of an atlas. With eight bytes a texel that is 1 GiB, the most that drivers allow for one texture."""

_Format = Literal["light", "data", "deep"]
"""Colours as linear half floats; data of 8 bits or of 16."""

_DTYPES: dict[_Format, str] = {"light": "f2", "data": "f1", "deep": "nu2"}


@dataclass(frozen=True, eq=False)
class AtlasLayout:
    """`pages` has the place of each image, `halvings` the number of times that its sides are halved to fit."""

    size: tuple[int, int]
    pages: dict[TextureImage, Page]
    halvings: dict[TextureImage, int]

    @property
    def warnings(self) -> list[str]:
        """A line for the user if images are not at full size."""
        shrunk = sum(1 for n in self.halvings.values() if n)
        if not shrunk:
            return []
        return [f"{counted(shrunk, 'texture image')} traced at reduced size: all have to fit into one texture"]


class Atlas:
    """Begins at once to decode the images on other threads; `upload` waits for them.

    The alpha of `covering` images is coverage, and below 0 they get the colours of what is seen beside.
    """

    def __init__(self, context: Context, images: Iterable[TextureImage], is_srgb: bool,
                 covering: Collection[TextureImage] = ()) -> None:
        self._context = context
        self.layout = layout_atlas(images, context.gl.info["GL_MAX_TEXTURE_SIZE"])
        is_deep = any(image.bits == 16 for image in self.layout.pages)
        if is_srgb:
            # Linear half floats: texture units decode sRGB with an error of up to 0.5 % (NVIDIA) or 0.7 % (llvmpipe).
            self._format: _Format = "light"
        else:
            self._format = "deep" if is_deep else "data"
        keys = [(image, halvings, image in covering) for image, halvings in self.layout.halvings.items()]
        self._decoder = Decoder(keys, partial(_decode_page, format=self._format))

    def upload(self) -> moderngl.Texture:
        """The texture; row 0 of each page is the top of the image. Raises InputError for an image that is broken."""
        texture = self._context.gl.texture(self.layout.size, 4, dtype=_DTYPES[self._format])
        texture.filter = moderngl.NEAREST, moderngl.NEAREST
        for key, pixels in self._decoder.results():
            texture.write(pixels, viewport=self.layout.pages[key[0]])
            del pixels
            trim_heap()  # OpenGL has its own copy now
        return texture

    def cancel(self) -> None:
        """Stop decoding."""
        self._decoder.cancel()


def layout_atlas(images: Iterable[TextureImage], limit: int) -> AtlasLayout:
    """Places for `images` in a texture of at most `limit` texels a side.

    The largest images are halved until all fit.
    """
    images = list(dict.fromkeys(images))
    halvings = dict.fromkeys(images, 0)
    while True:
        sizes = [_halved(image, halvings[image]) for image in images]
        packed = _pack(sizes, limit)
        if packed is not None:
            size, corners = packed
            pages = {image: (*corner, *extent) for image, corner, extent in zip(images, corners, sizes)}
            return AtlasLayout(size, pages, halvings)
        largest = max(width * height for width, height in sizes)
        for image, (width, height) in zip(images, sizes):
            halvings[image] += width * height == largest


def _halved(image: TextureImage, times: int) -> tuple[int, int]:
    return max(image.width >> times, 1), max(image.height >> times, 1)


def _pack(sizes: list[tuple[int, int]], limit: int) -> tuple[tuple[int, int], list[tuple[int, int]]] | None:
    """The atlas's size and each rectangle's corner, for the one of several widths that needs the smallest area.

    None if no width fits.
    """
    if not sizes:
        return (1, 1), []
    widest, area = max(width for width, _ in sizes), sum(width * height for width, height in sizes)
    square = isqrt(area)
    widths = {widest * k for k in range(1, 9)} | {max(square, widest), max(square * 5 // 4, widest), limit}
    found = []
    for width in sorted(w for w in widths if widest <= w <= limit):
        corners = _skyline(sizes, width)
        used = max(x + w for (x, _), (w, _) in zip(corners, sizes))
        height = max(y + h for (_, y), (_, h) in zip(corners, sizes))
        if height <= limit and used * height <= MAX_TEXELS:
            found.append((used * height, max(used, height), (used, height), corners))
    return min(found, key=lambda f: f[:3])[2:] if found else None


def _skyline(sizes: list[tuple[int, int]], width: int) -> list[tuple[int, int]]:
    """Bottom-left packing into a strip: each rectangle, the tallest first, goes to its lowest place (Jylanki 2010)."""
    corners = [(0, 0)] * len(sizes)
    skyline = [(0, 0, width)]  # x, y, width: free from y upwards
    for k in sorted(range(len(sizes)), key=lambda k: (-sizes[k][1], -sizes[k][0])):
        w, h = sizes[k]
        y, x = min((_lowest_y(skyline, x, w), x) for x, _, _ in skyline if x + w <= width)
        corners[k] = x, y
        below = [(max(left, x + w), level, left + span - max(left, x + w)) for left, level, span in skyline
                 if left + span > x + w]
        before = [(left, level, min(span, x - left)) for left, level, span in skyline if left < x]
        skyline = [*before, (x, y + h, w), *below]
    return corners


def _lowest_y(skyline: list[tuple[int, int, int]], x: int, width: int) -> int:
    """The lowest y that a rectangle of `width` can have at x."""
    return max(level for left, level, span in skyline if left < x + width and left + span > x)


def _decode_page(image: TextureImage, halvings: int, covers: bool, format: _Format) -> np.ndarray:
    """The pixels of a page, (H, W, 4), in the format of the atlas."""
    pixels = image.decode()
    is_color, full = format == "light", np.iinfo(pixels.dtype).max
    count = pixels.shape[2]
    page = np.full((*pixels.shape[:2], 4), full, pixels.dtype)
    page[..., :3] = pixels[..., :3] if count >= 3 else pixels[..., :1]
    if count in (2, 4):
        page[..., 3] = pixels[..., -1]
    if format == "deep" and full == 255:
        page = page.astype(np.uint16) * 257
    if is_color and full == 65535:  # linear before it is halved
        page = _linear(page)
    if halvings or (covers and not page[..., 3].all()):
        levels = mip_levels(page, is_color and page.dtype == np.uint8, covers)
        page = (without_hidden(levels) if covers else levels)[halvings]
    return _linear(page) if is_color and page.dtype == np.uint8 else page


def _linear(page: np.ndarray) -> np.ndarray:
    """sRGB colours with alpha, of 8 or 16 bits, as linear half floats."""
    full = np.iinfo(page.dtype).max
    values = np.arange(full + 1) / full
    color, alpha = srgb_to_linear(values).astype(np.float16), values.astype(np.float16)
    out = np.empty(page.shape, np.float16)
    for channel in range(4):
        out[..., channel] = (alpha if channel == 3 else color).take(page[..., channel])
    return out
