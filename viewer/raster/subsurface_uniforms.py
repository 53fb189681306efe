"""The uniforms of shaders/raster/subsurface.glsl that follow from a material."""

from __future__ import annotations

from collections.abc import Iterator

from ..bake.interior import Interior, interior_of
from ..plan.model import Draw
from ..settings import MASKINGS
from .textures import Textures

_LIMIT = 1e15
"""Lengths and their inverses in shaders, in radii of the scene. Their squares are floats."""


def interior_uniforms(draw: Draw, textures: Textures, unit: float) -> Iterator[tuple[str, object]]:
    """The medium inside of what is drawn, in lengths of `unit`. Its boundary is rough where its facets scatter once,
    and loses nothing, as a smooth one, where what they lose is compensated. Behind a diffuse boundary its index is that
    outside."""
    material, program = draw.surface, draw.program
    is_lossy = material.transmits and not program["MULTISCATTER"]
    roughness = _mean_roughness(draw, textures) if is_lossy else 0.0
    inside: Interior = interior_of(material.medium, material.ior if material.transmits else 1.0, roughness**2,
                                   MASKINGS[program["MASKING"]])
    yield "u_interior_attenuation", tuple(min(k * unit, _LIMIT) for k in inside.attenuation)
    yield "u_interior_extrapolation", tuple(min(h / unit, _LIMIT) for h in inside.extrapolation)
    yield "u_interior_shape", tuple(min(max(s * unit, 1.0 / _LIMIT), _LIMIT) for s in inside.shape)
    yield "u_interior_albedo", inside.albedo
    yield "u_interior_reduced", inside.reduced
    yield "u_interior_entered", inside.entered
    yield "u_interior_reflected", (inside.trapped - 1.0) / (inside.trapped + 1.0)
    yield "u_interior_kept", inside.kept


def _mean_roughness(draw: Draw, textures: Textures) -> float:
    is_mapped = draw.surface.metallic_roughness_texture is not None and "metallic_roughness" in draw.maps
    share = float(textures.mean(draw, "metallic_roughness")[1]) if is_mapped else 1.0
    return draw.surface.perceptual_roughness * share
