"""glTF's images, samplers and textures."""

from __future__ import annotations

from dataclasses import replace

from ...errors import InputError
from .. import ktx2
from ..files import OutsideError
from ..material import Filter, Sampler, Texture, UVTransform, Wrap
from ..parameter import RGBA
from ..texture_image import TextureImage, open_texture_image
from .buffers import Buffers, read_uri
from .element import Element

_WRAPS: dict[int, Wrap] = {33071: "clamp", 33648: "mirror", 10497: "repeat"}
_MAG_FILTERS: dict[int, Filter] = {9728: "nearest", 9729: "linear"}
_MIN_FILTERS: dict[int, tuple[Filter, Filter | None]] = {
    9728: ("nearest", None), 9729: ("linear", None), 9984: ("nearest", "nearest"), 9985: ("linear", "nearest"),
    9986: ("nearest", "linear"), 9987: ("linear", "linear")}
MAX_UV_SETS = 2
BASISU = "KHR_texture_basisu"
IMAGE_EXTENSIONS = (BASISU, "EXT_texture_avif", "EXT_texture_webp")
"""Each names an image in a format of its own, beside one for readers without the extension."""


class Textures:
    """The file's textures. An image is opened when a used material first refers to it; textures share images."""

    def __init__(self, root: Element, buffers: Buffers) -> None:
        self._textures, self._samplers = root.array("textures"), root.array("samplers")
        self._images = root.array("images")
        self._buffers = buffers
        self.opened: dict[int, TextureImage] = {}
        self._otherwise_neutral: dict[tuple[int, RGBA], TextureImage] = {}
        self._lost: set[int] = set()

    def read(self, owner: Element, key: str, neutral: RGBA) -> Texture | None:
        """The texture of the texture info at `owner.key`; None if there is none, or, with a warning, if it cannot be
        used.

        If its image turns out to be broken when it is decoded, `neutral` is the colour of all texels.
        """
        if key not in owner:
            return None
        info = owner.object(key)
        texture = self._textures[info.index("index", len(self._textures))]
        source = self._image_index(texture)
        if source is None:
            return None
        uv_set = info.integer("texCoord", 0)
        transform = None
        extension = info.extension("KHR_texture_transform")
        if extension is not None:
            uv_set = extension.integer("texCoord", uv_set)
            transform = UVTransform(extension.vector("offset", 2, (0.0, 0.0)), extension.number("rotation", 0.0),
                                    extension.vector("scale", 2, (1.0, 1.0)))
        if uv_set >= MAX_UV_SETS:
            info.warn(f"the texture is left out: it uses UV set {uv_set}, and only 0 and 1 are supported", "texCoord")
            return None
        image = self._image(info, source, neutral)
        return None if image is None else Texture(image, self._sampler(texture), uv_set, transform)

    def _image_index(self, texture: Element) -> int | None:
        for name in IMAGE_EXTENSIONS:
            extension = texture.extension(name)
            if name == BASISU and "source" in texture and not ktx2.is_installed():
                continue
            if extension is not None and "source" in extension:
                return extension.index("source", len(self._images))
        if "source" in texture:
            return texture.index("source", len(self._images))
        extensions = ", ".join(texture.object("extensions").value)
        texture.warn(f"the texture is left out: its only image is for {extensions}, which is not supported"
                     if extensions else "the texture is left out: it has no image")
        return None

    def _sampler(self, texture: Element) -> Sampler:
        if "sampler" not in texture:
            return Sampler()
        sampler = self._samplers[texture.index("sampler", len(self._samplers))]
        min_filter, mip_filter = sampler.choice("minFilter", _MIN_FILTERS, 9987)
        return Sampler(sampler.choice("wrapS", _WRAPS, 10497), sampler.choice("wrapT", _WRAPS, 10497),
                       sampler.choice("magFilter", _MAG_FILTERS, 9729), min_filter, mip_filter)

    def _image(self, info: Element, index: int, neutral: RGBA) -> TextureImage | None:
        """Raises OutsideError for a file that is not the model's."""
        if index in self._lost:
            return None
        if index not in self.opened:
            try:
                self.opened[index] = self._open(self._images[index], neutral)
            except OutsideError:
                raise
            except InputError as error:
                problem = str(error).removeprefix(f"{info.document.path}: ")
                info.warn(f"{problem}; the texture is left out")
                self._lost.add(index)
                return None
        image = self.opened[index]
        if image.neutral == neutral:
            return image
        return self._otherwise_neutral.setdefault((index, neutral), replace(image, neutral=neutral))

    def _open(self, image: Element, neutral: RGBA) -> TextureImage:
        name = f"{image.document.path}: {image.place}"
        if "uri" in image:
            data, path = read_uri(image)
            name = name if path is None else str(path)
        else:
            data = self._buffers.view(image.index("bufferView", len(self._buffers.views)))
        return open_texture_image(data, name, neutral=neutral)
