"""Reads Wavefront MTL files, which hold the Phong materials of OBJ files."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np

from ..errors import InputError
from .color import srgb_to_linear
from .files import path_inside, read_file
from .material import RGB, Material, Sampler, Texture, Wrap
from .texture_image import MESH_FORMATS, TextureImage, open_texture_image

PLAIN = Material(base_color=(0.8, 0.8, 0.8, 1.0), metallic=0.0, perceptual_roughness=0.5, double_sided=True)
"""The material of meshes without one. It is light grey and double-sided, since triangles may be wound either way."""

_OPTIONS = {"-blendu": 1, "-blendv": 1, "-boost": 1, "-mm": 2, "-texres": 1, "-clamp": 1, "-bm": 1, "-imfchan": 1,
            "-type": 1, "-cc": 1, "-o": 3, "-s": 3, "-t": 3}
"""The options of texture maps and how many arguments each takes; the last three may have fewer."""


class MaterialLibrary:
    """The materials of any number of MTL files. Files and textures that cannot be used are left out, with a warning."""

    def __init__(self, model: Path, warnings: list[str]) -> None:
        self.materials: dict[str, Material] = {}
        self._model, self._warnings = model, warnings
        self._images: dict[Path, TextureImage] = {}

    def add(self, name: str) -> None:
        """Read the MTL file of that name in the model's folder."""
        try:
            text = read_file(self._find(name)).decode("utf-8", "replace")
        except InputError as error:
            self._warnings.append(f"mtllib: {error.problem}; its materials are left out")
            return
        for block in _blocks(text):
            self.materials[block["newmtl"]] = self._material(block)

    def _find(self, name: str) -> Path:
        return path_inside(self._model, name.replace("\\", "/"), "")

    def _material(self, block: dict[str, str]) -> Material:
        """The material of one `newmtl` block.

        Colours are decoded from sRGB, since the renderers of MTL's time displayed them without conversion. Ks becomes
        specular_color, which scales the reflectance f0 = 4 % of a dielectric.
        """
        shininess = _number(block.get("ns"))
        roughness = PLAIN.perceptual_roughness
        if shininess is not None:
            shininess = min(max(shininess, 0.0), 1e6)
            # alpha = sqrt(2 / (Ns + 2)) (Walter et al. 2007, section 5.2), and alpha = perceptual roughness^2.
            roughness = (2 / (shininess + 2)) ** 0.25
        opacity = _number(block.get("d"))
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
        return Material(block["newmtl"], (*color, opacity), color_map, 0.0, roughness, None, normal_map, normal_scale,
                        emissive=emissive, emissive_texture=emissive_map,
                        specular_color=_color(block.get("ks"), (1.0, 1.0, 1.0)),
                        alpha_mode="blend" if opacity < 1 else "opaque", double_sided=True, shininess=shininess)

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
            path = self._find(name)
            if path not in self._images:
                self._images[path] = open_texture_image(read_file(path), str(path), MESH_FORMATS)
        except InputError as error:
            self._warnings.append(f"{block['newmtl']}: {key}: {error.problem}; the texture is left out")
            return None, 1.0
        wrap: Wrap = "clamp" if options.get("-clamp", "off").lower() == "on" else "repeat"
        scale = _number(options.get("-bm"))
        return Texture(self._images[path], Sampler(wrap, wrap)), 1.0 if scale is None else scale

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
    words = value.split(" ")
    options: dict[str, str] = {}
    while words and words[0].lower() in _OPTIONS:
        option = words.pop(0).lower()
        for k in range(_OPTIONS[option]):
            if not words or (option in ("-o", "-s", "-t") and k and _number(words[0]) is None):
                break
            options.setdefault(option, words.pop(0))
    return " ".join(words), options


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
