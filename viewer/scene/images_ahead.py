"""Decodes the images of a model on another thread before the model is read, while modules are imported.

Importing keeps one core busy, about as long as decoding does. Pillow lets other threads of Python go on meanwhile.
"""

from __future__ import annotations

import io
import threading
from collections.abc import Iterator
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path

from PIL import Image

from ..base.quiet import without_warnings

_MOST_BYTES = {".gltf": 1 << 20, ".glb": 1 << 26}
"""Of the files that are read ahead, by their endings. It takes long to read a larger one twice."""
_MOST_TEXELS = 1 << 25
"""Of all images together; decoded they take 128 MB."""
_FORMATS = ("JPEG", "PNG")

_ahead: dict[bytes, Future[Image.Image]] = {}
"""By the content of the file."""


def decode_images_ahead(model: str) -> threading.Thread:
    """Begin to decode the images of a glTF file. What is wrong with it, or too large, is left to whoever reads it.

    Returns the thread that does it.
    """
    thread = threading.Thread(target=_decode_all, args=(Path(model),), daemon=True)
    thread.start()
    return thread


def forget_images_ahead() -> None:
    """Free the images that nobody has asked for, and decode no more of them."""
    for data in list(_ahead):
        if (future := _ahead.pop(data, None)) is not None:
            future.cancel()


def load_image(data: bytes, format: str) -> Image.Image:
    """The decoded image of a file in one of Pillow's formats. Raises what Pillow raises for a broken one."""
    future = _ahead.pop(data, None)
    if future is not None and not future.cancel():
        return future.result()
    return _loaded(Image.open(io.BytesIO(data), formats=(format,)))


def _decode_all(model: Path) -> None:
    with suppress(Exception), without_warnings():
        begun: list[tuple[Image.Image, Future[Image.Image]]] = []
        texels = 0
        different = dict.fromkeys(_image_files(model))  # some files hold an image twice
        for data in sorted(different, key=len, reverse=True):
            with suppress(Exception):  # other images are none the worse for a broken one
                opened = Image.open(io.BytesIO(data), formats=_FORMATS)
                texels += opened.width * opened.height
                if texels > _MOST_TEXELS:
                    break
                if opened.format == "JPEG" or data[24] == 8:  # of PNGs the depth; Pillow does not decode all of 16 bits
                    future = _ahead[data] = Future()
                    begun.append((opened, future))
        for image, future in begun:
            if future.set_running_or_notify_cancel():
                try:
                    future.set_result(_loaded(image))
                except Exception as error:  # it is raised where the image is asked for
                    future.set_exception(error)


def _image_files(model: Path) -> Iterator[bytes]:
    """The images of a glTF file that lie beside it or in its binary chunk."""
    from .files import path_inside, read_file
    from .gltf.container import read_container

    if model.stat().st_size > _MOST_BYTES[model.suffix.lower()]:
        return
    root, binary, _ = read_container(model, read_file(model))
    for image in root["images"]:
        if "bufferView" in image and binary is not None:
            view = root["bufferViews"][image["bufferView"]]
            start = view.get("byteOffset", 0)
            yield bytes(binary[start:start + view["byteLength"]])
        elif not image["uri"].startswith("data:"):
            yield read_file(path_inside(model, image["uri"], "images"))


def _loaded(image: Image.Image) -> Image.Image:
    image.decodermaxblock = 1 << 30  # type: ignore[attr-defined]  # for each block it would wait for other threads
    image.load()
    return image
