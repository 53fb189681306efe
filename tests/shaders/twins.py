"""The shaders' lobes in float64, from the papers: slopes, complex indices and plain quotients where GLSL has none.

Directions are (..., 3) in the local frame, z the normal; functions without a struct take arrays of one shape.

These are deliberately independent of viewer/measure/check/reference.py, which users run: neither imports the other, so
that a slip would have to be made twice to go unnoticed.
"""

from __future__ import annotations

from functools import cache, lru_cache
from math import lgamma

import numpy as np
import thin_film

_log_gamma = np.vectorize(lgamma, otypes=[float])


def dot(a, b):
    return (a * b).sum(axis=-1)


def unit(v):
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def schlick(f0, f90, mu):
    """Schlick 1994, eq. 15; colours (..., 3), mu (...)."""
    return f0 + (f90 - f0) * (1 - np.asarray(mu)[..., None]) ** 5


def fresnel(mu, index):
    """Unpolarised reflectance at an interface of relative complex `index` (Born & Wolf, sections 1.5.2 and 14.2)."""
    index = np.asarray(index, complex)
    transmitted = np.sqrt(1 - (1 - mu**2) / index**2)
    s = (mu - index * transmitted) / (mu + index * transmitted)
    p = (index * mu - transmitted) / (index * mu + transmitted)
    return (np.abs(s) ** 2 + np.abs(p) ** 2) / 2


def f82_tint(f0, tint, mu):
    """Kutz et al. 2021: Schlick's curve less a multiple of mu (1 - mu)^6 that makes it `tint` times itself at 1/7."""
    mu = np.asarray(mu)[..., None]
    bar = 1 / 7
    s_bar = f0 + (1 - f0) * (1 - bar) ** 5
    b = s_bar * (1 - tint) / (bar * (1 - bar) ** 6)
    return np.maximum(f0 + (1 - f0) * (1 - mu) ** 5 - b * mu * (1 - mu) ** 6, 0)


def hemispherical_mean(f, nodes: int = 200):
    """2 int f(mu) mu dmu."""
    x, weight = np.polynomial.legendre.leggauss(nodes)
    return sum(w * (t + 1) / 2 * f((t + 1) / 2) for t, w in zip(x, weight))


def ggx_d(h, alpha):
    """Heitz 2014, eqs. 83 to 85: the density of slopes over cos^4."""
    slope = -h[..., :2] / h[..., 2:]
    p22 = 1 / (np.pi * alpha[..., 0] * alpha[..., 1] * (1 + ((slope / alpha) ** 2).sum(axis=-1)) ** 2)
    return p22 / h[..., 2] ** 4


def ggx_lambda(w, alpha):
    """Heitz 2014, eqs. 72 and 86, by the roughness along w and the tangent of its angle."""
    s2 = w[..., 0] ** 2 + w[..., 1] ** 2
    projected2 = np.where(s2 > 0, ((alpha * w[..., :2]) ** 2).sum(axis=-1) / np.maximum(s2, 1e-300), 0)
    return _ggx_lambda_of(projected2 * s2 / w[..., 2] ** 2)


def _ggx_lambda_of(x):
    """By x = (alpha tan theta)^2."""
    return np.where(x > 1e-6, (np.sqrt(1 + x) - 1) / 2, x / 4 - x * x / 16)


def ggx_reflection(alpha, wo, wi):
    """D G2 / (4 NoV NoL) and VoH."""
    h = unit(wo + wi)
    g2 = 1 / (1 + ggx_lambda(wo, alpha) + ggx_lambda(wi, alpha))
    return ggx_d(h, alpha) * g2 / (4 * wo[..., 2] * wi[..., 2]), dot(wo, h)


def beta(x, y):
    return np.exp(_log_gamma(x) + _log_gamma(y) - _log_gamma(x + y))


def ggx_albedo(NoV, alpha: float, f0=1.0, f90=1.0):
    """Directional albedo by Heitz 2018's visible normals ("Sampling the GGX Distribution of Visible Normals").

    On a Fibonacci lattice, to 3e-4.
    """
    white, grazing = _ggx_albedos(tuple(np.asarray(NoV, float).ravel()), alpha)
    return f0 * (white - grazing) + f90 * grazing  # Schlick's F is linear in f0 and f90


@lru_cache(maxsize=256)
def _ggx_albedos(cosines: tuple[float, ...], alpha: float):
    """The albedo at F = 1, and at f0 = 0, f90 = 1."""
    out = np.empty((2, len(cosines)))
    for k, NoV in enumerate(cosines):
        VoH, share = visible_normals(NoV, alpha)
        out[:, k] = share.sum(), (share * (1 - VoH) ** 5).sum()
    return out


@cache
def _disk():
    """A Fibonacci lattice on the unit disk: its points x and y, and sqrt(1 - x^2)."""
    i = np.arange(17711)
    u1, u2 = (i + 0.5) / len(i), (i * 10946 / len(i)) % 1
    r, phi = np.sqrt(u1), 2 * np.pi * u2
    x = r * np.cos(phi)
    return x, r * np.sin(phi), np.sqrt(np.maximum(1 - x**2, 0))


@lru_cache(maxsize=256)
def visible_normals(NoV: float, alpha: float):
    """VoH of visible normals that reflect upwards, and G2 / G1(o) over their number.

    Heitz 2018's steps by components: o and v lie in the plane of x and z, and T1 is along y.
    """
    p1, across, side = _disk()
    o_x, o_z = np.sqrt(1 - NoV**2), NoV
    v_x, v_z = np.array([alpha * o_x, o_z]) / np.hypot(alpha * o_x, o_z)
    s = (1 + v_z) / 2
    p2 = (1 - s) * side + s * across
    along_v = np.sqrt(np.maximum(1 - p1**2 - p2**2, 0))
    h_x, h_y, h_z = alpha * (along_v * v_x - p2 * v_z), alpha * p1, np.maximum(along_v * v_z + p2 * v_x, 1e-9)
    length = np.sqrt(h_x**2 + h_y**2 + h_z**2)
    OoH = (o_x * h_x + o_z * h_z) / length
    wi_z = 2 * OoH * h_z / length - o_z
    up = wi_z > 1e-12
    lambda_o, lambda_i = (_ggx_lambda_of(alpha**2 * (1 - z**2) / z**2) for z in (o_z, wi_z[up]))
    return np.clip(OoH[up], 0, 1), (1 + lambda_o) / (1 + lambda_o + lambda_i) / len(p1)


@lru_cache
def ggx_mean_albedo(alpha: float, f0=1.0, f90=1.0) -> float:
    x, weight = np.polynomial.legendre.leggauss(24)
    mu = (x + 1) / 2
    return float((weight * mu * ggx_albedo(mu, alpha, f0, f90)).sum())


def kulla_conty(alpha: float, mean, NoV, NoL):
    """Kulla & Conty 2017, isotropic; `mean` (..., 3) is the hemispherical mean of F."""
    E_mean = ggx_mean_albedo(alpha)
    scale = mean**2 * E_mean / (1 - mean * (1 - E_mean))
    lost = (1 - ggx_albedo(NoV, alpha)) * (1 - ggx_albedo(NoL, alpha))
    return scale * (lost / (np.pi * (1 - E_mean)))[..., None]


def lambert(m, wo, wi):
    return m["albedo"] / np.pi


def burley(m, wo, wi):
    """Burley 2012, section 5.3."""
    cos_d = dot(wi, unit(wo + wi))
    f90 = 0.5 + 2 * m["perceptual_roughness"] * cos_d**2
    light, view = (1 + (f90 - 1) * (1 - w[..., 2]) ** 5 for w in (wi, wo))
    return m["albedo"] / np.pi * (light * view)[..., None]


def eon(m, wo, wi):
    """Portsmouth, Kutz & Hill 2024: single scattering of eq. 13 with its A, and the multiple one of eqs. 18 to 29."""
    sigma, rho = m["sigma"], m["albedo"]
    A = 1 / (1 + (0.5 - 2 / (3 * np.pi)) * sigma)
    mu_i, mu_o = wi[..., 2], wo[..., 2]
    s = dot(wi, wo) - mu_i * mu_o
    s_over_t = np.where(s > 0, s / np.maximum(mu_i, mu_o), s)
    single = rho / np.pi * (A * (1 + sigma * s_over_t))[..., None]

    def E(mu):
        theta = np.arccos(mu)
        G = np.sin(theta) * (theta - np.sin(theta) * np.cos(theta))
        G += 2 / 3 * (np.tan(theta) * (1 - np.sin(theta) ** 3) - np.sin(theta))
        return A * (1 + sigma / np.pi * G)

    E_mean = A * (1 + (2 / 3 - 28 / (15 * np.pi)) * sigma)
    rho_ms = rho**2 * E_mean[..., None] / (1 - rho * (1 - E_mean)[..., None])
    with np.errstate(invalid="ignore"):
        multiple = rho_ms / np.pi * ((1 - E(mu_i)) * (1 - E(mu_o)) / (1 - E_mean))[..., None]
    return single + np.where(sigma[..., None] > 1e-4, multiple, 0)


def phong(m, wo, wi):
    """Lafortune & Willems 1994, eq. 8, about the mirrored wo."""
    c = dot(wi, wo * [-1, -1, 1])
    power = np.where(c > 0, np.maximum(c, 1e-300) ** m["shininess"], 0)
    return m["specular"] * ((m["shininess"] + 2) / (2 * np.pi) * power)[..., None]


def plain_phong(m, wo, wi):
    """Phong 1975: what is reflected, over the irradiance it came with."""
    return phong(m, wo, wi) * (2 * np.pi / (m["shininess"] + 2) / wi[..., 2])[..., None]


def blinn(m, wo, wi):
    c = unit(wo + wi)[..., 2]
    return m["specular"] * ((m["shininess"] + 8) / (8 * np.pi) * c ** m["shininess"])[..., None]


def normalized_blinn(m, wo, wi):
    """Giesen 2009."""
    s, c = m["shininess"], unit(wo + wi)[..., 2]
    return m["specular"] * ((s + 2) * (s + 4) / (8 * np.pi * (2 ** (-s / 2) + s)) * c**s)[..., None]


def ggx(m, wo, wi):
    dv, VoH = ggx_reflection(m["alpha"], wo, wi)
    return dv[..., None] * schlick(m["f0"], m["f90"], VoH)


def turquin(m, wo, wi):
    """Turquin 2019, eq. 16, with E at F = 1; one isotropic alpha for all."""
    E = ggx_albedo(wo[..., 2], _one_alpha(m))[..., None]
    return ggx(m, wo, wi) * (1 + m["f0"] * (1 - E) / E)


def fdez_aguera(m, wo, wi):
    """Fdez-Aguera 2019, eq. 18; one isotropic alpha for all."""
    alpha = _one_alpha(m)
    E_white = ggx_albedo(wo[..., 2], alpha)[..., None]
    b = ggx_albedo(wo[..., 2], alpha, 0.0, 1.0)[..., None]
    single = m["f0"] * (E_white - b) + m["f90"] * b
    mean = m["f0"] + (m["f90"] - m["f0"]) / 21
    return ggx(m, wo, wi) + single * mean * (1 - E_white) / (1 - mean * (1 - E_white)) / np.pi


def metal(m, wo, wi):
    dv, VoH = ggx_reflection(m["alpha"], wo, wi)
    mean = hemispherical_mean(lambda mu: f82_tint(m["f0"], m["tint"], mu))
    return dv[..., None] * f82_tint(m["f0"], m["tint"], VoH) + kulla_conty(_one_alpha(m), mean, wo[..., 2], wi[..., 2])


def conductor(m, wo, wi):
    index = m["eta"] + 1j * m["k"]
    dv, VoH = ggx_reflection(m["alpha"], wo, wi)
    mean = hemispherical_mean(lambda mu: fresnel(mu, index))
    return dv[..., None] * fresnel(VoH[..., None], index) + kulla_conty(_one_alpha(m), mean, wo[..., 2], wi[..., 2])


def separable(alpha, wo, wi):
    """G1(o) G1(i), Heitz 2014, eq. 98."""
    return 1 / ((1 + ggx_lambda(wo, alpha)) * (1 + ggx_lambda(wi, alpha)))


def glass_reflection(alpha, wo, wi, is_separable):
    """D G2 / (4 NoV NoL) and VoH, under either masking."""
    dv, VoH = ggx_reflection(alpha, wo, wi)
    if is_separable:
        dv = ggx_d(unit(wo + wi), alpha) * separable(alpha, wo, wi) / (4 * wo[..., 2] * wi[..., 2])
    return dv, VoH


def dielectric(m, wo, wi, is_separable=False):
    """Walter et al. 2007, eqs. 20 and 21, light from wi (index eta) to wo (index 1), with Heitz 2016's masking."""
    eta, alpha = m["eta"], m["alpha"]
    reflected, VoH = glass_reflection(alpha, wo, wi, is_separable)
    reflected = reflected[..., None] * glass_fresnel(m, VoH)
    h = -unit(wo + eta[..., None] * wi)
    h = h * np.sign(h[..., 2:])
    o_h, i_h = dot(wo, h), dot(wi, h)
    g2 = separable(alpha, wo, wi) if is_separable else beta(1 + ggx_lambda(wo, alpha), 1 + ggx_lambda(wi, alpha))
    through = np.abs(i_h * o_h / (wi[..., 2] * wo[..., 2])) * g2 * ggx_d(h, alpha)
    through = np.where((o_h > 0) & (i_h < 0), through / (eta * i_h + o_h) ** 2, 0)
    return np.where(wi[..., 2:] > 0, reflected, through[..., None] * (1 - glass_fresnel(m, np.abs(o_h))))


def glass_fresnel(m, mu):
    """(..., 1), or of a film (..., 3): Fresnel's curve between f0 and f90 below a film, which light from inside meets
    at the angle that it has outside."""
    eta = m["eta"]
    R = fresnel(mu, eta)[..., None]
    if "film" not in m:
        return R
    eta_f0 = (((eta - 1) / (eta + 1)) ** 2)[..., None]
    F = m["f0"] + (m["f90"] - m["f0"]) * np.clip((R - eta_f0) / (1 - eta_f0), 0, 1)
    outside = np.sqrt(np.maximum(np.where(eta < 1, 1 - (1 - mu**2) / eta**2, mu**2), 0))
    ior = np.where(m["f0"].max(axis=-1) > 0.35, 0, np.maximum(eta, 1 / eta))
    film = thin_film.reflectance(F, outside, ior, m["film_ior"], m["film_thickness"])
    return np.where(R >= 1, 1, F + m["film"][..., None] * (film - F))


def thin_dielectric(m, wo, wi, is_separable=False):
    """KHR_materials_transmission's mirrored lobe, with what goes to and fro inside added up bounce by bounce."""
    dv, VoH = glass_reflection(m["alpha"], wo, wi * np.where(wi[..., 2:] < 0, [1, 1, -1], 1), is_separable)
    R = glass_fresnel(m, VoH)
    there, bounce = np.zeros_like(R), (1 - R) ** 2
    for _ in range(4000):
        there += bounce
        bounce *= R * R
    return dv[..., None] * np.where(wi[..., 2:] > 0, 1 - there, there)


def standard(m, wo, wi):
    """glTF 2.0, appendix B, compensated by Kulla & Conty 2017, its base by Kelemen & Szirmay-Kalos 2001; one alpha."""
    return _layers(m, np.stack([m["alpha"]] * 2, axis=-1), _one_alpha(m), wo, wi)


def standard_anisotropic(m, wo, wi):
    """The same with facets stretched along x; what they scatter more than once is that of their mean alpha."""
    (alpha_t,) = np.unique(m["alpha_t"])
    alphas = np.stack([m["alpha_t"], m["alpha"]], axis=-1)
    return _layers(m, alphas, float(np.sqrt(alpha_t * _one_alpha(m))), wo, wi)


def standard_rough(m, wo, wi):
    """The base is EON, and gets back what the interface changes of its albedo: its dimming of light at grazing angles,
    x ((1 - mu)^5 - 1/21), integrated over EON, for both directions."""
    alpha = _one_alpha(m)
    mean_b = ggx_mean_albedo(alpha, 0.0, 1.0)
    F_mean, E_mean, f0 = m["f0"] + (1 - m["f0"]) / 21, ggx_mean_albedo(alpha), m["f0"]
    multiple = F_mean**2 * E_mean / (1 - F_mean * (1 - E_mean)) * (1 - E_mean)
    through = 1 - (f0 * (E_mean - mean_b) + mean_b + multiple).max(axis=-1)
    x = 21 * mean_b * (1 - f0.max(axis=-1)) / np.maximum(through, 1e-3) * (1 + 42 * mean_b) / 3
    sigma = m["diffuse_roughness"]
    A = 1 / (1 + (0.5 - 2 / (3 * np.pi)) * sigma)
    q = np.interp(wo[..., 2], *_dimming()) + np.interp(wi[..., 2], *_dimming())
    base = eon({"sigma": sigma, "albedo": m["base_color"]}, wo, wi)
    base = base + m["base_color"] / np.pi * (x * sigma * A * q)[..., None]
    return _layers(m, np.stack([m["alpha"]] * 2, axis=-1), alpha, wo, wi, base)


def standard_translucent(m, wo, wi):
    """KHR_materials_diffuse_transmission: mix(diffuse_brdf(base colour), diffuse_btdf(colour), factor) under the
    interface, which dims what comes from below as it does what comes from above."""
    return _translucent(m, wo, wi, m["base_color"])


def standard_scattering(m, wo, wi):
    """KHR_materials_scatter of a thin wall: what it scatters back has the colour of what goes through."""
    back = m["scattered_back"][..., None]
    return _translucent(m, wo, wi, (1 - back) * m["base_color"] + back * m["diffuse_transmission_color"])


def _translucent(m, wo, wi, above_color):
    alpha, t = _one_alpha(m), m["diffuse_transmission"][..., None]
    alphas, up = np.stack([m["alpha"]] * 2, axis=-1), wi * np.where(wi[..., 2:] < 0, [1, 1, -1], 1)
    above = _layers(m, alphas, alpha, wo, up, (1 - t) * above_color / np.pi)
    bare, lit = (_layers(m, alphas, alpha, wo, up, base + 0 * above) for base in (
        0, t * m["diffuse_transmission_color"] / np.pi))
    return np.where(wi[..., 2:] < 0, lit - bare, above)


@lru_cache(maxsize=1)
def _dimming():
    """Cosines of wo, and int ((1 - mu)^5 - 1/21) f mu dwi / A of white EON with sigma = 1, on a grid of wi."""
    x, weight = np.polynomial.legendre.leggauss(48)
    mu, phi = (x + 1) / 2, (np.arange(128) + 0.5) / 128 * 2 * np.pi
    s = np.sqrt(1 - mu**2)[:, None]
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), mu[:, None] + 0 * phi], axis=-1)
    white = {"sigma": np.ones(1), "albedo": np.ones(3)}
    weights = (weight / 2 * mu * ((1 - mu) ** 5 - 1 / 21))[:, None] * 2 * np.pi / 128
    cosines = np.linspace(0.01, 1, 100)
    found = [(eon(white, np.array([np.sqrt(1 - c * c), 0, c]), wi)[..., 0] * weights).sum() for c in cosines]
    return cosines, np.array(found) * (1 + 0.5 - 2 / (3 * np.pi))


def charlie_lobe(wo, wi, r):
    """Estevez & Kulla 2017, eqs. 2 and 3, without the limit at grazing angles; `r` is the perceptual roughness."""
    a, mu_h = r * r, unit(wo + wi)[..., 2]
    d = (2 + 1 / a) / (2 * np.pi) * np.exp(np.log(np.maximum(1 - mu_h**2, 1e-300)) / (2 * a))

    def L(x):
        fitted = [(21.5473, 25.3245), (3.82987, 3.32435), (0.19823, 0.16801), (-1.9776, -1.27393), (-4.32054, -4.85967)]
        A, B, C, D, E = (smooth * (1 - a) ** 2 + rough * (1 - (1 - a) ** 2) for rough, smooth in fitted)
        return A / (1 + B * x**C) + D * x + E

    def Lambda(mu):
        return np.exp(np.where(mu < 0.5, L(np.minimum(mu, 0.5)), 2 * L(0.5) - L(1 - np.maximum(mu, 0.5))))

    return d / ((1 + Lambda(wo[..., 2]) + Lambda(wi[..., 2])) * 4 * wo[..., 2] * wi[..., 2])


@lru_cache(maxsize=8)
def _charlie_albedos(r: float):
    """Cosines and the directional albedo there."""
    x, weight = np.polynomial.legendre.leggauss(64)
    mu, phi = ((x + 1) / 2) ** 2, (np.arange(128) + 0.5) / 128 * np.pi
    weights = (weight * (x + 1) / 2 * mu)[:, None] * 2 * np.pi / 128
    s = np.sqrt(1 - mu**2)[:, None]
    wi = np.stack([s * np.cos(phi), s * np.sin(phi), mu[:, None] + 0 * phi], axis=-1)
    cosines = np.linspace(0.05, 1, 200) ** 2
    return cosines, np.array([(charlie_lobe(np.array([np.sqrt(1 - c * c), 0, c]), wi, r) * weights).sum()
                              for c in cosines])


def zeltner_albedo(mu, r):
    """The fit of MaterialX 1.39 to the table of Zeltner et al. 2022: a Gaussian of the cosine and an offset."""
    width = r * (0.0206607 + 1.58491 * r) / (0.0379424 + 1.32227 * r + r**2)
    middle = (-0.193854 * r - 1.14885 * r**2 + 1.7932 * r**3 - 0.95943 * r**5) / (0.046391 + r)
    offset = (0.000654023 * r - 0.0207818 * r**2 + 0.119681 * r**3) / (1.26264 - 1.92021 * r + r**2)
    return np.exp(-((mu - middle) ** 2) / (2 * width**2)) / (width * np.sqrt(2 * np.pi)) + offset


def zeltner_lobe(wo, wi, r):
    """Zeltner et al. 2022, eqs. 5 to 7: E times the density of a linearly transformed cosine, by its matrix."""
    mu = wo[..., 2]
    a = (2.58126 * mu * r + 0.813703 * r**2) / (1 + 0.310327 * mu**2 + 2.60994 * mu * r)
    b = np.sqrt(1 - mu) * (r - 1) * r**3 / (0.0000254053 + 1.71228 * mu - 1.71506 * mu * r + 1.34174 * r**2)
    tangent = unit(np.where(mu[..., None] < 1, wo * [1, 1, 0], [1.0, 0, 0]))  # any along the normal, where b is 0
    across = np.cross([0, 0, 1.0], tangent)
    local = np.stack([(wi * tangent).sum(axis=-1), (wi * across).sum(axis=-1), wi[..., 2]], axis=-1)
    none = 0 * mu
    matrix = np.stack([np.stack([a, none, b], -1), np.stack([none, a, none], -1), np.stack([none, none, 1 + none], -1)],
                      axis=-2)
    back = (matrix @ local[..., None])[..., 0]
    length = np.linalg.norm(back, axis=-1)
    density = back[..., 2] / length / np.pi * np.linalg.det(matrix) / length**3
    return zeltner_albedo(mu, r) * density / wi[..., 2]


def standard_zeltner_sheen(m, wo, wi):
    (r,) = np.unique(m["sheen_roughness"])
    return _fibres_over(m, wo, wi, zeltner_lobe(wo, wi, r), lambda mu: zeltner_albedo(mu, r))


def standard_sheen(m, wo, wi):
    (r,) = np.unique(m["sheen_roughness"])
    return _fibres_over(m, wo, wi, charlie_lobe(wo, wi, r), lambda mu: np.interp(mu, *_charlie_albedos(float(r))))


def _fibres_over(m, wo, wi, lobe, albedo):
    """Fibres over all. The diffuse base is dimmed for both directions, over the mean of what reaches it."""
    largest, (x, weight) = m["sheen_color"].max(axis=-1), np.polynomial.legendre.leggauss(24)

    def through(mu):
        return 1 - largest * albedo(mu)

    def interface(mu):  # what the interface lets through, of its brightest channel
        alpha, f90 = _one_alpha(m), m["f90"][..., None]
        white, grazing, E_mean = ggx_albedo(mu, alpha), ggx_albedo(mu, alpha, 0.0, 1.0), ggx_mean_albedo(alpha)
        mean = m["f0"] + (f90 - m["f0"]) / 21
        multiple = mean**2 * E_mean / (1 - mean * (1 - E_mean)) * (1 - white)
        return 1 - (m["f0"] * (white - grazing) + f90 * grazing + multiple).max(axis=-1)

    nodes = [(w * t, through(t), interface(t)) for t, w in zip((x + 1) / 2, weight)]
    passed = sum(w * F for w, _, F in nodes)  # to the base, none in a perfect mirror
    mean = np.where(passed > 1e-6, sum(w * T * F for w, T, F in nodes) / np.maximum(passed, 1e-6), 1)
    black = {**m, "base_color": np.where(m["metallic"][..., None] < 1, 0 * m["base_color"], m["base_color"])}
    metal = (m["metallic"][..., None] > 0) * m["metallic"][..., None]
    whole, below = standard(m, wo, wi), standard({**black, "metallic": 0 * m["metallic"]}, wo, wi)
    pure = standard({**m, "metallic": 1 + 0 * m["metallic"]}, wo, wi)
    diffuse = whole - metal * pure - (1 - metal) * below
    o, i = through(wo[..., 2])[..., None], (through(wi[..., 2]) / mean)[..., None]
    return m["sheen_color"] * lobe[..., None] + o * (metal * pure + (1 - metal) * below + diffuse * i)


def standard_iridescent(m, wo, wi):
    """KHR_materials_iridescence: a film over dielectric and metal, whose colour is missing in what enters below. Only
    what the viewer sees of the base is dimmed by it."""
    alpha = _one_alpha(m)
    alphas = np.stack([m["alpha"]] * 2, axis=-1)
    return _layers(m, alphas, alpha, wo, wi, film=lambda F, mu, ior: film_over(m, F, mu, ior))


def film_over(m, F, mu, ior):
    """F (N, ..., 3) of N surfaces below their films, for cosines (N, ...). `ior` is 0 for metal."""
    ior, film_ior, thickness, walls, weight = (np.asarray(value)[(..., *[None] * (np.ndim(mu) - 1))] for value in (
        ior, m["film_ior"], m["film_thickness"], m["film_walls"], m["film"]))
    walls, weight = walls[..., None], weight[..., None]
    one = F / (1 + walls * (1 - F))
    film = thin_film.reflectance(one, mu, ior, film_ior, thickness)
    return F + weight * (film * (1 + walls) / (1 + walls * film) - F)


def standard_coated(m, wo, wi):
    """KHR_materials_clearcoat: an interface of index 1.5 over all, which lets 1 less its directional albedo through."""
    base, (coat_alpha,) = standard(m, wo, wi), np.unique(m["coat_alpha"])
    weight, coat_alpha = m["coat"][..., None], float(coat_alpha)
    dv, VoH = ggx_reflection(np.full((*wo.shape[:-1], 2), coat_alpha), wo, wi)
    mean = weight * (0.04 + 0.96 / 21)
    coat = schlick(0.04 * weight, weight, VoH) * dv[..., None]
    coat = coat + kulla_conty(coat_alpha, mean, wo[..., 2], wi[..., 2])
    E = ggx_albedo(wo[..., 2], coat_alpha)[..., None]
    E_mean = ggx_mean_albedo(coat_alpha)
    multiple = mean**2 * E_mean / (1 - mean * (1 - E_mean)) * (1 - E)
    return coat + (1 - weight * ggx_albedo(wo[..., 2], coat_alpha, 0.04, 1.0)[..., None] - multiple) * base


def _layers(m, alphas, alpha, wo, wi, base=None, film=None):
    """`alphas` are those of D V, (..., 2); `alpha` that of the albedo, for all; `base` that is not Lambert's; `film` as
    `film_over`."""
    dv, VoH = ggx_reflection(alphas, wo, wi)
    f0, f90, NoV, NoL = m["f0"], m["f90"][..., None], wo[..., 2], wi[..., 2]
    E_mean = ggx_mean_albedo(alpha)

    def multiple(mean):
        return mean**2 * E_mean / (1 - mean * (1 - E_mean))

    def interface(f0, f90, ior):
        F, mean = schlick(f0, f90, VoH), f0 + (f90 - f0) / 21
        if film:
            F, mean = film(F, VoH, ior), hemispherical_mean(
                lambda mu: film(schlick(f0, f90, mu * np.ones(len(f0))), mu * np.ones(len(f0)), ior), 16)
        return F * dv[..., None] + kulla_conty(alpha, mean, NoV, NoL), mean

    def through(white, grazing):
        """1 less all that is reflected, of the brightest channel; `white` at F = 1, `grazing` at f0 = 0, f90 = 1."""
        white, grazing = np.asarray(white)[..., None], np.asarray(grazing)[..., None]
        lost = multiple(f0 + (f90 - f0) / 21) * (1 - white)
        return 1 - (f0 * (white - grazing) + f90 * grazing + lost).max(axis=-1, keepdims=True)

    o, i = (through(ggx_albedo(mu, alpha), ggx_albedo(mu, alpha, 0.0, 1.0)) for mu in (NoV, NoL))
    mean = through(ggx_mean_albedo(alpha), ggx_mean_albedo(alpha, 0.0, 1.0))
    base = m["base_color"] / np.pi if base is None else base
    ior = np.where(f0.max(axis=-1) > 0.35, 0, m["ior"])
    dielectric_, mean_film = interface(f0, f90, ior)
    if film:
        grid = np.linspace(0.002, 1, 150)
        bare = schlick(f0[:, None], f90[:, None], np.tile(grid, (len(f0), 1)))
        curves = film(bare, np.tile(grid, (len(f0), 1)), ior) - bare
        seen = [visible_normals(float(mu), alpha) for mu in NoV]
        added = [[(share * np.interp(VoH, grid, curve)).sum() for curve in curves_.T]
                 for (VoH, share), curves_ in zip(seen, curves)]
        ms = (multiple(mean_film) - multiple(f0 + (f90 - f0) / 21)) * (1 - ggx_albedo(NoV, alpha))[..., None]
        o = np.maximum(o - added - ms, 0)
    dielectric_ = dielectric_ + o * i / np.maximum(mean, 1e-4) * base
    return dielectric_ + m["metallic"][..., None] * (interface(m["base_color"], 1.0, 0 * ior)[0] - dielectric_)


def _one_alpha(m) -> float:
    (alpha,) = np.unique(m["alpha"])
    return float(alpha)
