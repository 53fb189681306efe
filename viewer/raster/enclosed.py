"""The light of the environment inside of what thin walls enclose, as in a hollow ball of glass."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache

import numpy as np

from ..bake.half_space import fresnel
from ..plan.model import Draw
from ..scene.mesh import Mesh

Mean = Callable[[Draw, str], np.ndarray]
"""Of a map of a draw, red, green, blue and alpha."""


def light_inside(draw: Draw, mesh: Mesh, mean: Mean) -> np.ndarray:
    """What arrives at the inner sides of a thin wall, (3,), as a share of the light around it.

    A wall that passes t and reflects r of the light on either side, and of which the inner side sees an opening by the
    share o, is an integrating sphere with the sources o and (1 - o) t: inside is (o + (1 - o) t) / (1 - (1 - o) r).
    """
    material = draw.surface

    def mapped(name: str, channel: int | slice) -> np.ndarray | float:
        return mean(draw, name)[channel] if name in draw.maps else 1.0

    mirrored = _reflected(material.ior, material.specular)
    metallic = material.metallic * mapped("metallic_roughness", 2)
    transmitted = material.transmission * mapped("transmission", 0)
    color = np.clip(np.multiply(material.base_color[:3], mapped("base_color", slice(3))), 0.0, 1.0)
    covered = 1.0
    if material.alpha_mode != "opaque":
        covered = min(material.base_color[3] * mapped("base_color", 3), 1.0)
    passed = (1.0 - metallic) * (1.0 - mirrored) * transmitted * color
    returned = metallic * color + (1.0 - metallic) * (mirrored + (1.0 - mirrored) * (1.0 - transmitted) * color)
    opening = 1.0 - (1.0 - mesh.opening) * covered
    return (opening + (1.0 - opening) * passed) / np.maximum(1.0 - (1.0 - opening) * returned, 1e-6)


@lru_cache(maxsize=256)
def _reflected(ior: float, specular: float) -> float:
    """The reflectance of both faces of a thin wall, R' = 2 R / (1 + R), for light from all around."""
    x, w = np.polynomial.legendre.leggauss(32)
    mu = 0.5 * (x + 1.0)
    single = specular * fresnel(mu, max(ior, 1.0))
    return float((w * mu) @ (2.0 * single / (1.0 + single)))
