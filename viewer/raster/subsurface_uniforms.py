"""The uniforms of shaders/raster/subsurface.glsl that follow from a material."""

from __future__ import annotations

from collections.abc import Iterator

from ..bake.interior import Interior, interior_of
from ..scene.material import Material

_LIMIT = 1e15
"""Lengths and their inverses in shaders, in radii of the scene. Their squares are floats."""


def interior_uniforms(material: Material, unit: float) -> Iterator[tuple[str, object]]:
    """The medium inside of `material`, in lengths of `unit`. Behind a diffuse boundary its index is that outside."""
    inside: Interior = interior_of(material.medium, material.ior if material.transmits else 1.0)
    yield "u_interior_attenuation", tuple(min(k * unit, _LIMIT) for k in inside.attenuation)
    yield "u_interior_extrapolation", tuple(min(h / unit, _LIMIT) for h in inside.extrapolation)
    yield "u_interior_shape", tuple(min(max(s * unit, 1.0 / _LIMIT), _LIMIT) for s in inside.shape)
    yield "u_interior_albedo", inside.albedo
    yield "u_interior_reflected", (inside.trapped - 1.0) / (inside.trapped + 1.0)
