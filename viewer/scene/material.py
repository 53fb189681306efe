"""What surfaces are made of: glTF 2.0's metallic-roughness material and the textures it samples.

Colours are linear Rec. 709. Texture *files* stay encoded until somebody asks for their pixels, so that a texture no
shader samples is never decoded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal

import numpy as np

from .texture_image import TextureImage

Wrap = Literal["repeat", "clamp", "mirror"]
Filter = Literal["nearest", "linear"]
AlphaMode = Literal["opaque", "mask", "blend"]
RGB = tuple[float, float, float]


@dataclass(frozen=True)
class Sampler:
    """How a texture is filtered and wrapped; `mip_filter` None means no mipmaps."""

    wrap_s: Wrap = "repeat"
    wrap_t: Wrap = "repeat"
    mag_filter: Filter = "linear"
    min_filter: Filter = "linear"
    mip_filter: Filter | None = "linear"


@dataclass(frozen=True)
class UVTransform:
    """KHR_texture_transform: uv' = offset + rotation * scale * uv; the rotation in radians, counter-clockwise."""

    offset: tuple[float, float] = (0.0, 0.0)
    rotation: float = 0.0
    scale: tuple[float, float] = (1.0, 1.0)

    def matrix(self) -> np.ndarray:
        """The (2, 3) float64 matrix M of uv' = M[:, :2] @ uv + M[:, 2]."""
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        # As Khronos' TextureTransformTest wants it; the GLSL in the extension's text turns the other way.
        rotation = np.array([[cosine, sine], [-sine, cosine]])
        return np.column_stack([rotation * self.scale, self.offset])


@dataclass(frozen=True)
class Texture:
    """An image as a material uses it. `uv_set` picks one of the mesh's UV sets."""

    image: TextureImage
    sampler: Sampler = Sampler()
    uv_set: int = 0
    transform: UVTransform | None = None


@dataclass(frozen=True)
class Material:
    """A metallic-roughness surface (glTF 2.0, with KHR_materials_{unlit,emissive_strength,specular,ior,transmission,
    volume}).

    Channels: base colour and emissive are sRGB RGB(A); metallic in B and perceptual roughness in G of one texture;
    occlusion in R; specular in A; specular colour sRGB RGB; transmission in R; thickness in G; normals +Y up.
    `emissive` already holds its strength.
    `ior` is at least 1, or 0: KHR_materials_ior's word for f0 = 1 before the specular parameters are applied.
    `transmission` is the share of what passes the interface that is refracted on instead of scattered. `thickness`, in
    the mesh's own units, is 0 for a thin wall; else the surface bounds a volume in which light keeps
    `attenuation_color` over `attenuation_distance` world units.
    `shininess` is the exponent of a Phong material's file (MTL `Ns`), None where the file gave roughness instead.
    """

    name: str = ""
    base_color: tuple[float, float, float, float] = (1.0, 1.0, 1.0, 1.0)
    base_color_texture: Texture | None = None
    metallic: float = 1.0
    perceptual_roughness: float = 1.0
    metallic_roughness_texture: Texture | None = None
    normal_texture: Texture | None = None
    normal_scale: float = 1.0
    occlusion_texture: Texture | None = None
    occlusion_strength: float = 1.0
    emissive: RGB = (0.0, 0.0, 0.0)
    emissive_texture: Texture | None = None
    ior: float = 1.5
    specular: float = 1.0
    specular_texture: Texture | None = None
    specular_color: RGB = (1.0, 1.0, 1.0)
    specular_color_texture: Texture | None = None
    transmission: float = 0.0
    transmission_texture: Texture | None = None
    thickness: float = 0.0
    thickness_texture: Texture | None = None
    attenuation_distance: float = math.inf
    attenuation_color: RGB = (1.0, 1.0, 1.0)
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = 0.5
    double_sided: bool = False
    unlit: bool = False
    shininess: float | None = None

    @property
    def transmits(self) -> bool:
        """Whether light passes. Metals let none through, and what has ior 0 reflects all."""
        is_metal = self.metallic == 1 and self.metallic_roughness_texture is None
        return self.transmission > 0 and not is_metal and self.ior >= 1

    @property
    def has_interface(self) -> bool:
        """Whether anything is reflected or refracted at the surface; else it is Lambertian."""
        return self.specular > 0 or self.metallic > 0 or self.transmits

    @property
    def bends_normals(self) -> bool:
        """Whether there is a normal map that changes anything, for which a mesh needs tangents."""
        return self.normal_texture is not None and not self.unlit and self.normal_scale != 0

    @property
    def absorption(self) -> np.ndarray:
        """Beer's sigma of the volume, (3,) float64 per world unit: -ln(color) / distance (KHR_materials_volume)."""
        if not math.isfinite(self.attenuation_distance):
            return np.zeros(3)
        return -np.log(np.clip(self.attenuation_color, 1e-6, 1.0)) / self.attenuation_distance
