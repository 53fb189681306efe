"""Materials: the one declaration of every parameter and texture map.

Colours are linear Rec. 709. Texture files stay encoded until their pixels are needed, so a texture that no shader
samples is never decoded.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields, replace
from types import NoneType
from typing import Literal, get_args

import numpy as np

from ..base.expect import expect, expect_number
from ..errors import UsageError
from .arrays import check_flag
from .light import BRIGHTEST
from .medium import VACUUM, Medium, scaled, single_scattering_albedo
from .parameter import Feature, parameter, texture_map
from .texture_image import TextureImage
from .weave import Weave

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
        """The (2, 3) float64 matrix M of uv' = M[:, :2] @ uv + M[:, 2]. Its numbers are at most 1e30, which leaves
        float32 room for their products with uv."""
        cosine, sine = math.cos(self.rotation), math.sin(self.rotation)
        # The sign follows Khronos' TextureTransformTest; the GLSL in the extension's text rotates the other way.
        rotation = np.array([[cosine, sine], [-sine, cosine]])
        return np.clip(np.column_stack([rotation * self.scale, self.offset]), -1e30, 1e30)


@dataclass(frozen=True)
class Texture:
    """An image with its sampler and transform. `uv_set` is the number of the mesh's UV set that it is read with."""

    image: TextureImage
    sampler: Sampler = Sampler()
    uv_set: int = 0
    transform: UVTransform | None = None


_ALL, _LIT = ("unlit", "phong", "pbr"), ("phong", "pbr")

CORE = Feature("glTF 2.0")
METALLIC_ROUGHNESS = Feature("metallic-roughness", place="pbrMetallicRoughness")
EMISSION = Feature(
    "emission", switch="HAS_EMISSION", is_on=lambda m: any(m.emissive), models=_ALL, is_shareable=True)
IOR = Feature("index of refraction", "KHR_materials_ior")
SPECULAR = Feature("specular weight", "KHR_materials_specular")
SPECULAR_TINT = Feature(
    "specular colour", "KHR_materials_specular", switch="SPECULAR_TINTED", is_shareable=True, models=_LIT,
    is_on=lambda m: m.is_dielectric and m.specular > 0 and (
        m.specular_color_texture is not None or m.specular_color != (1.0, 1.0, 1.0)))
TRANSMISSION = Feature(
    "transmission", "KHR_materials_transmission", switch="HAS_TRANSMISSION", is_on=lambda m: m.transmits)
DIFFUSE_TRANSMISSION = Feature(
    "diffuse transmission", "KHR_materials_diffuse_transmission", switch="DIFFUSE_TRANSMISSION",
    is_on=lambda m: m.transmits_diffusely)
VOLUME = Feature(
    "volume", "KHR_materials_volume", switch="IS_SOLID",
    is_on=lambda m: (m.transmits or m.transmits_diffusely) and m.thickness > 0)
DISPERSION = Feature(
    "dispersion", "KHR_materials_dispersion", switch="DISPERSIVE",
    is_on=lambda m: m.dispersion > 0 and m.transmits and m.thickness > 0)
SCATTER = Feature(
    "scattering in thin walls", "KHR_materials_scatter", switch="THIN_SCATTER", is_on=lambda m: m.scatters_thinly,
    applied_by="thin_scatter")
VOLUME_SCATTER = Feature(
    "scattering in volumes", "KHR_materials_volume_scatter",
    is_on=lambda m: any(m.scatter_color) and VOLUME.is_on(m) and any(m.extinction))

ANISOTROPY = Feature(
    "anisotropy", "KHR_materials_anisotropy", switch="ANISOTROPIC", needs_tangents=True,
    is_on=lambda m: m.anisotropy_strength > 0 and m.has_interface)

DIFFUSE_ROUGHNESS = Feature(
    "diffuse roughness", "KHR_materials_diffuse_roughness", switch="DIFFUSE_ROUGH",
    is_on=lambda m: m.diffuse_roughness > 0 and m.is_dielectric)
SPECULAR_GLOSSINESS = Feature(
    "specular and glossiness", "KHR_materials_pbrSpecularGlossiness", switch="SPECULAR_GLOSSINESS", models=_LIT,
    is_on=lambda m: m.specular_glossiness_texture is not None)

SHEEN = Feature(
    "sheen", "KHR_materials_sheen", switch="SHEEN",
    is_on=lambda m: any(m.sheen_color) and m.sheen_roughness > 0)

IRIDESCENCE = Feature(
    "iridescence", "KHR_materials_iridescence", switch="IRIDESCENT", is_on=lambda m: m.has_film)

CLEARCOAT = Feature(
    "clear coat", "KHR_materials_clearcoat", switch="CLEARCOAT", is_on=lambda m: m.clearcoat > 0)


@dataclass(frozen=True)
class Material:
    """A surface: glTF 2.0's metallic-roughness model and its extensions. The fields below declare everything.

    Colours are linear Rec. 709. `emissive` is already multiplied by its strength (KHR_materials_emissive_strength),
    and at most 1e30, which leaves float32 room for sums of lights.
    `ior` is at least 1, or 0, by which KHR_materials_ior means f0 = 1 before the specular parameters are applied.
    It and `dispersion` are at most 1e9, so that float32 holds the square of every colour's index. The scales of mapped
    normals are at most 1e9 either way, so that float32 holds the squares of the normals' lengths. With `thickness` 0
    the surface is thin-walled; otherwise it bounds a volume. `shininess` is the exponent of a Phong material (MTL
    `Ns`), or None if the file has a roughness instead.
    """

    name: str = ""
    base_color: tuple[float, float, float, float] = parameter(
        (1.0, 1.0, 1.0, 1.0), "baseColorFactor", "albedo of the diffuse base, f0 of metal, and alpha",
        of=METALLIC_ROUGHNESS, low=0.0, high=1.0, times="base_color.RGBA", unlit=True)
    base_color_texture: Texture | None = texture_map(
        "baseColorTexture", "base colour and alpha", of=METALLIC_ROUGHNESS, channels="RGBA", srgb=True, models=_ALL)
    metallic: float = parameter(
        1.0, "metallicFactor", "share of metal; the rest is dielectric", of=METALLIC_ROUGHNESS, low=0.0, high=1.0,
        times="metallic_roughness.B")
    perceptual_roughness: float = parameter(
        1.0, "roughnessFactor", "square root of the microfacets' alpha", of=METALLIC_ROUGHNESS, low=0.0, high=1.0,
        times="metallic_roughness.G")
    metallic_roughness_texture: Texture | None = texture_map(
        "metallicRoughnessTexture", "roughness in G, metallic in B", of=METALLIC_ROUGHNESS, channels="GB", models=_LIT,
        has_effect=lambda m: m.metallic > 0 or (m.perceptual_roughness > 0 and m.has_interface))
    normal_texture: Texture | None = texture_map(
        "normalTexture", "shading normal in tangent space, +Y up", of=CORE, channels="RGB", models=_LIT,
        neutral=(0.5, 0.5, 1.0, 1.0), has_effect=lambda m: m.normal_scale != 0, needs_tangents=True,
        is_normal=True)
    normal_scale: float = parameter(
        1.0, "normalTexture.scale", "scales the mapped normal's x and y", of=CORE, low=-1e9, high=1e9,
        role="argument", switch="NORMAL_MAP")
    occlusion_texture: Texture | None = texture_map(
        "occlusionTexture", "ambient occlusion: fraction of the environment's light that arrives", of=CORE,
        channels="R", models=_LIT,
        path_traced=False, has_effect=lambda m: m.occlusion_strength > 0)
    occlusion_strength: float = parameter(
        1.0, "occlusionTexture.strength", "strength of the occlusion map; 0: no occlusion", of=CORE, low=0.0, high=1.0,
        path_traced=False, role="argument", switch="OCCLUSION_MAP")
    emissive: RGB = parameter(
        (0.0, 0.0, 0.0), "emissiveFactor", "emitted radiance, multiplied by its strength", of=EMISSION, low=0.0,
        high=1.0, held=BRIGHTEST, times="emissive.RGB", unit="cd/m^2", unlit=True)
    emissive_texture: Texture | None = texture_map(
        "emissiveTexture", "emitted radiance", of=EMISSION, channels="RGB", srgb=True, models=_ALL,
        has_effect=lambda m: any(m.emissive))
    ior: float = parameter(1.5, "ior", "index of refraction of the dielectric", of=IOR, low=1.0, high=1e9, special=0.0)
    specular: float = parameter(
        1.0, "specularFactor", "weight of the dielectric's reflection", of=SPECULAR, low=0.0, high=1.0,
        times="specular.A")
    specular_texture: Texture | None = texture_map(
        "specularTexture", "weight of the dielectric's reflection", of=SPECULAR, channels="A",
        has_effect=lambda m: m.is_dielectric and m.specular > 0)
    specular_color: RGB = parameter(
        (1.0, 1.0, 1.0), "specularColorFactor", "tints the dielectric's f0", of=SPECULAR_TINT, low=0.0,
        times="specular_color.RGB")
    specular_color_texture: Texture | None = texture_map(
        "specularColorTexture", "tints the dielectric's f0", of=SPECULAR_TINT, channels="RGB", srgb=True,
        has_effect=lambda m: m.is_dielectric and m.specular > 0 and any(m.specular_color))
    specular_glossiness_texture: Texture | None = texture_map(
        "specularGlossinessTexture", "f0 in RGB, which multiplies that of specular_color; glossiness in A, which "
        "multiplies 1 - perceptual_roughness; base_color is then the diffuse colour before it is scaled by 1 - max(f0)",
        of=SPECULAR_GLOSSINESS, channels="RGBA", srgb=True, models=_LIT, is_applied=True)
    transmission: float = parameter(
        0.0, "transmissionFactor", "fraction of the light entering the dielectric that is transmitted",
        of=TRANSMISSION, low=0.0, high=1.0, times="transmission.R")
    transmission_texture: Texture | None = texture_map(
        "transmissionTexture", "fraction of the light entering the dielectric that is transmitted", of=TRANSMISSION,
        channels="R", has_effect=lambda m: m.is_dielectric and m.transmits)
    thickness: float = parameter(
        0.0, "thicknessFactor", "thickness of the volume (0: thin-walled)", of=VOLUME, low=0.0, times="thickness.G",
        unit="mesh units", path_traced=False)
    thickness_texture: Texture | None = texture_map(
        "thicknessTexture", "thickness of the volume", of=VOLUME, channels="G", path_traced=False,
        has_effect=lambda m: m.is_dielectric and VOLUME.is_on(m))
    attenuation_distance: float = parameter(
        math.inf, "attenuationDistance", "distance at which the transmittance is attenuation_color", of=VOLUME,
        low=1e-9, unit="world units", role="python")
    attenuation_color: RGB = parameter(
        (1.0, 1.0, 1.0), "attenuationColor", "transmittance over attenuation_distance", of=VOLUME, low=0.0, high=1.0,
        role="python")
    dispersion: float = parameter(
        0.0, "dispersion", "20 over the Abbe number: how far colours are refracted apart", of=DISPERSION, low=0.0,
        high=1e9)
    diffuse_transmission: float = parameter(
        0.0, "diffuseTransmissionFactor", "fraction of the diffuse base's light that leaves on the other side",
        of=DIFFUSE_TRANSMISSION, low=0.0, high=1.0, times="diffuse_transmission.A")
    diffuse_transmission_texture: Texture | None = texture_map(
        "diffuseTransmissionTexture", "fraction of the diffuse base's light that leaves on the other side",
        of=DIFFUSE_TRANSMISSION, channels="A",
        has_effect=lambda m: m.transmits_diffusely and not m.scatters_thinly)
    diffuse_transmission_color: RGB = parameter(
        (1.0, 1.0, 1.0), "diffuseTransmissionColorFactor", "tints the light that leaves on the other side",
        of=DIFFUSE_TRANSMISSION, low=0.0, high=1.0, times="diffuse_transmission_color.RGB")
    diffuse_transmission_color_texture: Texture | None = texture_map(
        "diffuseTransmissionColorTexture", "tints the light that leaves on the other side", of=DIFFUSE_TRANSMISSION,
        channels="RGB", srgb=True, has_effect=lambda m: m.transmits_diffusely and not m.scatters_thinly and any(
            m.diffuse_transmission_color))
    scatter_strength: float = parameter(
        0.0, "scatterStrengthFactor", "fraction of the transmitted light that is scattered; in a volume, times the "
        "albedo of all scattering", of=SCATTER, low=0.0, high=1.0, times="scatter_strength.A")
    scatter_strength_texture: Texture | None = texture_map(
        "scatterStrengthTexture", "fraction of the transmitted light that is scattered, of thin walls alone",
        of=SCATTER, channels="A", has_effect=SCATTER.is_on)
    multiscatter_color: RGB = parameter(
        (1.0, 1.0, 1.0), "multiscatterColorFactor", "albedo of all scattering", of=SCATTER, low=0.0, high=1.0,
        times="multiscatter_color.RGB")
    multiscatter_color_texture: Texture | None = texture_map(
        "multiscatterColorTexture", "albedo of all scattering, of thin walls alone", of=SCATTER, channels="RGB",
        srgb=True, has_effect=lambda m: m.scatters_thinly and any(m.multiscatter_color))
    multiscatter_anisotropy: float = parameter(
        0.0, "scatterAnisotropy", "mean cosine of scattering; of a thin wall, (1 + it) / 2 goes through", of=SCATTER,
        low=-0.999, high=0.999)
    scatter_color: RGB = parameter(
        (0.0, 0.0, 0.0), "multiscatterColorFactor", "albedo of all scattering in the volume",
        of=VOLUME_SCATTER, low=0.0, high=1.0, role="python")
    scatter_anisotropy: float = parameter(
        0.0, "scatterAnisotropy", "mean cosine of scattering in the volume", of=VOLUME_SCATTER,
        low=-0.999, high=0.999, role="python")
    anisotropy_strength: float = parameter(
        0.0, "anisotropyStrength", "stretches highlights along the tangent", of=ANISOTROPY, low=0.0, high=1.0,
        times="anisotropy.B")
    anisotropy_rotation: float = parameter(
        0.0, "anisotropyRotation", "rotates the direction of stretching, counter-clockwise", of=ANISOTROPY,
        unit="radians")
    anisotropy_texture: Texture | None = texture_map(
        "anisotropyTexture", "direction of stretching in RG, encoded from [-1, 1] to [0, 1], and its strength in B",
        of=ANISOTROPY, channels="RGB", neutral=(1.0, 0.5, 1.0, 1.0), needs_tangents=True, raw_channels="RG",
        has_effect=lambda m: m.anisotropy_strength > 0 and m.has_interface)
    diffuse_roughness: float = parameter(
        0.0, "diffuseRoughnessFactor", "roughness of the diffuse base, 0 for Lambert's", of=DIFFUSE_ROUGHNESS, low=0.0,
        high=1.0, times="diffuse_roughness.R")
    diffuse_roughness_texture: Texture | None = texture_map(
        "diffuseRoughnessTexture", "roughness of the diffuse base", of=DIFFUSE_ROUGHNESS, channels="R",
        has_effect=lambda m: m.diffuse_roughness > 0 and m.is_dielectric)
    sheen_color: RGB = parameter(
        (0.0, 0.0, 0.0), "sheenColorFactor", "colour of the sheen of fibres",
        of=SHEEN, low=0.0, high=1.0, times="sheen_color.RGB")
    sheen_color_texture: Texture | None = texture_map(
        "sheenColorTexture", "colour of the sheen", of=SHEEN, channels="RGB", srgb=True, has_effect=SHEEN.is_on)
    sheen_roughness: float = parameter(
        0.0, "sheenRoughnessFactor", "square root of the alpha of the fibres; 0: no sheen", of=SHEEN, low=0.0, high=1.0,
        times="sheen_roughness.A")
    sheen_roughness_texture: Texture | None = texture_map(
        "sheenRoughnessTexture", "roughness of the fibres", of=SHEEN, channels="A", has_effect=SHEEN.is_on)
    iridescence: float = parameter(
        0.0, "iridescenceFactor", "weight of a thin film, at whose faces light interferes", of=IRIDESCENCE, low=0.0,
        high=1.0, times="iridescence.R")
    iridescence_texture: Texture | None = texture_map(
        "iridescenceTexture", "weight of the thin film", of=IRIDESCENCE, channels="R", has_effect=IRIDESCENCE.is_on)
    iridescence_ior: float = parameter(
        1.3, "iridescenceIor", "index of refraction of the film", of=IRIDESCENCE, low=1.0, high=1e9)
    iridescence_thickness_minimum: float = parameter(
        100.0, "iridescenceThicknessMinimum", "thickness of the film where its map is 0", of=IRIDESCENCE, low=0.0,
        unit="nm")
    iridescence_thickness_maximum: float = parameter(
        400.0, "iridescenceThicknessMaximum", "thickness of the film where its map is 1, or without a map",
        of=IRIDESCENCE, low=0.0, unit="nm")
    iridescence_thickness_texture: Texture | None = texture_map(
        "iridescenceThicknessTexture", "thickness of the film, from the minimum to the maximum", of=IRIDESCENCE,
        channels="G", is_applied=True,
        has_effect=lambda m: m.has_film and m.iridescence_thickness_minimum != m.iridescence_thickness_maximum)
    clearcoat: float = parameter(
        0.0, "clearcoatFactor", "weight of the clear coat's reflection", of=CLEARCOAT, low=0.0, high=1.0,
        times="clearcoat.R")
    clearcoat_texture: Texture | None = texture_map(
        "clearcoatTexture", "weight of the clear coat's reflection", of=CLEARCOAT, channels="R",
        has_effect=lambda m: m.clearcoat > 0)
    clearcoat_roughness: float = parameter(
        0.0, "clearcoatRoughnessFactor", "square root of the alpha of the clear coat's microfacets", of=CLEARCOAT,
        low=0.0, high=1.0, times="clearcoat_roughness.G")
    clearcoat_roughness_texture: Texture | None = texture_map(
        "clearcoatRoughnessTexture", "roughness of the clear coat", of=CLEARCOAT, channels="G",
        has_effect=lambda m: m.clearcoat > 0 and m.clearcoat_roughness > 0)
    clearcoat_normal_texture: Texture | None = texture_map(
        "clearcoatNormalTexture", "normal of the clear coat in tangent space, +Y up", of=CLEARCOAT, channels="RGB",
        neutral=(0.5, 0.5, 1.0, 1.0), has_effect=lambda m: m.clearcoat > 0 and m.clearcoat_normal_scale != 0,
        needs_tangents=True, is_normal=True)
    clearcoat_normal_scale: float = parameter(
        1.0, "clearcoatNormalTexture.scale", "scales the x and y of the clear coat's mapped normal", of=CLEARCOAT,
        low=-1e9, high=1e9, role="argument", switch="CLEARCOAT_NORMAL_MAP")
    alpha_mode: AlphaMode = "opaque"
    alpha_cutoff: float = parameter(
        0.5, "alphaCutoff", "if alpha_mode is mask, alpha below the cutoff is a hole", of=CORE, low=0.0,
        role="argument", switch="ALPHA_MODE == 1", unlit=True)
    double_sided: bool = False
    unlit: bool = False
    shininess: float | None = None
    weave: Weave | None = None
    """Of woven cloth, in place of all other parameters."""

    def __post_init__(self) -> None:
        for field in fields(self):
            value, name = getattr(self, field.name), f"Material.{field.name}"
            if value is field.default:
                continue
            if "map" in field.metadata:
                expect(value, Texture, name, "a Texture or None")
            elif "parameter" in field.metadata:
                object.__setattr__(self, field.name, field.metadata["parameter"].checked(value, name, field.default))
        expect(self.name, str, "Material.name", "text")
        if self.alpha_mode not in get_args(AlphaMode):
            raise UsageError(f"Material.alpha_mode is {self.alpha_mode!r}, not one of {', '.join(get_args(AlphaMode))}")
        for key in ("double_sided", "unlit"):
            check_flag(getattr(self, key), f"Material.{key}")
        if self.shininess is not None:
            expect_number(self.shininess, "Material.shininess", 0.0, is_finite=True)
        expect(self.weave, (Weave, NoneType), "Material.weave", "a Weave or None")

    @property
    def is_dielectric(self) -> bool:
        """Whether any point of it may be dielectric."""
        return self.metallic < 1 or self.metallic_roughness_texture is not None

    @property
    def transmits(self) -> bool:
        """Whether it transmits light. Metals transmit none, and a surface with ior 0 reflects everything."""
        return self.transmission > 0 and self.is_dielectric and self.ior >= 1

    @property
    def is_seen_through(self) -> bool:
        """Whether it transmits light that keeps its direction; not where a medium inside scatters nearly all of it."""
        unscattered = np.exp(-self.extinction * self.thickness).mean() if self.medium.scatters else 1.0
        return self.transmits and bool(unscattered > 0.05)

    @property
    def transmits_diffusely(self) -> bool:
        """Whether its diffuse base lets light through to the other side."""
        return (self.diffuse_transmission > 0 and self.is_dielectric) or self.scatters_thinly

    @property
    def scatters_thinly(self) -> bool:
        """Whether it is a thin wall in which transmitted light is scattered."""
        return self.scatter_strength > 0 and self.transmits and self.thickness <= 0

    @property
    def has_film(self) -> bool:
        """Whether any point of it has a film that changes what it reflects. A film of index 1 does not."""
        thickest = self.iridescence_thickness_maximum
        if self.iridescence_thickness_texture is not None:
            thickest = max(thickest, self.iridescence_thickness_minimum)
        return self.iridescence > 0 and self.iridescence_ior > 1 and thickest > 0

    @property
    def has_interface(self) -> bool:
        """Whether light is reflected or refracted at a specular interface below the clear coat; otherwise what lies
        below the coat is diffuse."""
        return self.specular > 0 or self.metallic > 0 or self.transmits or self.has_film

    @property
    def reflects(self) -> bool:
        """Whether it reflects light other than diffusely: at its interface, its fibres or its clear coat."""
        return self.has_interface or self.weave is not None or CLEARCOAT.is_on(self) or SHEEN.is_on(self)

    @property
    def medium(self) -> Medium:
        """What fills the solid that the surface bounds; the vacuum for a surface that bounds none."""
        red, green, blue = self.extinction.tolist()
        if not VOLUME.is_on(self) or not (red or green or blue):
            return VACUUM
        if self.scatter_strength > 0 and self.transmits:
            albedo = single_scattering_albedo(scaled(self.multiscatter_color, self.scatter_strength),
                                              self.multiscatter_anisotropy)
            return Medium((red, green, blue), albedo, self.multiscatter_anisotropy)
        if VOLUME_SCATTER.is_on(self):
            return Medium((red, green, blue), single_scattering_albedo(self.scatter_color), self.scatter_anisotropy)
        return Medium((red, green, blue))

    @property
    def without_medium_scattering(self) -> Material:
        """The same, but that all extinction of its volume is absorption."""
        strength = self.scatter_strength if self.scatters_thinly else 0.0
        return replace(self, scatter_color=(0.0, 0.0, 0.0), scatter_strength=strength)

    @property
    def extinction(self) -> np.ndarray:
        """The extinction coefficient sigma_t of the volume, (3,) float64 per world unit: -ln(color) / distance (Beer's
        law, KHR_materials_volume). What scatters is part of it (KHR_materials_scatter and _volume_scatter)."""
        if not math.isfinite(self.attenuation_distance):
            return np.zeros(3)
        return -np.log(np.clip(self.attenuation_color, 1e-6, 1.0)) / self.attenuation_distance
