"""UsdPreviewSurface as our materials.

Source: openusd.org/release/spec_usdpreviewsurface.html. Its textures hold one number in any channel, ours several in
certain ones; where a file does not have them so, another image is made of its channels.
"""

from __future__ import annotations

import io
import zipfile
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from ...errors import InputError
from ..files import path_inside, read_file
from ..light import BRIGHTEST
from ..material import AlphaMode, Material, Sampler, Texture, Wrap
from ..mtl import PLAIN
from ..parameter import WHITE
from ..schema import MAPS
from ..specular_glossiness import DIELECTRIC_F0
from ..texture_image import MESH_FORMATS, TextureImage, open_texture_image

Json = dict[str, Any]
Band = tuple[TextureImage, str] | None
"""An image and one of its channels, R, G, B or A; None: 255."""
_WRAPS: dict[str, Wrap] = {"repeat": "repeat", "mirror": "mirror"}
_MOST_UNPACKED = 1 << 29


class Materials:
    """The materials of a file. Textures that cannot be used are left out, with a warning."""

    def __init__(self, path: Path, told: list[Json], warnings: list[str]) -> None:
        self._path, self._told, self._warnings = path, told, warnings
        self._files: dict[tuple[str, bool], TextureImage | None] = {}
        self._packed: dict[tuple[Band, ...], TextureImage] = {}
        self._made: dict[tuple[int, bool], Material] = {}

    @property
    def images(self) -> list[TextureImage]:
        return [*(image for image in self._files.values() if image is not None), *self._packed.values()]

    def of(self, number: int, has_uvs: bool) -> tuple[Material, Json | None]:
        """A material for meshes with or without texture coordinates, and the transform of these."""
        told = self._told[number]
        key = number, has_uvs
        if key not in self._made:
            self._made[key] = self._material(told, told["textures"] if has_uvs else {}) if told["values"] \
                else replace(PLAIN, name=told["name"])
        return self._made[key], told["uv"]

    def _material(self, told: Json, textures: Json) -> Material:
        values = told["values"]
        found = {name: texture for name in textures for texture in [self._texture(told, name)] if texture is not None}

        def color(name: str) -> tuple[float, float, float]:
            parts = textures[name]["scale"][:3] if name in found else values[name][:3]
            red, green, blue = (min(max(0.0, float(part)), BRIGHTEST) for part in parts)  # NaN is 0
            return red, green, blue

        def number(name: str, low: float = 0.0, high: float = 1.0) -> float:
            value = textures[name]["scale"][_channel(textures[name])] if name in found else values[name]
            return min(max(float(value), low), high)

        is_specular = bool(values["useSpecularWorkflow"])
        opacity = number("opacity")
        cutoff = float(values["opacityThreshold"])
        mode: AlphaMode = "opaque" if opacity == 1 and "opacity" not in found else "mask" if cutoff > 0 else "blend"
        metallic = 0.0 if is_specular else number("metallic")
        red, green, blue = (min(part, 1.0) for part in color("diffuseColor"))
        f0 = tuple(part / DIELECTRIC_F0 for part in color("specularColor")) if is_specular else (1.0, 1.0, 1.0)
        ior = 1.5 if is_specular else float(values["ior"])
        return Material(
            told["name"], (red, green, blue, opacity), self._base(found, textures, mode), metallic,
            number("roughness"), self._rough_and_metallic(found, textures, is_specular), found.get("normal"),
            _normal_scale(textures["normal"]) if "normal" in found else 1.0,
            occlusion_texture=self._occlusion(found, textures),
            emissive=color("emissiveColor"), emissive_texture=found.get("emissiveColor"),
            ior=ior if ior >= 1 or ior == 0 else 1.5, specular_color=f0,  # type: ignore[arg-type]
            clearcoat=number("clearcoat"), clearcoat_roughness=number("clearcoatRoughness"), alpha_mode=mode,
            alpha_cutoff=max(cutoff, 0.0))

    def _base(self, found: dict[str, Texture], textures: Json, mode: AlphaMode) -> Texture | None:
        color, opacity = found.get("diffuseColor"), found.get("opacity")
        if opacity is None or mode == "opaque":
            return color
        channel = "RGBA"[_channel(textures["opacity"])]
        if color is not None and color.image is opacity.image and channel == "A":
            return color
        bands: list[Band] = [(color.image, name) if color is not None else None for name in "RGB"]
        return replace(color or opacity, image=self._image((*bands, (opacity.image, channel))))

    def _rough_and_metallic(self, found: dict[str, Texture], textures: Json, is_specular: bool) -> Texture | None:
        """Roughness in G, metallic in B."""
        names = ["roughness"] if is_specular else ["roughness", "metallic"]
        used = [name for name in names if name in found]
        if not used:
            return None
        bands: dict[str, Band] = {name: (found[name].image, "RGBA"[_channel(textures[name])]) for name in used}
        roughness, metallic = bands.get("roughness"), bands.get("metallic")
        first = found[used[0]]
        if roughness == (first.image, "G") and metallic == (first.image, "B"):
            return first
        return replace(first, image=self._image((None, roughness, metallic)))

    def _occlusion(self, found: dict[str, Texture], textures: Json) -> Texture | None:
        texture = found.get("occlusion")
        channel = "RGBA"[_channel(textures["occlusion"])] if texture is not None else "R"
        return texture if texture is None or channel == "R" else replace(
            texture, image=self._image(((texture.image, channel), None, None)))

    def _image(self, bands: tuple[Band, ...]) -> TextureImage:
        """An image of the channels of others."""
        if bands not in self._packed:
            images = [band[0] for band in bands if band is not None]
            size = max((image.width, image.height) for image in images)
            made = Image.merge("RGBA" if len(bands) == 4 else "RGB", [_band(band, size) for band in bands])
            file = io.BytesIO()
            made.save(file, "PNG", compress_level=1)
            name = " and ".join(dict.fromkeys(image.name for image in images))
            self._packed[bands] = open_texture_image(file.getvalue(), name, MESH_FORMATS)
            self._warnings += [problem for image in images for problem in image.problems]
        return self._packed[bands]

    def _texture(self, told: Json, name: str) -> Texture | None:
        texture, place = told["textures"][name], f"material {told['name'][:80]!r}: {name}"
        if name in ("specularColor", "clearcoat", "clearcoatRoughness"):
            self._warnings.append(f"{place}: a texture of it is left out")
            return None
        if name != "normal" and any(texture["bias"]):
            self._warnings.append(f"{place}: the bias of its texture is left out")
        try:
            image = self._read(texture["file"], texture["asked"], name == "normal")
        except InputError as error:
            self._warnings.append(f"{place}: {error.problem}; the texture is left out")
            return None
        wrap_s, wrap_t = (_WRAPS.get(wrap, "clamp") for wrap in texture["wrap"])
        return Texture(image, Sampler(wrap_s, wrap_t))

    def _read(self, file: str, asked: str, is_normal: bool) -> TextureImage:
        """The image file of an asset, which may lie in a .usdz."""
        if "<UDIM>" in asked:
            raise InputError(self._path, "", f"{asked[-200:]!r} is a set of tiles, which is not read")
        if not file:
            raise InputError(self._path, "", f"no such file: {asked[-200:]!r}")
        key = file, is_normal
        image = self._files.get(key)
        if image is None:
            outer, _, inner = file.removesuffix("]").partition(".usdz[") if file.endswith("]") else (file, "", "")
            data = self._unpacked(outer + ".usdz", inner) if inner else read_file(self._inside(outer, asked))
            neutral = MAPS["normal"].info.neutral if is_normal else WHITE
            image = self._files[key] = open_texture_image(data, Path(inner or outer).name, MESH_FORMATS, neutral)
        return image

    def _inside(self, file: str, asked: str) -> Path:
        folder = self._path.parent.resolve()
        real = Path(file).resolve()
        if not real.is_relative_to(folder):
            raise InputError(self._path, "", f"{asked[-200:]!r} lies outside the model's folder")
        return path_inside(self._path, real.relative_to(folder).as_posix(), "")

    def _unpacked(self, package: str, name: str) -> bytes:
        path = self._path if Path(package).resolve() == self._path.resolve() else self._inside(package, package)
        try:
            with zipfile.ZipFile(path) as archive:
                if archive.getinfo(name).file_size > _MOST_UNPACKED:
                    raise InputError(self._path, "", f"{name[-200:]!r} unpacks to more than {_MOST_UNPACKED} bytes")
                return archive.read(name)
        except (KeyError, OSError, ValueError, NotImplementedError, zipfile.BadZipFile) as error:
            raise InputError(self._path, "", f"no such file in the package: {name[-200:]!r}") from error


def transformed(uvs: np.ndarray, uv: Json) -> np.ndarray:
    """Texture coordinates (N, 2) after a UsdTransform2d: scaled, rotated counter-clockwise, moved."""
    angle = np.radians(uv["rotation"])
    rotation = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return (uvs * uv["scale"]) @ rotation.T + uv["translation"]


def _channel(texture: Json) -> int:
    """The number of the channel that a single number is read from."""
    return max("rgba".find(texture["output"][:1]), 0)


def _normal_scale(texture: Json) -> float:
    """The scale of x and y of a normal; 2 with the bias -1 is that of the texels themselves."""
    return float(texture["scale"][0]) / 2 if texture["bias"][0] else 1.0


def _band(band: Band, size: tuple[int, int]) -> Image.Image:
    if band is None:
        return Image.new("L", size, 255)
    pixels = band[0].decode("RGBA")
    if pixels.dtype == np.uint16:
        pixels = (pixels >> 8).astype(np.uint8)
    plain = Image.fromarray(np.ascontiguousarray(pixels[..., "RGBA".index(band[1])]))
    return plain if plain.size == size else plain.resize(size)
