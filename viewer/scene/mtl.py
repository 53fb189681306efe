"""Reads Wavefront MTL files: the Phong materials of OBJ files, and roughness and metallic as Blender writes them."""

from __future__ import annotations

import io
import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
from PIL import Image

from ..errors import InputError
from .color import srgb_to_linear
from .files import path_inside, read_file
from .material import RGB, Material, Sampler, Texture, UVTransform, Wrap
from .parameter import RGBA, WHITE
from .schema import MAPS
from .text import decoded, plain_text
from .texture_image import MESH_FORMATS, TextureImage, open_texture_image

PLAIN = Material(base_color=(0.32, 0.32, 0.32, 1.0), metallic=0.0, perceptual_roughness=0.5, double_sided=True)
"""The material of meshes without one: double-sided, since triangles may be wound either way, and grey (0.6 in sRGB),
since white has little form under a bright environment. glTF defines a default material of its own, which is white."""

_OPTIONS = {"-blendu": 1, "-blendv": 1, "-boost": 1, "-mm": 2, "-texres": 1, "-clamp": 1, "-bm": 1, "-imfchan": 1,
            "-type": 1, "-cc": 1, "-o": 3, "-s": 3, "-t": 3}
"""The options of texture maps and how many arguments each takes; the last three may have fewer."""

_IGNORED = {"map_ks", "map_ns", "map_d", "map_ps", "map_pc", "disp", "decal", "refl", "ps", "pc", "aniso"}
"""Statements that change a surface and are not supported."""
_ZEROS = ("0", "0.0", "0.000000")
_MAPS = {"map_kd", "map_ke", "map_pr", "map_pm", "norm", "map_bump", "bump"}
"""Statements that name an image which is read."""
_LIBRARY = re.compile(rb"^ *mtllib +(.+?) *$", re.MULTILINE)


class MaterialLibrary:
    """The materials of any number of MTL files. Files and textures that cannot be used are left out, with a warning."""

    def __init__(self, model: Path, warnings: list[str]) -> None:
        self.materials: dict[str, Material] = {}
        self._model, self._warnings = model, warnings
        self._images: dict[tuple[Path, RGBA], TextureImage] = {}

    def add_all(self, names: str) -> None:
        """Read the MTL files that one statement names."""
        for name in _libraries(self._model, names):
            self._add(name)

    def _add(self, name: str) -> None:
        try:
            text = decoded(plain_text(read_file(_find(self._model, name))))
        except InputError as error:
            self._warnings.append(f"mtllib: {error.problem}; its materials are left out")
            return
        blocks = _blocks(text)
        # Of several files the first that has a material counts.
        self.materials = {block["newmtl"]: self._material(block) for block in blocks} | self.materials
        ignored = {key for block in blocks for key in block if key in _IGNORED and block[key].split()[0] not in _ZEROS}
        self._warnings += [f"{name[:80]}: {key} is not supported; it is left out" for key in sorted(ignored)]

    def _material(self, block: dict[str, str]) -> Material:
        """The material of one `newmtl` block.

        Colours are decoded from sRGB, since the renderers of MTL's time displayed them without conversion. Ks becomes
        specular_color, which scales the reflectance f0 = 4 % of a dielectric.
        """
        shininess = _number(block.get("ns"))
        roughness = _number(block.get("pr"))
        roughness_and_metallic_map = self._roughness_and_metallic_map(block)
        if roughness is not None or "map_pr" in block:
            shininess = None
            # With a map, as with Ke and Kd, a factor of 0 is what a writer leaves where the map counts.
            roughness = (roughness or 1.0) if "map_pr" in block else roughness or 0.0
        elif shininess is not None:
            shininess = min(max(shininess, 0.0), 1e6)
            # alpha = sqrt(2 / (Ns + 2)) (Walter et al. 2007, section 5.2), and alpha = perceptual roughness^2.
            roughness = (2 / (shininess + 2)) ** 0.25
        else:
            roughness = PLAIN.perceptual_roughness
        metallic = _number(block.get("pm")) or (1.0 if "map_pm" in block else 0.0)
        opacity = _number(block.get("d", "").removeprefix("-halo"))
        if opacity is None:
            opacity = 1 - (_number(block.get("tr")) or 0.0)
        # Exporters disagree on the meaning of Tr. Opacity 0 is read as 1, since nobody exports invisible surfaces.
        opacity = min(max(opacity, 0.0), 1.0) or 1.0
        color_map, _ = self._texture(block, "map_kd")
        emissive_map, _ = self._texture(block, "map_ke")
        normal_map, normal_scale = self._normal_map(block)
        color = _color(block.get("kd"), (1.0, 1.0, 1.0) if color_map else PLAIN.base_color[:3])
        emissive = _color(block.get("ke"), (0.0, 0.0, 0.0))
        if emissive_map and not any(emissive):
            emissive = (1.0, 1.0, 1.0)
        return Material(block["newmtl"], (*color, opacity), color_map, min(max(metallic, 0.0), 1.0),
                        min(max(roughness, 0.0), 1.0), roughness_and_metallic_map, normal_map, normal_scale,
                        emissive=emissive, emissive_texture=emissive_map,
                        specular_color=_color(block.get("ks"), (1.0, 1.0, 1.0)),
                        alpha_mode="blend" if opacity < 1 else "opaque", double_sided=True, shininess=shininess)

    def _roughness_and_metallic_map(self, block: dict[str, str]) -> Texture | None:
        """map_Pr and map_Pm as one texture, roughness in G and metallic in B; both are read at map_Pr's coordinates."""
        textures = {key: texture for key in ("map_pr", "map_pm")
                    for texture in [self._texture(block, key)[0]] if texture is not None}
        if not textures:
            return None
        first = next(iter(textures.values()))
        size = (first.image.width, first.image.height)
        bands = [_band(textures[key].image, block[key], size) if key in textures else Image.new("L", size, 255)
                 for key in ("map_pr", "map_pm")]
        for texture in textures.values():
            for problem in texture.image.problems:
                self._warnings.append(f"{block['newmtl']}: {problem}; the texture is left out")
        file = io.BytesIO()
        Image.merge("RGB", (Image.new("L", size, 255), *bands)).save(file, "PNG")
        name = " and ".join(dict.fromkeys(texture.image.name for texture in textures.values()))
        return replace(first, image=open_texture_image(file.getvalue(), name, MESH_FORMATS))

    def _normal_map(self, block: dict[str, str]) -> tuple[Texture | None, float]:
        """The normal map and its scale. `norm` is a normal map; `map_Bump` is one in practice, unless it is grey, which
        means a height map."""
        key = next((key for key in ("norm", "map_bump", "bump") if key in block), "norm")
        texture, scale = self._texture(block, key)
        if texture is not None and texture.image.grey:
            self._warnings.append(f"{texture.image.name}: is a height map, which is not supported; it is left out")
            return None, 1.0
        return texture, scale

    def _texture(self, block: dict[str, str], key: str) -> tuple[Texture | None, float]:
        """The texture of a map statement, and its bump multiplier."""
        if key not in block:
            return None, 1.0
        name, options = _split_options(block[key])
        try:
            path = _find(self._model, name)
            neutral = MAPS["normal"].info.neutral if key in ("norm", "map_bump", "bump") else WHITE
            if (path, neutral) not in self._images:
                self._images[path, neutral] = open_texture_image(read_file(path), str(path), MESH_FORMATS, neutral)
        except InputError as error:
            self._warnings.append(f"{block['newmtl']}: {key}: {error.problem}; the texture is left out")
            return None, 1.0
        wrap: Wrap = "clamp" if options.get("-clamp", "off").lower() == "on" else "repeat"
        scale = _number(options.get("-bm"))
        texture = Texture(self._images[path, neutral], Sampler(wrap, wrap), transform=_uv_transform(options))
        return texture, 1.0 if scale is None else scale

    @property
    def images(self) -> list[TextureImage]:
        return list(self._images.values())


def _blocks(text: str) -> list[dict[str, str]]:
    """One dictionary per material, from each statement's keyword in lower case to the rest of its line."""
    blocks: list[dict[str, str]] = []
    for line in text.splitlines():
        words = line.split(None, 1)
        if len(words) < 2:
            continue
        key, value = words[0].lower(), words[1].strip()
        if key == "newmtl":
            blocks.append({"newmtl": " ".join(value.split())})
        elif blocks:
            blocks[-1][key] = value
    return blocks


def _split_options(value: str) -> tuple[str, dict[str, str]]:
    """The file name at the end of a map statement, which may hold spaces, and the options before it."""
    options: dict[str, str] = {}

    def next_word() -> tuple[str, str]:
        word, _, rest = re.sub(r"\s", " ", value).partition(" ")
        return word, value[len(word):].lstrip() if rest else ""

    while (word := next_word())[0].lower() in _OPTIONS:
        option, value = word[0].lower(), word[1]
        arguments = []
        for k in range(_OPTIONS[option]):
            argument, rest = next_word()
            if not rest or (option in ("-o", "-s", "-t") and k and _number(argument) is None):
                break
            arguments.append(argument)
            value = rest
        options.setdefault(option, " ".join(arguments))
    return value, options


def _uv_transform(options: dict[str, str]) -> UVTransform | None:
    """Of -s and -o: uv' = s uv + o with v upwards, where ours is downwards."""
    if "-s" not in options and "-o" not in options:
        return None
    scale, offset = ([value if value is not None else default for value in map(_number, options.get(key, "").split())]
                     + [default] * 2 for key, default in (("-s", 1.0), ("-o", 0.0)))
    if (scale[:2], offset[:2]) == ([1.0, 1.0], [0.0, 0.0]):
        return None
    return UVTransform((offset[0], 1 - scale[1] - offset[1]), 0.0, (scale[0], scale[1]))


def _band(image: TextureImage, statement: str, size: tuple[int, int]) -> Image.Image:
    """One channel of an image: the one of -imfchan, or its luminance."""
    channel = _split_options(statement)[1].get("-imfchan", "l").upper()
    pixels = image.decode("RGB")
    if pixels.dtype == np.uint16:
        pixels = (pixels >> 8).astype(np.uint8)
    plain = Image.fromarray(pixels)
    band = plain.getchannel(channel) if channel in ("R", "G", "B") else plain.convert("L")
    return band if band.size == size else band.resize(size)


def files_named(model: Path, text: bytes) -> Iterator[Path]:
    """The MTL files that the text of an OBJ file names, and the images that these name, as far as they are there."""
    for names in _LIBRARY.findall(plain_text(text)):
        for library in _found(model, _libraries(model, decoded(names))):
            yield library
            blocks = _blocks(decoded(plain_text(read_file(library))))
            yield from _found(model, [_split_options(value)[0] for block in blocks for key, value in block.items()
                                      if key in _MAPS])


def _found(model: Path, names: list[str]) -> Iterator[Path]:
    for name in names:
        try:
            yield _find(model, name)
        except InputError:
            continue


def _libraries(model: Path, names: str) -> list[str]:
    """The MTL files that one statement names: a file whose name holds spaces, or several files, of which one with
    spaces stands in quotes."""
    try:
        _find(model, names)
    except InputError:
        return [quoted or word for quoted, word in re.findall(r'"([^"]*)"|(\S+)', names.split(" #")[0])]
    return [names]


def _find(model: Path, name: str) -> Path:
    """The file of that name in the model's folder. Quotes around it, and a comment behind it, are none of it."""
    plain = name.strip().strip('"').replace("\\", "/")
    try:
        return path_inside(model, plain, "")
    except InputError:
        bare = plain.split(" #")[0].strip().strip('"')
        if bare == plain:
            raise
        return path_inside(model, bare, "")


def without_textures(material: Material) -> Material:
    """The material for a mesh that has no texture coordinates."""
    return replace(material, base_color_texture=None, metallic_roughness_texture=None, normal_texture=None,
                   emissive_texture=None)


def _number(text: str | None) -> float | None:
    try:
        value = float(text.split()[0]) if text else math.nan
    except (ValueError, IndexError):
        return None
    return value if math.isfinite(value) else None


def _color(text: str | None, default: RGB) -> RGB:
    """The linear colour of three sRGB values, or of one grey value; `default` for anything else, such as a spectrum."""
    words = (text or "").split()[:3]
    values = [value for value in map(_number, words) if value is not None]
    if len(values) != len(words) or len(values) not in (1, 3):
        return default
    red, green, blue = map(float, srgb_to_linear(np.clip(np.broadcast_to(values, 3), 0.0, 1.0)))
    return red, green, blue
