"""The directional albedo of a microfacet lobe under Schlick's Fresnel: the DFG table of the split sum (Karis 2013).

    E(NoV, alpha) = integral f(v, l) NoL dl = f0 a + f90 b,     a = <1 - Fc>, b = <Fc>, Fc = (1 - VoH)^5

where <.> weighs the half vectors h by D(h) G2(v, l) VoH / NoV (Walter 2007, the lobe times NoL times the Jacobian
4 VoH). In polar angles of h about n, D NoH dh = dw dphi / 2 pi with w = 1 - CDF of the angle, so

    <X> = integral_0^1 dw (1 / pi) integral_0^phi_max dphi  X G2 VoH / (NoV NoH)

and light leaves above the surface exactly while cos phi > (NoV / (2 NoH) - NoV NoH) / (sin v sin h). The integrand is
smooth but for square roots where that limit reaches the whole circle and where it closes: h at (pi/2 -+ theta_v) / 2.
Gauss-Legendre between those angles, its nodes drawn to the ends by a cosine, errs by 1.5e-3 at most (at grazing) with
24 nodes a side, and by 1e-4 with 64.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from ..resources import resource_folder
from .cache import key, load, store

SIZE = 64  # looked up bilinearly: 6e-5 off on average, 2e-3 at most where NoV and roughness are above 0.1
MIN_COSINE = 1e-4  # where the row of NoV = 0 is evaluated: the limit exists, 0 / 0 does not
MASKINGS = ("smith", "smith-separable", "v-cavity", "none")


@lru_cache(maxsize=4)
def dfg_table(ndf: str = "ggx", masking: str = "smith", size: int = SIZE) -> np.ndarray:
    """a and b, (size, size, 2) float32, read-only.

    Row j is NoV = (j / (size-1))^2, column i perceptual roughness i / (size-1). As a texture that
    is u = roughness, v = sqrt(NoV), each inset by half a texel, as dfg.glsl looks it up. The default comes from the
    package's assets; any other is computed (0.3 s) and kept in the cache on disk.
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
    """The table of `dfg_table`, worked out anew."""
    axis = np.arange(size) / (size - 1)
    table = np.empty((size, size, 2))
    NoV = np.maximum(axis**2, MIN_COSINE)
    for column, perceptual_roughness in enumerate(axis):
        table[:, column] = directional_albedo(ndf, masking, NoV, perceptual_roughness**2, nodes)
    return table.astype(np.float32)


def directional_albedo(ndf: str, masking: str, NoV: np.ndarray, alpha: float, nodes: int = 24) -> np.ndarray:
    """a and b by quadrature, (N, 2) float64, for NoV (N,) in (0, 1]; alpha 0 is the mirror."""
    NoV = np.asarray(NoV, np.float64)
    if alpha == 0:
        mirror = (1 - NoV) ** 5
        return np.stack([1 - mirror, mirror], axis=-1)
    theta_v = np.arccos(np.minimum(NoV, 1.0))
    limits = np.stack([0 * theta_v, (np.pi / 2 - theta_v) / 2, (np.pi / 2 + theta_v) / 2])
    survival = _survival(ndf, np.tan(limits) ** 2, alpha)  # w at the panels' ends, falling from 1
    x, weight = np.polynomial.legendre.leggauss(nodes)
    s, weight = (x + 1) / 2, weight / 2
    drawn, drawn_weight = (1 - np.cos(np.pi * s)) / 2, weight * np.pi / 2 * np.sin(np.pi * s)

    total = np.zeros((len(NoV), 2))
    v = NoV[:, None, None]
    sin_v = np.sin(theta_v)[:, None, None]
    for high, low in zip(survival[:-1], survival[1:]):
        w = low[:, None] + (high - low)[:, None] * drawn
        tan2 = _tan2_at(ndf, np.maximum(w, 1e-300), alpha)[:, :, None]
        NoH = 1 / np.sqrt(1 + tan2)
        sin_h = np.sqrt(tan2) * NoH
        limit = (v / (2 * NoH) - v * NoH) / np.maximum(sin_v * sin_h, 1e-300)
        phi_max = np.arccos(np.clip(limit, -1, 1))
        VoH = v * NoH + sin_v * sin_h * np.cos(phi_max * s)
        NoL = np.maximum(2 * VoH * NoH - v, 1e-12)
        share = _masking(ndf, masking, v, NoL, NoH, VoH, alpha) * VoH / (v * NoH)
        share = share * phi_max / np.pi * weight * ((high - low)[:, None] * drawn_weight)[:, :, None]
        fresnel = np.clip(1 - VoH, 0, 1) ** 5
        b = (share * fresnel).sum(axis=(1, 2))
        total += np.stack([share.sum(axis=(1, 2)) - b, b], axis=-1)
    return total


def _survival(ndf: str, tan2: np.ndarray, alpha: float) -> np.ndarray:
    """w: the share of D NoH at half vectors steeper than this (Walter 2007, eqs. 28, 31, 35)."""
    if ndf == "ggx":
        return alpha**2 / (alpha**2 + tan2)
    if ndf == "beckmann":
        return np.exp(-tan2 / alpha**2)
    return (1 + tan2) ** (-1 / alpha**2)  # cos^(s + 2), s = 2 / alpha^2 - 2


def _tan2_at(ndf: str, survival: np.ndarray, alpha: float) -> np.ndarray:
    if ndf == "ggx":
        return alpha**2 * (1 - survival) / survival
    if ndf == "beckmann":
        return -(alpha**2) * np.log(survival)
    return np.expm1(-(alpha**2) * np.log(survival))


def _masking(ndf: str, masking: str, NoV, NoL, NoH, VoH, alpha: float):
    """G2, by the formulas of shaders/bsdf; Blinn-Phong takes Beckmann's Smith functions there too."""
    if masking == "none":
        return 1.0
    if masking == "v-cavity":
        return np.minimum(1, 2 * NoH * np.minimum(NoV, NoL) / VoH)
    smith = _lambda_ggx if ndf == "ggx" else _lambda_beckmann
    of_view, of_light = smith(NoV, alpha), smith(NoL, alpha)
    if masking == "smith":
        return 1 / (1 + of_view + of_light)
    return 1 / ((1 + of_view) * (1 + of_light))


def _lambda_ggx(cosine, alpha: float):
    return (np.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)) - 1) / 2


def _lambda_beckmann(cosine, alpha: float):
    """The rational fit of Walter 2007, eq. 15, as beckmann.glsl has it."""
    a = cosine / (alpha * np.sqrt(np.maximum(1 - cosine**2, 1e-12)))
    a = np.minimum(a, 1.6)
    return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)
