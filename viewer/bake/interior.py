"""What the raster needs of a scattering medium inside a solid: diffusion, with the albedo of a half-space exact.

Light inside is diffuse where it was scattered more than once, and its fluence obeys laplace(phi) = k^2 phi. At the
boundary of a half-space the ratio of its flux to its fluence is in proportion to k, so that the share of what has
entered that comes out is

    out(x) = (1 - x) / (1 + A x),   x = h k,   A = (1 + F) / (1 - F)

with F the reflectance of the boundary from inside. h is such that out(h k) is exact (viewer/bake/half_space.py). In
other bodies k gets a factor (shaders/raster/interior.glsl). k is the exact rate at which light dies away deep inside
(Case & Zweifel 1967): a artanh(k) / k = 1, in units of the reduced extinction, with the reduced albedo a.

A rough boundary whose facets scatter once loses light, so that even from a white half-space, where x = 0, no more than
a share of it comes out. What comes out of all bodies gets this factor.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache

from ..scene.medium import Medium
from .half_space import internal_reflectance, returned_light
from .rough_boundary import RoughBoundary

_WHITEST = 1.0 - 1e-7
"""Of single scattering. Whiter media have the h of this albedo, whose limit it is."""

RGB = tuple[float, float, float]


@dataclass(frozen=True)
class Interior:
    """`attenuation` k per unit of length, `extrapolation` h in units of length, `shape` s of Burley's profile per unit
    of length, the reduced albedo, and the reduced extinction as a share of the whole, RGB each. `trapped` is A. `kept`
    is the share of light, of what the boundary does not reflect, that a white half-space returns: 1 behind a smooth
    one. `entered` is the mean cosine inside of light that enters from everywhere, over 2/3, which it is without a
    boundary."""

    attenuation: RGB
    extrapolation: RGB
    shape: RGB
    albedo: RGB
    reduced: RGB
    trapped: float
    kept: float
    entered: float


@lru_cache(maxsize=64)
def interior_of(medium: Medium, ior: float, alpha: float = 0.0, masking: str = "smith") -> Interior:
    """The diffusion of light in `medium`, whose extinction is positive, behind a boundary of index `ior`, whose facets
    of roughness `alpha` scatter once, with this `masking`.

    The profile is R(r) = s (e^(-s r) + e^(-s r / 3)) / (8 pi r), of mean distance 2.5 / s, with the fit of s to the
    albedo of a boundary that reflects nothing (Christensen & Burley 2015, "Approximate Reflectance Profiles for
    Efficient Subsurface Scattering"). Light that the boundary sends back goes on: it enters 1 / (1 - albedo F) times
    and gets so much farther. Where g < 0 the profile is too wide.
    """
    ior = max(ior, 1.0)
    boundary = RoughBoundary(ior, alpha, masking)
    rough = boundary if boundary.is_rough else None
    reflected, entering, white = internal_reflectance(ior), 1.0, 1.0
    if rough is not None:
        reflected, _ = rough.shares(is_outside=False)
        missing, passed = rough.shares(is_outside=True)
        near, nearer = (returned_light(1.0 - left, medium.g, ior, rough) for left in (4e-7, 1e-7))
        entering, white = passed / (1.0 - missing), 2.0 * nearer - near  # what a medium keeps is as sqrt(1 - albedo)
    trapped = (1.0 + reflected) / (1.0 - reflected)
    channels = [_channel(sigma_t, albedo, medium.g, ior, trapped, rough, white)
                for sigma_t, albedo in zip(medium.sigma_t, medium.albedo, strict=True)]
    k, h, s, reduced_albedo, reduced = zip(*channels, strict=True)
    entered = ior**2 * (1.0 - (1.0 - ior**-2) ** 1.5)  # the integral of mu' 3 mu dmu, with refraction from mu to mu'
    return Interior(k, h, s, reduced_albedo, reduced, trapped, entering * white, entered)


def _channel(sigma_t: float, albedo: float, g: float, ior: float, trapped: float, rough: RoughBoundary | None,
             white: float) -> tuple[float, float, float, float, float]:
    """k, h, s, the reduced albedo, and the reduced extinction over the whole, of one channel. `white` is the share that
    a white half-space returns."""
    sigma_t, whitest = max(sigma_t, 1e-30), min(albedo, _WHITEST)
    reduced = 1.0 - whitest * g  # extinction where what is scattered straight on counts as unscattered
    reduced_albedo = whitest * (1.0 - g) / reduced
    rate = decay_rate(reduced_albedo) * reduced
    share, unbounded = returned_light(whitest, g, ior, rough) / white, returned_light(whitest, g, 1.0)
    x = (1.0 - share) / (1.0 + trapped * share)
    reflected = (trapped - 1.0) / (trapped + 1.0)
    s = (1.9 - unbounded + 3.5 * (unbounded - 0.8) ** 2) * (1.0 - unbounded * reflected) * reduced
    return (rate * sigma_t if albedo < _WHITEST else 0.0), x / (rate * sigma_t), s * sigma_t, reduced_albedo, reduced


def decay_rate(albedo: float) -> float:
    """k in (0, 1] with albedo artanh(k) / k = 1: light deep inside a medium of isotropic scattering and extinction 1
    dies away as e^(-k z). By bisection."""
    if albedo <= 0.0:
        return 1.0
    if albedo > 1.0 - 1e-6:
        return math.sqrt(3.0 * (1.0 - albedo))
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if middle >= 1.0 or albedo * math.atanh(middle) > middle else (middle, high)
    return 0.5 * (low + high)
