"""The DFG table of the split-sum approximation (Karis 2013): the directional albedo of a microfacet lobe, and the
direction and roughness to look up the prefiltered environment with.

    E(NoV, alpha) = integral f(v, l) NoL dl = f0 a + f90 b,     a = <1 - Fc>, b = <Fc>, Fc = (1 - VoH)^5

Here <.> is the integral over half vectors h weighted by D(h) G2(v, l) VoH / NoV (Walter 2007: the lobe times NoL times
the Jacobian 4 VoH). In polar coordinates of h about n, D NoH dh = dw dphi / 2 pi with w = 1 - CDF of the polar angle:

    <X> = integral_0^1 dw (1 / pi) integral_0^phi_max dphi  X G2 VoH / (NoV NoH)

The light direction l is above the surface exactly if cos phi > (NoV / (2 NoH) - NoV NoH) / (sin v sin h). The integrand
is smooth except for square roots at the two polar angles (pi/2 -+ theta_v) / 2 of h: up to the first the whole circle
of phi is above the surface, and from the second on nothing is.

The environment is prefiltered for a lobe seen along the normal (n = v = r). For an oblique view the lobe leans from the
mirror direction r towards n and changes its width (Lagarde & de Rousiers 2014, "Frostbite", section 4.9.3, fit the
direction). The Fresnel part b leans the other way. So the parts a and b are looked up separately, each by its first
moment M = <l>. The direction is that of M, stored as t in mix(n, r, t). The roughness is the one whose filter has
lambda_1 = |M| / <1>. Compared with the integral, for a rough dielectric in four test environments and all directions,
the logarithm of the reflected radiance then has an RMS error of 0.2; with r and the surface's roughness it is 0.5 to
0.7.

The integrals over w use Gauss-Legendre quadrature between these angles, with a cosine substitution that moves nodes
towards the ends. The error is at most 1.5e-3 (at grazing angles) with 24 nodes per side, and 1e-4 with 64.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..base.resources import resource_folder
from .cache import key, load, store
from .lobes import lobe_spectrum

SIZE = 64  # the error of bilinear lookups is 6e-5 on average, and at most 2e-3 for NoV and roughness above 0.1
MIN_COSINE = 1e-4  # NoV at which the row for 0 is evaluated: the limit exists, but 0 / 0 is undefined
T_BOUNDS = (-0.5, 5.0)  # bounds of t: near the normal r = n, so t has no effect, but that of b tends to infinity


@lru_cache(maxsize=4)
def dfg_table(ndf: str = "ggx", masking: str = "smith", size: int = SIZE) -> np.ndarray:
    """The DFG table, (2 size, size, 4) float32.

    The upper half has a, b, t of a and t of b. The lower half has the roughness to look up a with, that for b, and the
    hemispherical means of a and b. The means 2 int a mu dmu and 2 int b mu dmu are those of the table as shaders read
    it; they are the same in all rows.

    Row j of each half is NoV = (j / (size-1))^2; column i is perceptual roughness i / (size-1). In texture coordinates
    that is u = roughness and v = sqrt(NoV), each inset by half a texel (shaders/light/dfg.glsl). The default table is
    in the package's assets. Any other is computed (0.3 s) and stored in the cache on disk.
    """
    if (ndf, masking, size) == ("ggx", "smith", SIZE):
        table = np.load(resource_folder("assets") / "dfg_ggx_smith.npy", allow_pickle=False)
    else:
        cache_key = key("dfg", ndf, masking, size)
        cached = load(cache_key)
        table = cached["table"] if cached else compute_dfg_table(ndf, masking, size)
        if not cached:
            store(cache_key, {"table": table})
    table.flags.writeable = False
    return table


def compute_dfg_table(ndf: str, masking: str, size: int, nodes: int = 24) -> np.ndarray:
    """Computes the table of `dfg_table` with `nodes` quadrature nodes per side."""
    axis = np.arange(size) / (size - 1)
    upper, lower = np.empty((size, size, 4)), np.zeros((size, size, 4))
    NoV = np.maximum(axis**2, MIN_COSINE)
    NoV[-1] = np.cos(1e-3)  # for v = n, r = n and t is 0 / 0; this close to the normal t has reached its limit
    concentration = _filter_concentration(ndf)
    for column, perceptual_roughness in enumerate(axis):
        moments = lobe_moments(ndf, masking, NoV, perceptual_roughness**2, nodes)
        upper[:, column, :2] = moments[..., 0]
        upper[:, column, 2:] = _lookup_direction(moments[..., 1:], NoV[:, None])
        # np.interp needs increasing abscissas; the concentration decreases with roughness.
        length = np.linalg.norm(moments[..., 1:], axis=2) / np.maximum(moments[..., 0], 1e-60)
        lower[:, column, :2] = np.interp(-length, -concentration[:, 1], concentration[:, 0])
    lower[..., 2:] = hemispherical_mean(upper[..., :2])
    return np.concatenate([upper, lower]).astype(np.float32)


def hemispherical_mean(albedo: np.ndarray) -> np.ndarray:
    """The means of a and b over the hemisphere, (size, 2), from their table (size, size, 2).

    With v = sqrt(mu), 2 int E mu dmu = int E 4 v^3 dv. The result is exact for E linear in v between the rows. Without
    masking a + b may exceed 1; both are then divided by a + b, so that no light counts as missing.
    """
    limited = albedo / np.maximum(albedo.sum(axis=-1, keepdims=True), 1.0)
    v = np.linspace(0, 1, len(albedo))
    whole, moment = np.diff(v**4), np.diff(0.8 * v**5)
    upper = (moment - v[:-1] * whole) / np.diff(v)
    weight = np.append(whole - upper, 0) + np.append(0, upper)
    return np.einsum("j,jic->ic", weight, limited)


def _filter_concentration(ndf: str) -> np.ndarray:
    """Perceptual roughness from 0 to 1, and lambda_1 of the environment's filter for it, (65, 2)."""
    roughness = np.linspace(0, 1, 65)
    return np.array([(r, lobe_spectrum(ndf, r * r, 1)[1] if r > 0.01 else 1.0) for r in roughness])


def _lookup_direction(mean: np.ndarray, NoV: np.ndarray) -> np.ndarray:
    """The t for which mix(n, r, t) has the direction of `mean`.

    `mean` (..., 2) has the components along the normal and along the projection of r onto the tangent plane. t solves
    tan(theta_m) = t sin(theta_v) / (1 - t + t cos(theta_v)), where theta_v = acos(NoV) is the angle of r.
    """
    along_n, along_t = mean[..., 0], mean[..., 1]
    t = along_t / np.maximum(np.sqrt(1 - NoV**2) * along_n + (1 - NoV) * along_t, 1e-60)
    return np.clip(t, *T_BOUNDS)


def directional_albedo(ndf: str, masking: str, NoV: np.ndarray, alpha: float, nodes: int = 24) -> np.ndarray:
    """a and b by quadrature, (N, 2) float64, for NoV (N,) in (0, 1]; alpha 0 is a mirror."""
    return lobe_moments(ndf, masking, NoV, alpha, nodes)[..., 0]


def lobe_moments(ndf: str, masking: str, NoV: np.ndarray, alpha: float, nodes: int = 24) -> np.ndarray:
    """The moments of the parts a and b, (N, 2, 3) float64: <1>, and <l> along n and along the projection of the mirror
    direction onto the tangent plane."""
    NoV = np.asarray(NoV, np.float64)
    if alpha == 0:
        mirror = (1 - NoV) ** 5
        moments = np.stack([np.ones_like(NoV), NoV, np.sqrt(1 - NoV**2)], axis=-1)
        return np.stack([1 - mirror, mirror], axis=-1)[..., None] * moments[:, None]
    theta_v = np.arccos(np.minimum(NoV, 1.0))
    limits = np.stack([0 * theta_v, (np.pi / 2 - theta_v) / 2, (np.pi / 2 + theta_v) / 2])
    survival = _survival(ndf, np.tan(limits) ** 2, alpha)  # w at the ends of the panels, decreasing from 1
    x, weight = np.polynomial.legendre.leggauss(nodes)
    s, weight = (x + 1) / 2, weight / 2
    warped, warped_weight = (1 - np.cos(np.pi * s)) / 2, weight * np.pi / 2 * np.sin(np.pi * s)

    total = np.zeros((len(NoV), 2, 3))
    v = NoV[:, None, None]
    sin_v = np.sin(theta_v)[:, None, None]
    for high, low in pairwise(survival):
        w = low[:, None] + (high - low)[:, None] * warped
        tan2 = _tan2_at(ndf, np.maximum(w, 1e-300), alpha)[:, :, None]
        NoH = 1 / np.sqrt(1 + tan2)
        sin_h = np.sqrt(tan2) * NoH
        limit = (v / (2 * NoH) - v * NoH) / np.maximum(sin_v * sin_h, 1e-300)
        phi_max = np.arccos(np.clip(limit, -1, 1))
        VoH = v * NoH + sin_v * sin_h * np.cos(phi_max * s)
        NoL = np.maximum(2 * VoH * NoH - v, 1e-12)
        integrand = _masking(ndf, masking, v, NoL, NoH, VoH, alpha) * VoH / (v * NoH)
        integrand = integrand * phi_max / np.pi * weight * ((high - low)[:, None] * warped_weight)[:, :, None]
        fresnel = np.clip(1 - VoH, 0, 1) ** 5
        l_tangent = sin_v - 2 * VoH * sin_h * np.cos(phi_max * s)  # component of l on the side of the mirror direction
        for part, weights in enumerate((integrand * (1 - fresnel), integrand * fresnel)):
            total[:, part] += np.stack([(weights * f).sum(axis=(1, 2)) for f in (1, NoL, l_tangent)], axis=-1)
    return total


def _survival(ndf: str, tan2: np.ndarray, alpha: float) -> np.ndarray:
    """w = 1 - CDF: the integral of D NoH over half vectors with a larger polar angle (Walter 2007, eqs. 28, 31, 35)."""
    if ndf == "ggx":
        return alpha**2 / (alpha**2 + tan2)
    if ndf == "beckmann":
        return np.exp(-tan2 / alpha**2)
    return (1 + tan2) ** (-1 / alpha**2)  # cos^(s + 2), s = 2 / alpha^2 - 2


def _tan2_at(ndf: str, survival: np.ndarray, alpha: float) -> np.ndarray:
    """The inverse of `_survival`."""
    if ndf == "ggx":
        return alpha**2 * (1 - survival) / survival
    if ndf == "beckmann":
        return -(alpha**2) * np.log(survival)
    return np.expm1(-(alpha**2) * np.log(survival))


def _masking(ndf: str, masking: str, NoV: np.ndarray, NoL: np.ndarray, NoH: np.ndarray, VoH: np.ndarray,
             alpha: float) -> np.ndarray | float:
    """G2, by the formulas of shaders/bsdf. As there, Blinn-Phong uses the Smith functions of Beckmann."""
    if masking == "none":
        return 1.0
    if masking == "v-cavity":
        return np.minimum(1, 2 * NoH * np.minimum(NoV, NoL) / VoH)
    smith = _lambda_ggx if ndf == "ggx" else _lambda_beckmann
    lambda_v, lambda_l = smith(NoV, alpha), smith(NoL, alpha)
    if masking == "smith":
        return 1 / (1 + lambda_v + lambda_l)
    return 1 / ((1 + lambda_v) * (1 + lambda_l))


def _lambda_ggx(cosine: np.ndarray, alpha: float) -> np.ndarray:
    return (np.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)) - 1) / 2


def _lambda_beckmann(cosine: np.ndarray, alpha: float) -> np.ndarray:
    """The rational fit of Walter 2007, eq. 15, as in shaders/bsdf/beckmann.glsl."""
    a = cosine / (alpha * np.sqrt(np.maximum(1 - cosine**2, 1e-12)))
    a = np.minimum(a, 1.6)
    return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)
