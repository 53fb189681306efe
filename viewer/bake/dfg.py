"""What a microfacet lobe does with light from all around: the split sum's DFG table (Karis 2013), and where to look.

    E(NoV, alpha) = integral f(v, l) NoL dl = f0 a + f90 b,     a = <1 - Fc>, b = <Fc>, Fc = (1 - VoH)^5

where <.> weighs the half vectors h by D(h) G2(v, l) VoH / NoV (Walter 2007, the lobe times NoL times the Jacobian
4 VoH). In polar angles of h about n, D NoH dh = dw dphi / 2 pi with w = 1 - CDF of the angle, so

    <X> = integral_0^1 dw (1 / pi) integral_0^phi_max dphi  X G2 VoH / (NoV NoH)

and light leaves above the surface exactly while cos phi > (NoV / (2 NoH) - NoV NoH) / (sin v sin h). The integrand is
smooth but for square roots where that limit reaches the whole circle and where it closes: h at (pi/2 -+ theta_v) / 2.
The environment is filtered for a lobe seen along the normal (n = v = r). Seen at a slant the lobe leans from the mirror
direction r towards n and changes its width (Lagarde & de Rousiers 2014, "Frostbite", section 4.9.3, fit the first), and
what Fresnel adds, b, leans the other way. So each of the two parts is looked up on its own, by its first moment
M = <l>: the direction is that of M, kept as the share t of r in mix(n, r, t), and the roughness is the one whose filter
has lambda_1 = |M| / <1>. Against the integral, in four of our test environments and all directions, the logarithm of a
rough dielectric's reflection then errs by 0.2 (RMS) where r itself and the surface's roughness err by 0.5 to 0.7.

Gauss-Legendre between those angles, its nodes drawn to the ends by a cosine, errs by 1.5e-3 at most (at grazing) with
24 nodes a side, and by 1e-4 with 64.
"""

from __future__ import annotations

from functools import lru_cache
from itertools import pairwise

import numpy as np

from ..base.resources import resource_folder
from .cache import key, load, store
from .lobes import lobe_spectrum

SIZE = 64  # looked up bilinearly: 6e-5 off on average, 2e-3 at most where NoV and roughness are above 0.1
MIN_COSINE = 1e-4  # where the row of NoV = 0 is evaluated: the limit exists, 0 / 0 does not
SHARES = (-0.5, 5.0)  # bounds on t: near the normal, where r is n and t is idle, that of b grows without end


@lru_cache(maxsize=4)
def dfg_table(ndf: str = "ggx", masking: str = "smith", size: int = SIZE) -> np.ndarray:
    """a, b, t of a, t of b; below them the roughness to look up a and b with, their means. (2 size, size, 4) float32.

    The means, 2 int a mu dmu and 2 int b mu dmu, are those of the table as it is looked up, the same in all rows.

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
    albedo, look_up = np.empty((size, size, 4)), np.zeros((size, size, 4))
    NoV = np.maximum(axis**2, MIN_COSINE)
    NoV[-1] = np.cos(1e-3)  # at the normal itself n and r coincide and t is 0 / 0; its limit is reached here
    concentration = _filter_concentration(ndf)
    for column, perceptual_roughness in enumerate(axis):
        moments = lobe_moments(ndf, masking, NoV, perceptual_roughness**2, nodes)
        albedo[:, column, :2] = moments[..., 0]
        albedo[:, column, 2:] = _share_of_mirror(moments[..., 1:], NoV[:, None])
        # np.interp wants the abscissa to rise; the concentration falls with roughness.
        length = np.linalg.norm(moments[..., 1:], axis=2) / np.maximum(moments[..., 0], 1e-60)
        look_up[:, column, :2] = np.interp(-length, -concentration[:, 1], concentration[:, 0])
    look_up[..., 2:] = hemispherical_mean(albedo[..., :2])
    return np.concatenate([albedo, look_up]).astype(np.float32)


def hemispherical_mean(albedo: np.ndarray) -> np.ndarray:
    """Means of a and b over the hemisphere, (size, 2), of their table (size, size, 2).

    With v = sqrt(mu), 2 int E mu dmu = int E 4 v^3 dv, exact for E linear in v between the rows. Where a + b passes 1,
    without masking, the two are taken in proportion from 1: no light is missing there.
    """
    limited = albedo / np.maximum(albedo.sum(axis=-1, keepdims=True), 1.0)
    v = np.linspace(0, 1, len(albedo))
    whole, moment = np.diff(v**4), np.diff(0.8 * v**5)
    upper = (moment - v[:-1] * whole) / np.diff(v)
    weight = np.append(whole - upper, 0) + np.append(0, upper)
    return np.einsum("j,jic->ic", weight, limited)


def _filter_concentration(ndf: str) -> np.ndarray:
    """Perceptual roughness and lambda_1 of the environment's filter for it, (65, 2), from the mirror to roughness 1."""
    roughness = np.linspace(0, 1, 65)
    return np.array([(r, lobe_spectrum(ndf, r * r, 1)[1] if r > 0.01 else 1.0) for r in roughness])


def _share_of_mirror(mean: np.ndarray, NoV: np.ndarray) -> np.ndarray:
    """t of the mix(n, r, t) along `mean` (..., 2), which is given along the normal and the tangent r leans to.

    tan(theta_m) = t sin / (1 - t + t cos), with r's angle theta_v = acos(NoV), solved for t.
    """
    along_n, along_t = mean[..., 0], mean[..., 1]
    share = along_t / np.maximum(np.sqrt(1 - NoV**2) * along_n + (1 - NoV) * along_t, 1e-60)
    return np.clip(share, *SHARES)


def directional_albedo(ndf: str, masking: str, NoV: np.ndarray, alpha: float, nodes: int = 24) -> np.ndarray:
    """a and b by quadrature, (N, 2) float64, for NoV (N,) in (0, 1]; alpha 0 is the mirror."""
    return lobe_moments(ndf, masking, NoV, alpha, nodes)[..., 0]


def lobe_moments(ndf: str, masking: str, NoV: np.ndarray, alpha: float, nodes: int = 24) -> np.ndarray:
    """Of a and of b: <1>, and <l> along n and along the tangent the mirror direction leans to, (N, 2, 3) float64."""
    NoV = np.asarray(NoV, np.float64)
    if alpha == 0:
        mirror = (1 - NoV) ** 5
        moments = np.stack([np.ones_like(NoV), NoV, np.sqrt(1 - NoV**2)], axis=-1)
        return np.stack([1 - mirror, mirror], axis=-1)[..., None] * moments[:, None]
    theta_v = np.arccos(np.minimum(NoV, 1.0))
    limits = np.stack([0 * theta_v, (np.pi / 2 - theta_v) / 2, (np.pi / 2 + theta_v) / 2])
    survival = _survival(ndf, np.tan(limits) ** 2, alpha)  # w at the panels' ends, falling from 1
    x, weight = np.polynomial.legendre.leggauss(nodes)
    s, weight = (x + 1) / 2, weight / 2
    drawn, drawn_weight = (1 - np.cos(np.pi * s)) / 2, weight * np.pi / 2 * np.sin(np.pi * s)

    total = np.zeros((len(NoV), 2, 3))
    v = NoV[:, None, None]
    sin_v = np.sin(theta_v)[:, None, None]
    for high, low in pairwise(survival):
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
        toward_mirror = sin_v - 2 * VoH * sin_h * np.cos(phi_max * s)
        for part, weights in enumerate((share * (1 - fresnel), share * fresnel)):
            total[:, part] += np.stack([(weights * f).sum(axis=(1, 2)) for f in (1, NoL, toward_mirror)], axis=-1)
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


def _masking(ndf: str, masking: str, NoV: np.ndarray, NoL: np.ndarray, NoH: np.ndarray, VoH: np.ndarray,
             alpha: float) -> np.ndarray | float:
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


def _lambda_ggx(cosine: np.ndarray, alpha: float) -> np.ndarray:
    return (np.sqrt(1 + alpha**2 * (1 / cosine**2 - 1)) - 1) / 2


def _lambda_beckmann(cosine: np.ndarray, alpha: float) -> np.ndarray:
    """The rational fit of Walter 2007, eq. 15, as beckmann.glsl has it."""
    a = cosine / (alpha * np.sqrt(np.maximum(1 - cosine**2, 1e-12)))
    a = np.minimum(a, 1.6)
    return np.where(a < 1.6, (1 - 1.259 * a + 0.396 * a * a) / (3.535 * a + 2.181 * a * a), 0.0)
